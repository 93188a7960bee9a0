// Figure 9: distance matrices of letters and of feet, and their clusters.
#include <algorithm>
#include <cmath>

#include "analysis/distance_matrix.h"
#include "analysis/linkage.h"
#include "geodesic/grid/measures.h"
#include "pipeline/figures/solid_rows.h"
#include "pipeline/path_pictures.h"
#include "pipeline/solid_paths.h"
#include "reports/text.h"

namespace morphodesic::pipeline {
namespace {

using analysis::DistanceMatrix;

/// Distances of all pairs; every pair once, from the earlier to the later shape.
template <int Dim>
DistanceMatrix distances_of(const std::vector<std::string>& labels, const std::vector<LevelSet<Dim>>& shapes,
                            const GeodesicOptions& settings, std::vector<FigureCheck>& checks) {
    DistanceMatrix matrix(labels);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        for (std::size_t j = i + 1; j < shapes.size(); ++j) {
            const auto path = compute_discrete_geodesic<Dim>(shapes[i], shapes[j], settings);
            if (path.termination != Termination::converged || !(path.min_det > 0)) {
                checks.push_back(solved(labels[i] + " to " + labels[j], path));
            }
            matrix.set(i, j, path.path_length, path.error);
        }
    }
    return matrix;
}

void add_numbers(FigureTable& table, const std::string& name, const DistanceMatrix& matrix) {
    for (std::size_t i = 0; i < matrix.size(); ++i) {
        for (std::size_t j = 0; j < matrix.size(); ++j) {
            table.add(
                {name, matrix.labels()[i], matrix.labels()[j], exact(matrix(i, j)), exact(matrix.error(i, j)), ""});
        }
    }
}

/// Light (near) to dark (far).
Colour distance_colour(double share) {
    const std::string text = reports::viridis(1 - 0.9 * share);
    Colour colour{};
    for (std::size_t c = 0; c < 3; ++c)
        colour[c] = static_cast<unsigned char>(std::stoi(text.substr(1 + 2 * c, 2), nullptr, 16));
    return colour;
}

/// Light to dark with the distance, one picture per row and column, the numbers in the cells, the tree on the right.
void draw_matrix(reports::Svg& svg, double x, double y, double cell, const DistanceMatrix& matrix,
                 const std::vector<std::string>& pictures, const std::string& unit) {
    double high = 0;
    for (const double d : matrix.condensed()) high = std::max(high, d);
    const std::size_t n = matrix.size();
    for (std::size_t i = 0; i < n; ++i) {
        const double at = cell * static_cast<double>(i);
        svg.image(x, y + cell + at, cell, cell, pictures[i]);
        svg.image(x + cell + at, y, cell, cell, pictures[i]);
        for (std::size_t j = 0; j < n; ++j) {
            const double t = matrix(i, j) / high;
            svg.rect(x + cell * static_cast<double>(j + 1), y + cell + at, cell, cell, hex(distance_colour(t)),
                     "#ffffff");
            if (i != j) {
                svg.text(x + cell * (static_cast<double>(j) + 1.5), y + cell + at + cell / 2, rounded(matrix(i, j), 2),
                         10, "middle", t > 0.5 ? "#ffffff" : "#1b2430");
            }
        }
    }
    const analysis::Dendrogram tree = analysis::linkage(matrix, analysis::LinkageMethod::average);
    // Leaves stay in the order of the matrix, so lines may cross; heights grow to the right.
    const double x0 = x + cell * static_cast<double>(n + 1) + 8, depth = 90;
    std::vector<std::pair<double, double>> tip;
    for (std::size_t i = 0; i < n; ++i) tip.emplace_back(x0, y + cell * (static_cast<double>(i) + 1.5));
    for (const auto& merge : tree.merges) {
        const double px = x0 + depth * merge.height / high;
        const auto a = tip[merge.first], b = tip[merge.second];
        svg.polyline({a, {px, a.second}, {px, b.second}, b}, "#3c4757", 1.4);
        tip.emplace_back(px, 0.5 * (a.second + b.second));
    }
    svg.text(x0 + depth / 2, y + cell - 26, "average linkage", 10, "middle");
    const reports::Scale height{0, high, x0, x0 + depth};
    const double axis = y + cell * static_cast<double>(n + 1) + 4;
    svg.line(x0, axis, x0 + depth, axis, "#8b95a3");
    for (const double v : reports::ticks(0, high, 3)) {
        svg.line(height(v), axis, height(v), axis + 4, "#8b95a3");
        svg.text(height(v), axis + 11, reports::short_number(v), 9, "middle");
    }
    colour_bar(svg, x + cell, axis + 14, cell * static_cast<double>(n), distance_colour, 0, high,
               "path length, " + unit);
}

std::string picture_of(const LevelSet<2>& u) {
    return encode_png(shape_picture<2>(u, 160));
}
std::string picture_of(const LevelSet<3>& u) {
    return encode_png(shaded_picture(u, side_view(240).camera));
}

double farthest(const DistanceMatrix& m, const std::vector<std::size_t>& a, const std::vector<std::size_t>& b) {
    double most = 0;
    for (const std::size_t i : a) {
        for (const std::size_t j : b) most = std::max(most, i == j ? 0.0 : m(i, j));
    }
    return most;
}
double nearest(const DistanceMatrix& m, const std::vector<std::size_t>& a, const std::vector<std::size_t>& b) {
    double least = 1e300;
    for (const std::size_t i : a) {
        for (const std::size_t j : b) least = i == j ? least : std::min(least, m(i, j));
    }
    return least;
}

double mean(const DistanceMatrix& m, const std::vector<std::size_t>& a, const std::vector<std::size_t>& b) {
    double sum = 0;
    for (const std::size_t i : a) {
        for (const std::size_t j : b) sum += m(i, j);
    }
    return sum / static_cast<double>(a.size() * b.size());
}

}  // namespace

