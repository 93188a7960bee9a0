// Figure 7 (cracks against rounded corners), the two geodesics from A to B, and the animation between the time steps.
#include <algorithm>
#include <cmath>

#include "datasets/synthetic.h"
#include "geodesic/grid/measures.h"
#include "geodesic/solver/path_interpolation.h"
#include "geodesic/solver/volume_constraint.h"
#include "pipeline/figures/animation.h"
#include "pipeline/figures/path_rows.h"

namespace morphodesic::pipeline {

Figure figure_cracks(const FigureOptions& options) {
    GeodesicOptions free = options.geodesic();
    if (options.quick) free.level = 6;  // on level 5 the area is kept to 0.3 %, on level 6 to 0.07 %
    const LevelSet<2> x = letter_shape("X", bold_font, free);
    // The same area for both, so that it can be kept.
    const LevelSet<2> m = letter_shape("M", bold_font, free, enclosed_volume<2>(x.grid, x.values.data()));
    // The paper gives lambda / mu, eta = 200 and nu = 0.005, but not mu, and minimisers depend on nu / mu and eta / mu.
    // With mu = 1 the term is less than a tenth of the energy and no match for cracks; where nu counts is shown below.
    struct Case {
        double nu, mu;
        bool keep;
    };
    const std::vector<Case> cases{{0.0, 1.0, false}, {0.005, 1.0, false}, {0.0, 0.03, false}, {0.005, 0.03, true}};

    Figure figure;
    figure.name = "figure-7";
    figure.title = "From X to M: without a contour length term, and with it and area preservation";
    std::vector<GeodesicResult<2>> paths;
    std::vector<LabelledPath> drawn;
    std::string summaries;
    struct Contours {
        double excess = -1e300;  ///< largest excess over the straight line from X to M
        /// Mean of those between, each per root of its area: shapes whose area is not kept shrink on the way (by 8 % at
        /// mu = 0.03), which shortens their contour as well.
        double per_root_of_area = 0;
        int least_euler = 1, most_parts = 1;
    };
    std::vector<Contours> contours;
    for (const Case& c : cases) {
        GeodesicOptions settings = free;
        settings.area_weight = c.nu;
        settings.preserve_volume = c.keep;
        settings.lambda *= c.mu / settings.mu;
        settings.mu = c.mu;
        paths.push_back(compute_discrete_geodesic<2>(x, m, settings));
        const auto& path = paths.back();
        const std::string name = "nu = " + rounded(c.nu) + "; mu = " + rounded(c.mu) + (c.keep ? "; area kept" : "");
        add_path_numbers(figure.numbers, name, path);
        figure.checks.push_back(solved(name, path));
        summaries += (summaries.empty() ? "" : ". ") + name + ": " + path_summary(path);
        Contours& found = contours.emplace_back();
        double drift = 0;
        const double area = measure(path.shapes.front()).volume;
        const double first = measure(path.shapes.front()).surface, last = measure(path.shapes.back()).surface;
        const auto steps = static_cast<double>(path.deformations.size());
        for (std::size_t k = 1; k + 1 < path.shapes.size(); ++k) {
            const auto& u = path.shapes[k];
            const ShapeMeasures measures = measure(u);
            const double straight = first + (last - first) * static_cast<double>(k) / steps;
            found.excess = std::max(found.excess, measures.surface / straight - 1);
            found.per_root_of_area += measures.surface / std::sqrt(measures.volume) / (steps - 1);
            found.least_euler = std::min(found.least_euler, measures.euler);
            found.most_parts = std::max(found.most_parts, measures.components);
            drift = std::max(drift, std::abs(measures.volume / area - 1));
        }
        if (c.keep) {
            figure.checks.push_back({name + ": largest change of the area", rounded(100 * drift, 2) + " %",
                                     "within 0.5 %", drift < 0.005, "what area preservation is asked to mean here"});
        }
    }
    for (std::size_t i = 0; i < cases.size(); ++i) {
        drawn.push_back(
            {{"nu = " + rounded(cases[i].nu), "mu = " + rounded(cases[i].mu), cases[i].keep ? "area kept" : ""},
             &paths[i]});
    }
    figure.svg = paths_with_dissipation(figure.title, drawn, 0.72);
    figure.caption =
        "Without the contour length term cracks form; with it they are damped and corners are rounded. Minimisers "
        "depend on nu / mu and eta / mu (eta = 200), and the paper does not name mu: at mu = 1 its nu = 0.005 does "
        "little, at mu = 0.03 it does what its figure shows. X and M have the same area; where it is kept, it is "
        "kept in every shape between. " +
        summaries + ".";
    const auto percent = [](double share) { return rounded(100 * share, 2) + " %"; };
    const Contours &cracked = contours[0], &stiff = contours[2], &smooth = contours[3];
    const std::string excess = "contour over the straight line between those of X and M, at most";
    if (!options.quick) {  // on coarser grids a crack is narrower than a cell and closes
        figure.checks.push_back(
            {"nu = 0, mu = 1: " + excess,
             percent(cracked.excess) + ", least Euler number " + std::to_string(cracked.least_euler),
             "above 0: contour that neither X nor M has", cracked.excess > 0,
             "a crack is contour that appears and goes again"});
    }
    figure.checks.push_back({"nu = 0.005, mu = 0.03: " + excess, percent(smooth.excess),
                             "not above 0: rounded, no cracks", smooth.excess <= 0,
                             "rounding of corners shortens, cracks lengthen the contour"});
    if (!options.quick) {  // a hole of the coarse grid may be one node
        figure.checks.push_back({"nu = 0.005, mu = 0.03: least Euler number, most parts",
                                 std::to_string(smooth.least_euler) + ", " + std::to_string(smooth.most_parts),
                                 "1, 1: one piece without holes", smooth.least_euler == 1 && smooth.most_parts == 1,
                                 "X and M are one piece without holes"});
    }
    figure.checks.push_back({"mean contour between per root of the area, mu = 0.03, nu = 0.005",
                             rounded(smooth.per_root_of_area),
                             "below that of nu = 0: " + rounded(stiff.per_root_of_area),
                             smooth.per_root_of_area < stiff.per_root_of_area, "the term asks for it"});
    return figure;
}

Figure figure_two_geodesics(const FigureOptions& options) {
    GeodesicOptions settings = options.geodesic();
    settings.starts = 1;
    const LevelSet<2> a = letter_shape("A", bold_font, settings), b = letter_shape("B", bold_font, settings);
    Figure figure;
    figure.name = "two-geodesics";
    figure.title = "Two geodesics from A to B, a lower and a higher one";
    // Local minima are found from different places and turns of A; what differs in topology on the way is another path.
    FigureTable starts;
    starts.columns = {"rank", "shift_y", "turn_radians", "total_energy", "path_length", "euler_numbers", "shown"};
    struct Found {
        GeodesicResult<2> path;
        double shift, turn;
    };
    std::vector<Found> found;
    GeodesicOptions scout = settings;
    scout.level = 5;
    const int shape_grid = a.grid.level();
    for (const double turn : {0.0, -0.3}) {
        for (const double shift : {0.0, -0.04, -0.08, -0.12, -0.16, -0.20, 0.10}) {
            auto motion = turn_by(turn);
            motion.translation = {0.0, shift};
            found.push_back({compute_discrete_geodesic<2>(moved(a, motion, shape_grid), b, scout), shift, turn});
        }
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Found& p, const Found& q) { return p.path.total_energy < q.path.total_energy; });
    // Where the holes are in the middle of the path: their signature tells the two kinds apart.
    const auto signature = [](const GeodesicResult<2>& path) {
        std::vector<int> euler;
        for (const auto& u : path.shapes) euler.push_back(measure(u).euler);
        return euler;
    };
    std::size_t other = 1;
    while (other + 1 < found.size() && (signature(found[other].path) == signature(found[0].path) ||
                                        found[other].path.total_energy < 1.05 * found[0].path.total_energy)) {
        ++other;
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        std::string euler;
        for (const int e : signature(found[i].path)) euler += (euler.empty() ? "" : " ") + std::to_string(e);
        starts.add({std::to_string(i + 1), exact(found[i].shift), exact(found[i].turn),
                    exact(found[i].path.total_energy), exact(found[i].path.path_length), euler,
                    i == 0 || i == other ? "shown" : ""});
    }
    figure.files.push_back({"two-geodesics-starts.csv", starts.csv()});
    std::vector<GeodesicResult<2>> paths;
    for (const std::size_t i : {std::size_t{0}, other}) {
        auto motion = turn_by(found[i].turn);
        motion.translation = {0.0, found[i].shift};
        paths.push_back(compute_discrete_geodesic<2>(moved(a, motion, shape_grid), b, settings));
    }
    if (paths[1].total_energy < paths[0].total_energy) std::swap(paths[0], paths[1]);
    std::vector<LabelledPath> drawn;
    for (std::size_t i = 0; i < 2; ++i) {
        const std::string name = i == 0 ? "lower" : "higher";
        add_path_numbers(figure.numbers, name, paths[i]);
        drawn.push_back({{name, "E = " + rounded(paths[i].total_energy, 3)}, &paths[i]});
    }
    figure.svg = paths_with_dissipation(figure.title, drawn, 0.8);
    figure.caption =
        "Both are local minima of the energy (14), found from different places of A. Lower: " + path_summary(paths[0]) +
        ", E = " + rounded(paths[0].total_energy) + ". Higher: " + path_summary(paths[1]) +
        ", E = " + rounded(paths[1].total_energy) + ".";
    figure.checks = {solved("lower", paths[0]),
                     solved("higher", paths[1]),
                     {"energy of the higher path", rounded(paths[1].total_energy),
                      "above that of the lower: " + rounded(paths[0].total_energy),
                      paths[1].total_energy > 1.02 * paths[0].total_energy,
                      "further apart than solves of one minimum end: the tolerance leaves less than 1 %"}};
    return figure;
}

