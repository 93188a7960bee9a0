#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geodesic/discrete_geodesic.h"
#include "pipeline/store_error.h"
#include "pipeline/stored_geodesic.h"

namespace morphodesic::pipeline {

/// A file of the collection as the store knows it.
struct StoredShape {
    std::string name;   ///< path relative to the collection's folder
    std::string path;   ///< where the file was when it was read
    std::string label;  ///< class; empty if unknown
    int dimension = 2;
    std::string file_digest;     ///< of the file's bytes
    std::string reading;         ///< digest of everything that decides what is read: file, mask, import options
    std::string placing;         ///< digest of everything that decides the level set: reading, scale, grid
    double extent_radius = 0.0;  ///< in file units; 0 if not measured
    std::string content_digest;  ///< of the level set; empty if the file could not be used
    double volume = 0.0;         ///< area (volume) in units of the cube
    double scale = 1.0;          ///< cube units per file unit
    double fullness = 0.0;       ///< how full it is (geodesic/grid/measures.h); 0 if not measured
    std::vector<std::string> notes;
    std::string problem;   ///< why the file could not be used; empty if it could
    bool damaged = false;  ///< the row is not as it was written: `problem` says so, only the file itself knows more
};

/// Before a study is locked or read: a store that is not there is a wrong name, not a damaged study.
/// @throws std::invalid_argument if there is no such file
void expect_store(const std::filesystem::path& file);

/// The single truth of a study: one SQLite file. Every write is one transaction, so whatever happens to the process, a
/// row is there completely or not at all. All methods throw StoreError; all may be called from several threads.
class ResultStore {
public:
    enum class Access {
        glance,  ///< to read a fact or two: without the check that reads all of the file
        read,
        write
    };

    /// Opens the store; with Access::write it is made if it is not there.
    /// @throws StoreError also for a file of another schema version and for a damaged file, std::invalid_argument as
    /// expect_store
    ResultStore(std::filesystem::path file, Access access);
    ~ResultStore();
    ResultStore(const ResultStore&) = delete;
    ResultStore& operator=(const ResultStore&) = delete;

    [[nodiscard]] const std::filesystem::path& file() const;

    /// Facts on the whole study by key, e.g. "folder", "common_scale", "settings".
    [[nodiscard]] std::optional<std::string> fact(std::string_view key) const;
    void set_fact(std::string_view key, std::string_view value);

    /// All files of the collection, sorted by name. Nothing of a damaged row is to be used; it has a problem.
    [[nodiscard]] std::vector<StoredShape> shapes() const;
    /// Adds or replaces the file of that name.
    void put_shape(const StoredShape& shape);
    /// Takes files out of the collection; their geodesics stay for the day they come back.
    void remove_shapes(const std::vector<std::string>& names);
    /// Writes down how many files the collection has, so that one whose row gets lost is missed.
    void seal_shape_count();
    /// How many rows are lost; 0 also where their number was never written down.
    [[nodiscard]] long lost_shapes() const;

    /// Level sets by content digest, as 32-bit floats.
    template <int Dim>
    void put_level_set(std::string_view digest, const LevelSet<Dim>& level_set, const ScalarField<Dim>& mask);
    /// @param mask  receives the occlusion mask (empty values if there is none) unless null
    template <int Dim>
    [[nodiscard]] LevelSet<Dim> level_set(std::string_view digest, ScalarField<Dim>* mask = nullptr) const;
    /// Level of the grid of a level set; 0 if it is not there.
    [[nodiscard]] int level_of(std::string_view digest) const;
    /// Digests of the level sets that have an occlusion mask.
    [[nodiscard]] std::set<std::string> masked_level_sets() const;
    /// Deletes level sets that no file of the collection has any more.
    void remove_unused_level_sets();

    /// Writes down what a settings hash stands for.
    void put_settings(std::string_view hash, std::string_view text);
    [[nodiscard]] std::optional<std::string> settings(std::string_view hash) const;

    void put_geodesic(const StoredGeodesic& geodesic);
    /// All of them or, if that fails, none.
    void put_geodesics(const std::vector<StoredGeodesic>& geodesics);
    [[nodiscard]] std::optional<StoredGeodesic> geodesic(std::string_view a, std::string_view b,
                                                         std::string_view settings_hash) const;
    /// Every row of these settings, sorted by (a, b). Damaged rows are left out and handed to on_damage, if any.
    using OnDamage = std::function<void(const std::string& a, const std::string& b)>;
    [[nodiscard]] std::vector<StoredGeodesic> geodesics(std::string_view settings_hash,
                                                        const OnDamage& on_damage = {}) const;
    /// Keys of the sound rows of these settings.
    [[nodiscard]] std::set<std::pair<std::string, std::string>> stored_pairs(std::string_view settings_hash,
                                                                             const OnDamage& on_damage = {}) const;
    /// Forgets the failed rows of these settings, so that they are tried again. Returns how many there were.
    long remove_failures(std::string_view settings_hash);

    /// For a file that is only read from now on: makes it one file that needs no other beside it.
    void finish_as_one_file();

    /// Pictures that were drawn already, by any key.
    [[nodiscard]] std::optional<std::string> picture(std::string_view key) const;
    void put_picture(std::string_view key, std::string_view bytes);
    /// Forgets the pictures whose keys begin so, but for one.
    void remove_pictures(std::string_view beginning, std::string_view kept);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Version of the tables; a store of another version is refused with advice.
inline constexpr int store_version = 1;

}  // namespace morphodesic::pipeline