Figure figure_matrices(const FigureOptions& options) {
    Figure figure;
    figure.name = "figure-9";
    figure.title = "Pairwise geodesic distances between letters and between feet";
    figure.numbers.columns = {"collection", "a", "b", "distance", "error_bar", "volume"};

    GeodesicOptions settings = options.geodesic();
    settings.level = options.quick ? 5 : 6;
    settings.time_steps = options.quick ? 2 : 8;
    settings.align = "rigid";
    std::vector<std::string> labels;
    std::vector<LevelSet<2>> letters;
    for (const char* name : {"B DejaVuSans-Bold", "B DejaVuSerif-Bold", "B DejaVuSansMono-Bold", "X DejaVuSans-Bold",
                             "X DejaVuSerif-Bold", "X DejaVuSansMono-Bold", "M DejaVuSans-Bold"}) {
        labels.emplace_back(name);
        letters.push_back(letter_shape(labels.back().substr(0, 1), labels.back().substr(2), settings));
    }
    const DistanceMatrix of_letters = distances_of<2>(labels, letters, settings, figure.checks);
    add_numbers(figure.numbers, "letters", of_letters);

    GeodesicOptions in_3d = options.geodesic(3);
    in_3d.level = options.quick ? 4 : 5;
    in_3d.time_steps = options.quick ? 2 : 4;
    in_3d.align = "rigid";
    datasets::FeetOptions wanted;
    wanted.count = 4;
    wanted.variation = 0.6;
    auto solids = datasets::feet(wanted);
    // As in the paper: feet 1 and 4 of equal volume, 2 and 3 with 13 % less.
    const double volume = datasets::signed_volume(solids[0].mesh);
    for (std::size_t i = 0; i < solids.size(); ++i) {
        const double goal = (i == 1 || i == 2 ? 0.87 : 1.0) * volume;
        const double scale = std::cbrt(goal / datasets::signed_volume(solids[i].mesh));
        for (auto& p : solids[i].mesh.points) {
            for (double& c : p) c *= scale;
        }
    }
    const double scale = fitting_scale(solids);
    std::vector<std::string> foot_labels;
    std::vector<LevelSet<3>> feet;
    std::vector<double> volumes;
    for (std::size_t i = 0; i < solids.size(); ++i) {
        foot_labels.push_back("foot " + std::to_string(i + 1));
        feet.push_back(solid_shape(solids[i], scale, std::max(in_3d.level, 6)));
        volumes.push_back(datasets::signed_volume(solids[i].mesh) * std::pow(scale, 3));
        figure.numbers.add({"feet", foot_labels.back(), "", "", "", exact(volumes.back())});
    }
    const DistanceMatrix of_feet = distances_of<3>(foot_labels, feet, in_3d, figure.checks);
    add_numbers(figure.numbers, "feet", of_feet);

    reports::Svg svg(980, 500);
    std::vector<std::string> pictures, foot_pictures;
    for (const auto& u : letters) pictures.push_back(picture_of(u));
    for (const auto& u : feet) foot_pictures.push_back(picture_of(u));
    draw_matrix(svg, 10, 10, 52, of_letters, pictures, "length of the unit square");
    draw_matrix(svg, 545, 60, 64, of_feet, foot_pictures, "length^1.5 of the unit cube");
    figure.svg = svg.document(figure.title);
    figure.caption =
        "Left: letters (path length, unit: length of the unit square), level " + std::to_string(settings.level) +
        ", K = " + std::to_string(settings.time_steps) + ". Right: generated feet, level " +
        std::to_string(in_3d.level) + ", K = " + std::to_string(in_3d.time_steps) +
        " (unit: length^1.5 of the unit cube); feet 2 and 3 have 13 % less volume than 1 and 4. Dark: far.";

    const std::vector<std::size_t> b{0, 1, 2}, x{3, 4, 5}, m{6}, bx{0, 1, 2, 3, 4, 5};
    const double inside = std::max(farthest(of_letters, b, b), farthest(of_letters, x, x));
    const double between = nearest(of_letters, b, x);
    const double mean_bx = mean(of_letters, b, x), mean_m = mean(of_letters, bx, m);
    figure.checks.push_back({"largest distance within Bs and within Xs", rounded(inside, 3),
                             "below the least between Bs and Xs: " + rounded(between, 3), inside < between,
                             "the paper: Bs and Xs form clusters"});
    figure.checks.push_back({"mean distance of M from the others", rounded(mean_m, 3),
                             "above the mean between Bs and Xs: " + rounded(mean_bx, 3), mean_m > mean_bx,
                             "the paper: the two clusters are closer to each other than M"});
    const auto tree = analysis::linkage(of_letters, analysis::LinkageMethod::average);
    const auto clusters = analysis::cut_by_count(tree, 3);
    const bool right = clusters == analysis::Clustering{0, 0, 0, 1, 1, 1, 2};
    figure.checks.push_back({"three clusters of the letters; cophenetic correlation",
                             rounded(analysis::cophenetic_correlation(tree, of_letters), 3),
                             "Bs, Xs and M apart; above 0.9",
                             right && analysis::cophenetic_correlation(tree, of_letters) > 0.9,
                             "0.9 is the usual mark of a tree that fits its distances very well"});
    const std::vector<std::size_t> three{0, 1, 2}, fourth{3};
    figure.checks.push_back({"least distance of the fourth foot", rounded(nearest(of_feet, three, fourth), 3),
                             "above the largest among the others: " + rounded(farthest(of_feet, three, three), 3),
                             nearest(of_feet, three, fourth) > farthest(of_feet, three, three),
                             "the paper: the fourth is significantly farther from the others"});
    figure.checks.push_back(
        {"volumes of feet 2 and 3 against 1 and 4",
         rounded(100 * (volumes[1] / volumes[0] - 1), 3) + " %, " + rounded(100 * (volumes[2] / volumes[3] - 1), 3) +
             " %",
         "-13 %", std::abs(volumes[1] / volumes[0] - 0.87) < 1e-3 && std::abs(volumes[3] / volumes[0] - 1) < 1e-3,
         "as the paper's feet"});
    return figure;
}

}  // namespace morphodesic::pipeline
