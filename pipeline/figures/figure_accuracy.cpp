// The convergence report of the solver: closed forms in 2D and 3D, time steps, moved and reversed pairs.
#include <algorithm>
#include <cmath>

#include "datasets/synthetic.h"
#include "geodesic/solver/rigid_motion.h"
#include "pipeline/figures/axes.h"
#include "pipeline/figures/path_rows.h"
#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {
namespace {

constexpr double r0 = 0.20, r1 = 0.25;
constexpr const char* font = "DejaVuSans-Bold";

struct Report {
    Figure figure;

    template <int Dim>
    void add(const std::string& study, const std::string& pair, const GeodesicResult<Dim>& path, double reference,
             double deviation) {
        const auto& o = path.options;
        int evaluations = 0;
        for (const LevelReport& level : path.levels) {
            if (level.level == o.level) evaluations += level.evaluations;
        }
        figure.numbers.add({study, pair, std::to_string(o.level), std::to_string(o.time_steps), exact(path.path_length),
                            exact(path.error), exact(path.extrapolated_length), exact(path.total_energy),
                            exact(path.min_det), exact(reference), exact(deviation), std::to_string(evaluations),
                            exact(path.seconds)});
    }
    void check(const std::string& what, double value, double limit, const std::string& reason) {
        figure.checks.push_back({what, rounded(100 * value, 2) + " %", "at most " + rounded(100 * limit, 3) + " %",
                                 value <= limit, reason});
    }
};

struct Errors {
    Series computed, extrapolated;
    bool within_bars = true;
};

/// Balls of two radii on growing levels.
template <int Dim>
Errors balls(Report& report, GeodesicOptions o, int coarsest, int finest) {
    Errors errors;
    o.time_steps = Dim == 2 ? 4 : 2;
    const double exact_length = distance_of_balls(Dim, o, r0, r1);
    Point<Dim> centre;
    centre.fill(0.5);
    for (o.level = coarsest; o.level <= finest; ++o.level) {
        const DyadicGrid<Dim> grid(o.level);
        const auto path = compute_discrete_geodesic<Dim>(datasets::ball<Dim>(grid, centre, r0),
                                                         datasets::ball<Dim>(grid, centre, r1), o);
        const double error = path.path_length / exact_length - 1;
        report.add<Dim>("closed form " + std::to_string(Dim) + "D", "balls 0.20 and 0.25", path, exact_length, error);
        errors.computed.emplace_back(o.level, 100 * std::abs(error));
        errors.extrapolated.emplace_back(o.level, 100 * std::abs(path.extrapolated_length / exact_length - 1));
        errors.within_bars = errors.within_bars && std::abs(path.path_length - exact_length) <= path.error;
    }
    return errors;
}

/// The length of one pair with more and more time steps.
Series in_time(Report& report, const std::string& from, const std::string& to, GeodesicOptions o, int most) {
    Series lengths;
    const auto a = letter_shape(from, font, o), b = letter_shape(to, font, o);
    for (o.time_steps = 2; o.time_steps <= most; o.time_steps *= 2) {
        const auto path = compute_discrete_geodesic<2>(a, b, o);
        report.add<2>("time steps", from + " " + to, path, lengths.empty() ? path.path_length : lengths[0].second,
                      lengths.empty() ? 0.0 : path.path_length / lengths[0].second - 1);
        lengths.emplace_back(std::log2(o.time_steps), path.path_length);
    }
    return lengths;
}

double spread(const Series& series) {
    const auto by_length = [](const auto& x, const auto& y) { return x.second < y.second; };
    const auto [low, high] = std::minmax_element(series.begin(), series.end(), by_length);
    return high->second / low->second - 1;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

/// Letters there and back; returns the relative differences and the mean length.
std::pair<std::vector<double>, double> reversed_pairs(Report& report, const GeodesicOptions& o, std::size_t count) {
    const std::vector<std::pair<std::string, std::string>> pairs = {{"A", "B"}, {"C", "G"}, {"M", "X"}, {"K", "R"},
                                                                    {"E", "F"}, {"O", "Q"}, {"H", "N"}, {"S", "Z"},
                                                                    {"P", "D"}, {"T", "Y"}, {"U", "V"}, {"L", "J"}};
    std::vector<double> differences;
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto a = letter_shape(pairs[i].first, font, o), b = letter_shape(pairs[i].second, font, o);
        const auto there = compute_discrete_geodesic<2>(a, b, o), back = compute_discrete_geodesic<2>(b, a, o);
        const double mean = 0.5 * (there.path_length + back.path_length);
        differences.push_back(std::abs(there.path_length - back.path_length) / mean);
        report.add<2>("reversed", pairs[i].first + " " + pairs[i].second, there, back.path_length, differences.back());
        sum += mean;
    }
    return {differences, sum / static_cast<double>(count)};
}

/// Changes by rigid motions, as shares of the typical distance.
struct MotionChanges {
    double first = 0.0;      ///< of d(A, B), when A is moved, which is aligned
    double second = 0.0;     ///< of d(A, B), when B is moved, which is brought to a pose of its own
    double to_itself = 0.0;  ///< d(moved A, A)
};

MotionChanges moved_shapes(Report& report, const GeodesicOptions& o, double typical, int motions) {
    const auto a = letter_shape("A", font, o), b = letter_shape("B", font, o);
    const auto still = compute_discrete_geodesic<2>(a, b, o);
    report.add<2>("moved", "A B", still, still.path_length, 0.0);
    MotionChanges changes;
    const auto difference = [&](const std::string& name, const GeodesicResult<2>& path) {
        const double share = std::abs(path.path_length - still.path_length) / typical;
        report.add<2>("moved", name, path, still.path_length, share);
        return share;
    };
    for (int i = 0; i < motions; ++i) {
        const double angle = 0.4 + 1.7 * i;
        auto motion = turn_by(angle);
        motion.translation = {0.031 - 0.02 * i, -0.023 + 0.017 * i};
        const auto turned_a = moved(a, motion, a.grid.level()), turned_b = moved(b, motion, b.grid.level());
        const std::string turned = " turned by " + rounded(angle, 2);
        const auto to_b = compute_discrete_geodesic<2>(turned_a, b, o);
        const auto to_turned_b = compute_discrete_geodesic<2>(a, turned_b, o);
        const auto to_a = compute_discrete_geodesic<2>(turned_a, a, o);
        changes.first = std::max(changes.first, difference("A" + turned + " to B", to_b));
        changes.second = std::max(changes.second, difference("A to B" + turned, to_turned_b));
        report.add<2>("moved", "A" + turned + " to A", to_a, 0.0, to_a.path_length / typical);
        changes.to_itself = std::max(changes.to_itself, to_a.path_length / typical);
    }
    return changes;
}

}  // namespace