Figure figure_animation(const FigureOptions& options) {
    const GeodesicOptions settings = options.geodesic();
    const auto path = compute_discrete_geodesic<2>(letter_shape("A", bold_font, settings),
                                                   letter_shape("B", bold_font, settings), settings);
    Figure figure;
    figure.name = "animation";
    figure.title = "The geodesic from A to B between its time steps";
    const int frames = options.quick ? 9 : 33, columns = 9;
    figure.numbers.columns = {"t", "area", "perimeter", "euler_number"};
    for (int i = 0; i < frames; ++i) {
        const double t = static_cast<double>(i) / (frames - 1);
        const ShapeMeasures m = measure(shape_at(path, t));
        figure.numbers.add({exact(t), exact(m.volume), exact(m.surface), std::to_string(m.euler)});
    }
    reports::Svg svg(20 + 104.0 * columns, 130);
    const Row row{10, 10, 100, 4, 0.8, {0.5, 0.5}, 1.0};
    for (int i = 0; i < columns; ++i) {
        // Between the steps: at a quarter of each, so that no shape is one of the discrete path.
        const double t = (i + (i + 1 < columns ? 0.3 : 0.0)) / (columns - 1);
        fill_shape(svg, row.panel(static_cast<std::size_t>(i)), shape_at(path, t), "#565f6c");
        svg.text(row.panel(static_cast<std::size_t>(i)).x + 50, 120, "t = " + rounded(t, 3), 10, "middle");
    }
    figure.svg = svg.document(figure.title);
    figure.files.push_back({"animation.webp", path_animation(path, options.quick ? 120 : 320, frames)});
    double jump = 0, before = 0;
    for (int i = 0; i <= 64; ++i) {
        const double area = measure(shape_at(path, i / 64.0)).volume;
        if (i > 0) jump = std::max(jump, std::abs(area / before - 1));
        before = area;
    }
    figure.caption = "Shapes between the time steps by (6)-(8); the animation shows " + std::to_string(frames) +
                     " of them with the dissipation as colour. " + path_summary(path) + ".";
    figure.checks = {solved("A to B", path),
                     {"largest change of the area from one of 65 frames to the next", rounded(100 * jump, 2) + " %",
                      "below 5 %: nothing jumps", jump < 0.05,
                      "a step of K = 8 is 8 frames; a jump would show the change of a whole step in one of them"}};
    return figure;
}

}  // namespace morphodesic::pipeline
