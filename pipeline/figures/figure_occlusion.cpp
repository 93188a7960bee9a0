// Figure 8: a matchstick man whose arm and leg are partly hidden.
#include <algorithm>
#include <cmath>

#include "datasets/synthetic.h"
#include "pipeline/figures/path_rows.h"

namespace morphodesic::pipeline {
namespace {

/// Torso, head, arms and legs of datasets::matchstick in this order; each limb is two polygons.
enum : std::size_t { left_forearm = 5, left_shank = 9 };

Point<2> middle(const datasets::Loop& loop) {
    Point<2> sum{};
    for (const Point<2>& p : loop) {
        sum[0] += p[0] / static_cast<double>(loop.size());
        sum[1] += p[1] / static_cast<double>(loop.size());
    }
    return sum;
}

}  // namespace

Figure figure_occlusion(const FigureOptions& options) {
    GeodesicOptions settings = options.geodesic();
    if (options.quick) settings.level = 6;  // limbs are thinner than the cells of coarser grids
    datasets::CollectionOptions collection;
    collection.count = 12;
    collection.variation = 0.0;
    const auto men = datasets::matchstick(collection);
    const auto pose = [&](const std::string& label) -> std::vector<datasets::Loop> {
        for (const auto& man : men) {
            if (man.label == label) return man.polygons;
        }
        throw std::invalid_argument("there is no matchstick man " + label);
    };
    auto whole_polygons = pose("adult_wave"), hidden_polygons = whole_polygons;
    // What a thing in front of the figure hides: disks around the forearm and the shank.
    std::vector<std::pair<Point<2>, double>> covers{{middle(whole_polygons[left_forearm]), 0.085},
                                                    {middle(whole_polygons[left_shank]), 0.10}};
    const auto whole = level_set_of(whole_polygons, settings, false);
    const auto target = level_set_of(pose("adult_walk"), settings, false);
    LevelSet<2> hidden = whole;
    ScalarField<2> mask(whole.grid, 1.0);
    for (std::size_t i = 0; i < hidden.values.size(); ++i) {
        const Point<2> x = whole.grid.position(whole.grid.node(i));
        for (const auto& [centre, radius] : covers) {
            const double outside = std::hypot(x[0] - centre[0], x[1] - centre[1]) - radius;
            hidden.values[i] = std::min(hidden.values[i], outside);
            // A smooth mask: 0 in the disk, 1 from a fiftieth of the square beyond it.
            const double s = std::clamp(outside / 0.02, 0.0, 1.0);
            mask.values[i] = std::min(mask.values[i], s * s * (3 - 2 * s));
        }
    }
    const auto full = compute_discrete_geodesic<2>(whole, target, settings);
    const auto blind = compute_discrete_geodesic<2>(hidden, target, settings);
    const auto masked = compute_discrete_geodesic<2>(hidden, target, settings, mask);

    Figure figure;
    figure.name = "figure-8";
    figure.title = "A matchstick man, part of an arm and a leg of the first shape hidden";
    add_path_numbers(figure.numbers, "nothing hidden", full);
    add_path_numbers(figure.numbers, "hidden, with mask", masked);
    add_path_numbers(figure.numbers, "hidden, without mask", blind);
    const std::size_t shapes = masked.shapes.size();
    reports::Svg svg(90 + 84.0 * static_cast<double>(shapes), 418);
    Row row{84, 8, 80, 4, 0.48, {0.5, 0.5}, 1.6};
    for (const auto* path : {&masked, &blind, &full}) {
        svg.text(6, row.y + 50, path == &masked ? "with mask" : path == &blind ? "without mask" : "not hidden", 11);
        svg.text(6, row.y + 66, "length " + rounded(path->path_length, 3), 10);
        if (path != &full) {
            for (const auto& [centre, radius] : covers) {
                const auto [px, py] = row.panel(0).at(centre);
                svg.circle(px, py, radius * row.panel(0).scale(), "#eceff3", "#aab2bd", 0.7);
            }
        }
        draw_shapes(svg, row, path->shapes, "#565f6c");
        row.y += 136;
    }
    figure.svg = svg.document(figure.title);
    figure.caption =
        "Disks: hidden parts of the first shape, where the mask of the mismatch (12) of the first step is zero. "
        "With the mask the arm and the leg come back in shape 1; without it they have to grow. Masked: " +
        path_summary(masked) + "; without mask: " + path_summary(blind) + "; nothing hidden: " + path_summary(full) +
        ".";
    const double with = std::abs(masked.path_length / full.path_length - 1),
                 without = std::abs(blind.path_length / full.path_length - 1);
    figure.checks = {solved("with mask", masked),
                     solved("without mask", blind),
                     solved("nothing hidden", full),
                     {"distance with mask against nothing hidden",
                      rounded(masked.path_length, 4) + " / " + rounded(full.path_length, 4),
                      "nearer to it than without mask: " + rounded(blind.path_length, 4), with < without,
                      "a mask that helps; the hidden pose is free, so the masked distance may be below the full one"}};
    return figure;
}

}  // namespace morphodesic::pipeline