Figure figure_accuracy(const FigureOptions& options) {
    Report report;
    Figure& figure = report.figure;
    figure.name = "accuracy";
    figure.title = "What path lengths are off by";
    figure.numbers.columns = {
        "study",        "pair",    "level",     "steps_K",   "path_length",          "error_bar", "extrapolated_length",
        "total_energy", "min_det", "reference", "deviation", "evaluations_on_level", "seconds"};
    const bool quick = options.quick;
    GeodesicOptions base = options.geodesic();
    base.tolerance = 1e-3;
    GeodesicOptions closed = base;
    closed.tolerance = 1e-4;
    const Errors disks = balls<2>(report, closed, 4, quick ? 5 : 7);
    closed.tolerance = 1e-3;
    const Errors solids = balls<3>(report, closed, 4, quick ? 4 : 6);

    GeodesicOptions steps = base;
    steps.level = quick ? 5 : 6;
    steps.tolerance = quick ? 1e-3 : 1e-4;
    const Series ab = in_time(report, "A", "B", steps, quick ? 4 : 32);
    const Series xm = in_time(report, "X", "M", steps, quick ? 4 : 32);

    GeodesicOptions standard = settings_of_preset("standard").geodesic;
    if (quick) {
        standard.level = 5;
        standard.time_steps = 2;
    }
    const auto standard_differences = reversed_pairs(report, standard, quick ? 2 : 12).first;
    GeodesicOptions fine = standard;
    if (!quick) fine = settings_of_preset("fine").geodesic;
    const auto [differences, typical] = reversed_pairs(report, fine, quick ? 1 : 12);
    const MotionChanges changes = moved_shapes(report, fine, typical, quick ? 1 : 4);

    reports::Svg svg(900, 330);
    const auto [low, high] = range_of({disks.computed, disks.extrapolated, solids.computed, solids.extrapolated});
    const reports::Scale x{4, 7, 80, 420}, y{std::min(0.0, low), high, 270, 30};
    draw_log2_axes(svg, x, y, "grid size h", "error of the length, %",
                   [](int e) { return "1/" + std::to_string(1 << e); });
    const auto labelled = [&](const Series& series, const std::string& colour, const std::string& name,
                              int shift = -8) {
        plot(svg, x, y, series, colour);
        svg.text(x(series.front().first) + 6, y(series.front().second) + shift, name, 11, "start", colour, true,
                 "#ffffff");
    };
    labelled(disks.computed, "#1f4e8c", "disks");
    labelled(disks.extrapolated, "#7aa0cc", "disks, extrapolated", 16);
    labelled(solids.computed, "#c2603a", "balls");
    labelled(solids.extrapolated, "#e0a488", "balls, extrapolated");
    const auto [low_k, high_k] = range_of({ab, xm});
    const reports::Scale xk{1, ab.back().first, 520, 860}, yk{low_k, high_k, 270, 30};
    draw_log2_axes(svg, xk, yk, "time steps K, level " + std::to_string(steps.level), "path length",
                   [](int e) { return std::to_string(1 << e); });
    plot(svg, xk, yk, ab, "#1f4e8c");
    plot(svg, xk, yk, xm, "#c2603a");
    svg.text(xk(1) + 6, yk(ab.front().second) - 12, "A to B", 11, "start", "#1f4e8c", true, "#ffffff");
    svg.text(xk(1) + 6, yk(xm.front().second) - 12, "X to M", 11, "start", "#c2603a", true, "#ffffff");
    figure.svg = svg.document(figure.title);
    figure.caption =
        "Left: concentric disks (K = 4) and balls (K = 2) of radius 0.20 and 0.25 against their closed forms, as "
        "computed and extrapolated. Right: two pairs of letters with more and more time steps. The table adds letters "
        "there and back, and letters that were moved.";

    const auto last = [](const Series& s) { return 0.01 * s.back().second; };
    report.check("disks, finest grid, as computed", last(disks.computed), quick ? 0.09 : 0.03, "the closed form");
    report.check("disks, finest grid, extrapolated", last(disks.extrapolated), quick ? 0.05 : 0.01, "the closed form");
    report.check("balls, finest grid, extrapolated", last(solids.extrapolated), quick ? 0.10 : 0.02, "the closed form");
    figure.checks.push_back({"true errors within the error bars",
                             disks.within_bars && solids.within_bars ? "all" : "no", "all",
                             disks.within_bars && solids.within_bars, "that is what error bars are for"});
    report.check(
        "spread over K, A to B", spread(ab), quick ? 0.15 : 0.03,
        "lengths converge in K; closing the feet of the A in one step costs eta = 25 K times an area of the grid's "
        "size, so more with more steps, and less on finer grids");
    report.check("spread over K, X to M", spread(xm), quick ? 0.10 : 0.03, "the same, with cracks that open and close");
    report.check("there and back, median, standard", median(standard_differences), quick ? 0.20 : 0.02,
                 "a distance is symmetric");
    report.check("there and back, median, fine", median(differences), quick ? 0.20 : 0.02, "a distance is symmetric");
    const double most = quick ? 0.10 : 0.01;
    report.check("first letter moved, of the typical distance", changes.first, most,
                 "rigid motions should not be seen; it is aligned");
    report.check("second letter moved, of the typical distance", changes.second, most,
                 "the same; it is brought to a pose of its own, where the grid sees it as before");
    report.check("moved letter to itself, of the typical distance", changes.to_itself, most, "the distance is 0");
    return figure;
}

}  // namespace morphodesic::pipeline
