#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/import.h"
#include "pipeline/common_scale.h"
#include "pipeline/progress.h"
#include "pipeline/result_store.h"
#include "pipeline/run_settings.h"
#include "pipeline/solid_reach.h"

namespace morphodesic::pipeline {

/// A file of the collection: where it is, and what the store knows of it.
struct CollectionEntry {
    datasets::ShapeSource source;  ///< empty path: the study is used without its folder
    StoredShape row;               ///< its problem is set if the file cannot be used
    bool needs_import = false;     ///< the store has no level set for these settings
    /// A solid as it was read to be measured, so that its repair, the dearest part, is not done twice. Whoever imports
    /// the entry takes it out. Null: read the file again.
    std::shared_ptr<std::optional<datasets::RawShape<3>>> measured = {};
    /// Of a solid that was measured, in the cube, or in units of the file while there is no common scale.
    std::shared_ptr<const SolidReach> reach = {};
};

/// The files of a study and how they are placed in the cube.
struct Collection {
    int dimension = 2;
    std::vector<CollectionEntry> entries;  ///< sorted by name
    datasets::ImportOptions import;
    datasets::NormalizeOptions placement;
    CommonScale common;                 ///< where shapes are placed at one scale
    std::vector<std::string> remarks;   ///< what a user should know, one sentence each
    std::vector<std::string> left_out;  ///< problems of the scan: folders, links, files of the other dimension
    std::vector<std::string> gone;      ///< names of files of the last run that are no longer in the folder
    std::string size_warning;           ///< see size_warning
};

/// A shape's name and its size in file units.
struct SizedName {
    std::string name;
    double size = 0.0;
};

/// A sentence with advice if sizes that are to be placed at one scale differ by more than a factor of five; else empty.
[[nodiscard]] std::string size_warning(const std::vector<SizedName>& sizes);

/// Why a file is left out, from the exception that is being handled. What a reader did not expect, too, concerns one
/// file; the others go on.
/// @param less_memory  what to do where the memory did not suffice
[[nodiscard]] std::string problem_of_file(const std::string& path, const char* less_memory);

/// Scans the folder, finds out which files are new or changed and measures them, and finds the common scale, see
/// choose_common_scale. The store is only read: settle_collection writes down what was found.
/// @throws datasets::ReadError if the folder cannot be read, StoreError, std::invalid_argument for broken settings
[[nodiscard]] Collection prepare_collection(const std::filesystem::path& folder, const RunSettings& settings,
                                            const ResultStore& store, Progress& progress);

/// Of the two dimensions the wanted one ("2", "3"), for "auto" the one with more files (solids, if equally many: images
/// beside meshes are often their textures). The others leave `sources`; unless they were not wanted, `left_out` and
/// `remarks` say so.
int choose_dimension(const std::filesystem::path& folder, const std::string& wanted,
                     std::vector<datasets::ShapeSource>& sources, std::vector<std::string>& left_out,
                     std::vector<std::string>& remarks);

/// Makes a collection that of the study: its folder, dimension and scale; files that are gone leave the store.
void settle_collection(const std::filesystem::path& folder, const Collection& collection, ResultStore& store);

/// The collection as the store has it, without its files.
/// @throws std::invalid_argument if nothing was ingested or reading the files was not finished, StoreError
[[nodiscard]] Collection stored_collection(const ResultStore& store);

/// The settings that a study was made with.
/// @throws std::invalid_argument if nothing was ingested, StoreError if they are lost
[[nodiscard]] RunSettings settings_of_study(const ResultStore& store);

/// Notes in the store that the files of a collection are being read, or that all have been.
/// @param command  that reads them again with the same options
void begin_reading(ResultStore& store, std::size_t files, const std::string& command);
void end_reading(ResultStore& store);
/// A sentence with remedy if reading was stopped before all files were taken in, or if the store has lost some since;
/// else empty.
[[nodiscard]] std::string unfinished_reading(const ResultStore& store);
/// @throws std::invalid_argument with that sentence
void refuse_unfinished_reading(const ResultStore& store);

/// A shape ready for pairs.
template <int Dim>
struct ImportedShape {
    std::size_t index = 0;  ///< in Collection::entries
    StoredShape row;
    bool fresh = false;                              ///< the store does not have it yet
    std::shared_ptr<const LevelSet<Dim>> level_set;  ///< null if row.problem is set
    std::shared_ptr<const ScalarField<Dim>> mask;    ///< null: known everywhere
};

/// Fills row and fields from a placed shape; fields are rounded to the 32-bit floats that the store keeps, so that
/// whoever computes with them sees the numbers of the store.
template <int Dim>
void take_shape(ImportedShape<Dim>& result, datasets::Shape<Dim> shape);

/// Reads, places and samples one shape, or takes it from the store. What is wrong with the file becomes row.problem.
/// May be called from several threads.
template <int Dim>
[[nodiscard]] ImportedShape<Dim> import_entry(const Collection& collection, std::size_t index,
                                              const ResultStore& store);

/// How far the solids of a collection reach; those that are not read yet and were not measured are taken as balls.
/// None in the plane.
[[nodiscard]] std::vector<SolidReach> solid_reaches(const Collection& collection, const ResultStore& store);

/// Calls f.template operator()<2>() or <3>(): below this line everything is a template on the dimension.
template <class F>
auto with_dimension(int dimension, F&& f) {
    if (dimension == 3) return f.template operator()<3>();
    return f.template operator()<2>();
}

}  // namespace morphodesic::pipeline
