#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "geodesic/discrete_geodesic.h"
#include "pipeline/path_pictures.h"
#include "pipeline/result_store.h"
#include "pipeline/study_folder.h"
#include "reports/report_model.h"

namespace morphodesic::pipeline {

/// Width and height of the frames of a path and of thumbnails, pixels.
inline constexpr int frame_pixels = 192, thumbnail_pixels = 96;

/// Frames and colours of a path as the report wants them, without names.
struct DrawnPath {
    std::vector<reports::Picture> frames;
    reports::ColourBar colour_bar;
};
/// What the colours of the frames say.
[[nodiscard]] reports::ColourBar colour_bar_of(const PathPictures& pictures);
template <int Dim>
[[nodiscard]] DrawnPath draw_path(const GeodesicResult<Dim>& path, const SolidView& view = {});

/// One string for the store, and back; nothing if the string is not one of these.
[[nodiscard]] std::string pack(const DrawnPath& drawn);
[[nodiscard]] DrawnPath unpack(const std::string& bytes);

/// The folder of a path of the report, below paths/: a name that every file system takes.
[[nodiscard]] std::string path_folder(std::size_t number, const std::string& a, const std::string& b);
/// Whether a name is one that path_folder gives.
[[nodiscard]] bool is_path_folder(const std::string& name);
/// Whether a name is that of a file which only the export of a path writes; the others in its folder are the user's.
[[nodiscard]] bool is_path_file(const std::filesystem::path& name);

/// The file that says which pair exported solids belong to.
inline constexpr const char* solids_mark = "solids.key";

/// Writes the frames of a path into a folder below the study (or output) folder: step-00.png, ... and colours.json,
/// which says what the colours mean. Returns the names of the frames.
std::vector<std::string> write_path_files(const StudyFolder& folder, const std::filesystem::path& below,
                                          const DrawnPath& drawn);

/// Every number of a result as JSON; doubles read back exactly. Of a pair that the solver gave up the numbers are null.
[[nodiscard]] nlohmann::ordered_json to_json(const StoredGeodesic& geodesic);

}  // namespace morphodesic::pipeline
