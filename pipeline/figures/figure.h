#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "geodesic/solver/geodesic_options.h"

namespace morphodesic::pipeline {

/// The numbers behind a figure, one row per thing measured; written as CSV.
struct FigureTable {
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;

    void add(std::vector<std::string> row) { rows.push_back(std::move(row)); }
    [[nodiscard]] std::string csv() const;
};

/// Shortest decimal of a number that reads back exactly; empty for not a number.
[[nodiscard]] std::string exact(double value);
/// A number with so many significant digits, for captions.
[[nodiscard]] std::string rounded(double value, int digits = 4);

/// One number that a figure must prove.
struct FigureCheck {
    std::string what;    ///< the quantity
    std::string value;   ///< what came out
    std::string wanted;  ///< what it is held against
    bool met = false;
    std::string reason{};  ///< why that limit: from the paper or the model, not from what came out
};

struct FigureFile {
    std::string name, bytes;
};

/// A figure for print with its numbers.
struct Figure {
    std::string name;     ///< file name without ending, e.g. "figure-2"
    std::string title;    ///< one line
    std::string caption;  ///< what is seen, with settings and units
    std::string svg;
    int png_width = 2400;  ///< pixels
    FigureTable numbers;
    std::vector<FigureCheck> checks;
    std::vector<FigureFile> files;  ///< further files: animations, volumes
    double seconds = 0.0;
};

struct FigureOptions {
    bool quick = false;  ///< low levels and few steps: for the test suite and a first look

    /// Settings of the geodesics of a figure: those of the paper (K = 8, eta = 200, lambda = 3 mu) on level 7 (3D: 6),
    /// without alignment, because the figures place their shapes.
    [[nodiscard]] GeodesicOptions geodesic(int dimension = 2) const;
};

struct FigureKind {
    std::string key;  ///< "1" .. "9", or the name of a picture that is not in the paper
    std::string title;
    std::function<Figure(const FigureOptions&)> make;
};

/// All figures, in the order of the gallery.
[[nodiscard]] const std::vector<FigureKind>& figure_kinds();

Figure figure_letters_and_solids(const FigureOptions& options);  // 1
Figure figure_bars(const FigureOptions& options);                // 2
Figure figure_sphere(const FigureOptions& options);              // 3
Figure figure_isometry(const FigureOptions& options);            // 4
Figure figure_dumbbells(const FigureOptions& options);           // 5
Figure figure_sliced_solids(const FigureOptions& options);       // 6
Figure figure_cracks(const FigureOptions& options);              // 7
Figure figure_occlusion(const FigureOptions& options);           // 8
Figure figure_matrices(const FigureOptions& options);            // 9
Figure figure_convergence(const FigureOptions& options);
Figure figure_accuracy(const FigureOptions& options);
Figure figure_two_geodesics(const FigureOptions& options);
Figure figure_disk(const FigureOptions& options);
Figure figure_animation(const FigureOptions& options);

}  // namespace morphodesic::pipeline
