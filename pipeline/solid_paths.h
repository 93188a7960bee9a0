#pragma once

#include <filesystem>

#include "pipeline/path_pictures.h"
#include "pipeline/study_data.h"
#include "pipeline/study_folder.h"

namespace morphodesic::pipeline {

/// How the solids of a study are looked at: in one frame, from one side. For plane shapes any view.
struct StudyView {
    SolidView common;
    std::vector<datasets::Rotation> turns;  ///< of every shape into the frame; empty for plane shapes

    [[nodiscard]] SolidView of(std::size_t shape) const;
};
[[nodiscard]] StudyView view_of_study(const ResultStore& store, const StudyData& data);

/// The viewpoint for the shapes of one path.
/// @param file  name of the last shape: the first was laid onto it
[[nodiscard]] SolidView view_of_path(const GeodesicResult<3>& path, const std::string& file);

/// Shaded view of a solid, of the camera's size, coloured by a field from 0 to `high` if there is one.
[[nodiscard]] RgbaImage shaded_picture(const LevelSet<3>& u, const datasets::View& camera,
                                       const ScalarField<3>* rate = nullptr, double high = 1.0);

/// A text that is equal for equal views: part of the key of stored pictures.
[[nodiscard]] std::string key_of(const SolidView& view);

/// Writes the shapes of a path as step-00.vdb (level set "shape", negative inside, and "dissipation") and step-00.ply
/// (surface, dissipation at its points), ... into a folder below the study (or output) folder. Returns their names.
/// @throws StoreError if the disk is full or the folder may not be written
std::vector<std::string> write_path_solids(const StudyFolder& folder, const std::filesystem::path& below,
                                           const GeodesicResult<3>& path);

/// Exported solids of an earlier report: kept while the same paths are drawn, so that they are not computed again.
class KeptSolids {
public:
    /// Moves the files of the paths aside; whatever else lies in paths/ stays.
    explicit KeptSolids(const StudyFolder& folder);
    /// Puts back what nobody took: the paths were not all drawn.
    ~KeptSolids();
    KeptSolids(const KeptSolids&) = delete;
    KeptSolids& operator=(const KeptSolids&) = delete;
    /// Moves the solids of a path to their new place; false if they are not there.
    [[nodiscard]] bool take(const std::string& key, const std::filesystem::path& below) const;
    /// Removes what nobody took.
    void drop_rest();
    /// Writes down whose solids lie in a folder.
    void mark(const std::string& key, const std::filesystem::path& below) const;

private:
    StudyFolder folder_;
    std::filesystem::path aside_;
};

}  // namespace morphodesic::pipeline
