#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "datasets/import.h"
#include "geodesic/solver/geodesic_options.h"

namespace morphodesic::pipeline {

/// Which geodesics of a study are computed. Not part of the settings hash: a geodesic is the same whoever asks for it.
struct PairSelection {
    bool both_directions = false;  ///< both directions of every pair; the distance is their mean
    int neighbors = 0;             ///< k > 0: only pairs that can be among the k nearest of a shape are solved finely

    template <class Self, class Visitor>
    static void for_each_field(Self& self, Visitor&& visit) {
        visit("both-directions", self.both_directions,
              "compute both directions of every pair and use the mean; else one, from the fuller shape to the one with "
              "more gaps");
        visit("neighbors", self.neighbors,
              "k > 0: solve all pairs coarsely and only those finely that can be among the k nearest of a shape; the "
              "others get an estimate and are marked; 0: all pairs finely");
    }
};

/// Everything that decides the numbers of a study: how files are read, placed and compared.
struct RunSettings {
    std::string preset = "standard";  ///< fast | standard | fine: where the defaults come from; other options overrule
    std::string labels = "auto";      ///< datasets::ScanOptions::labels
    std::string dimension = "auto";   ///< auto | 2 | 3: which files of a folder are studied
    datasets::ImportOptions import;
    std::string normalize = "common";  ///< datasets::NormalizeOptions::mode
    GeodesicOptions geodesic;
    PairSelection pairs;

    /// visit(name, field, help) for every option, in the order of --help. The preset and the pairs are not among
    /// them: for those see PairSelection.
    template <class Self, class Visitor>
    static void for_each_field(Self& self, Visitor&& visit) {
        visit("labels", self.labels, "where class labels come from: auto, csv (labels.csv), folder, name or none");
        visit("dimension", self.dimension, "2: study the images of the folder, 3: the solids, auto: the larger part");
        datasets::ImportOptions::for_each_field(self.import, visit);
        visit(
            "normalize", self.normalize,
            "size of the shapes: common (one scale for all), each (all of one area or volume, 0.1 or 0.03 of the unit "
            "square or cube, less where that does not fit), none (as in the file: the longer side of an image is the "
            "side of the square, one unit of a mesh or one millimetre of a volume that of the cube)");
        GeodesicOptions::for_each_field(self.geodesic, visit);
    }
    /// Every violated constraint, in words; empty if the settings are usable.
    [[nodiscard]] std::vector<std::string> problems() const;
};

/// A named trade of time against accuracy.
struct Preset {
    const char* name;
    const char* help;  ///< what it costs and how exact it is
    int level;
    int time_steps;
    double tolerance;
    int starts, rounds;
};
[[nodiscard]] const std::vector<Preset>& presets();

/// Gives the settings what a preset says: level, steps, tolerance, starts and rounds; the rest stays as it is.
/// @throws std::invalid_argument if there is no such preset
void take_preset(RunSettings& settings, const std::string& name);
/// The default settings with a preset. @throws std::invalid_argument if there is no such preset
[[nodiscard]] RunSettings settings_of_preset(const std::string& name);

/// One "name = value" line per field, valid TOML, doubles in the shortest form that reads back exactly. The text of
/// equal options is equal; `--config` reads it.
[[nodiscard]] std::string canonical_text(const RunSettings& settings);
[[nodiscard]] std::string canonical_text(const GeodesicOptions& options);
[[nodiscard]] std::string canonical_text(const datasets::ImportOptions& options);

/// Name of the geodesic settings in the store: digest of their canonical text and of the solver's revision.
[[nodiscard]] std::string settings_hash(const GeodesicOptions& options);

/// The settings that a canonical text describes. @throws std::invalid_argument naming an unknown or unreadable line
[[nodiscard]] RunSettings settings_from_text(const std::string& text);

/// Level of the grid on which shapes are kept: in 3D that of the solver. In 2D one finer, as shapes are turned, and
/// their corners are lost between the nodes (a letter is then three times nearer to itself), and from 7 to 10, so that
/// pictures are smooth and `geodesics` can take a coarse study to finer levels where the files are not at hand.
[[nodiscard]] int shape_level(int dimension, const GeodesicOptions& options);

/// Part of every settings hash. To be raised when a change of the solver changes its numbers, so that results of
/// different solvers never share a matrix.
inline constexpr int solver_revision = 23;

}  // namespace morphodesic::pipeline
