#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "pipeline/result_store.h"

namespace morphodesic::pipeline {

/// What a result file of a shard holds. One JSON object per line: first the header, then one geodesic each with a
/// checksum over its row. A file that was put together from several has a header before the rows of each.
struct ShardResults {
    std::string settings_hash;  ///< of the first line; empty if that is the header of another version or damaged
    std::map<std::string, std::vector<StoredGeodesic>> rows;  ///< sound ones by settings; empty lists: only a header
    long damaged = 0;                                         ///< lines that are not what was written
    long of_other_version = 0;                                ///< rows behind a header of another version
    bool lacks_line_end = false;                              ///< the last row, which is sound
    bool ends_in_other_version = false;                       ///< the last header is of another version
    std::string problem;                                      ///< why nothing of the file may be used; empty if it may
};
[[nodiscard]] ShardResults read_shard_results(const std::filesystem::path& file);

/// The result file of a shard while it is computed: lines are only ever appended. Held by one process.
class ShardWriter {
public:
    /// Opens or makes the file and cuts off a line that was not finished.
    /// @throws StoreError if another process holds it, if it is no result file or belongs to other settings, which
    /// leaves it as it is, or if it cannot be written
    ShardWriter(std::filesystem::path file, const std::string& settings_hash);
    ~ShardWriter();
    ShardWriter(const ShardWriter&) = delete;
    ShardWriter& operator=(const ShardWriter&) = delete;

    /// What is in the file already.
    [[nodiscard]] const std::vector<StoredGeodesic>& before() const { return before_; }
    /// On the disk when it returns: neither a kill nor a power cut loses what was appended.
    void append(const StoredGeodesic& geodesic);

private:
    void take_up(const std::string& settings_hash);
    void cut_to(std::size_t size);
    void write(const std::string& line);

    std::filesystem::path file_;
    int descriptor_ = -1;
    std::mutex mutex_;
    std::vector<StoredGeodesic> before_;
};

}  // namespace morphodesic::pipeline
