#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "pipeline/collection.h"
#include "pipeline/result_store.h"

namespace morphodesic::pipeline {

/// A shape as the store has it. @throws StoreError if it has no sound level set of it
template <int Dim>
[[nodiscard]] ImportedShape<Dim> stored_shape(StoredShape row, const ResultStore& store);

/// Level sets of a study by content digest: those used last stay in memory, the others come from the store when they
/// are needed. May be used from several threads.
template <int Dim>
class ShapeCache {
public:
    /// @param bytes  limit on what is kept; shapes that somebody holds stay in memory in any case
    ShapeCache(const ResultStore& store, std::size_t bytes) : store_(store), limit_(bytes) {}

    /// Keeps a shape that is in the store.
    void keep(const ImportedShape<Dim>& shape);
    /// With row.content_digest, level_set and mask. @throws StoreError if the store has no sound level set of it
    [[nodiscard]] ImportedShape<Dim> get(const std::string& digest);

private:
    struct Entry {
        ImportedShape<Dim> shape;
        std::size_t bytes;
        std::list<std::string>::iterator used;
    };
    void insert(const std::string& digest, ImportedShape<Dim> shape);

    const ResultStore& store_;
    std::size_t limit_, bytes_ = 0;
    std::mutex mutex_;
    std::map<std::string, Entry> entries_;
    std::list<std::string> order_;  // used last first
};

}  // namespace morphodesic::pipeline
