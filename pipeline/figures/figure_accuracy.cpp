// The convergence report of the solver: closed forms in 2D and 3D, time steps, moved and reversed pairs.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/synthetic.h"
#include "geodesic/solver/rigid_motion.h"
#include "pipeline/figures/axes.h"
#include "pipeline/figures/path_rows.h"
#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {
namespace {

constexpr double r0 = 0.20, r1 = 0.25;

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

/// The length of one pair with more and more time steps, and the ends of its error bars.
struct Lengths {
    Series lengths, lower, upper;
};

Lengths in_time(Report& report, const std::string& from, const std::string& to, GeodesicOptions o, int most) {
    Lengths result;
    Series& lengths = result.lengths;
    const auto a = letter_shape(from, bold_font, o), b = letter_shape(to, bold_font, o);
    for (o.time_steps = 2; o.time_steps <= most; o.time_steps *= 2) {
        const auto path = compute_discrete_geodesic<2>(a, b, o);
        report.add<2>("time steps", from + " " + to, path, lengths.empty() ? path.path_length : lengths[0].second,
                      lengths.empty() ? 0.0 : path.path_length / lengths[0].second - 1);
        const double at = std::log2(o.time_steps);
        lengths.emplace_back(at, path.path_length);
        result.lower.emplace_back(at, path.path_length - path.error);
        result.upper.emplace_back(at, path.path_length + path.error);
    }
    return result;
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

/// One pair of letters, solved there and back.
struct ReversedPair {
    std::string from, to;
    double there = 0.0, back = 0.0;
    [[nodiscard]] double mean() const { return 0.5 * (there + back); }
    [[nodiscard]] double difference() const { return std::abs(there - back) / mean(); }
};

std::vector<ReversedPair> reversed_pairs(Report& report, const GeodesicOptions& o, std::size_t count) {
    std::vector<ReversedPair> pairs = {{"A", "B"}, {"C", "G"}, {"M", "X"}, {"K", "R"}, {"E", "F"}, {"O", "Q"},
                                       {"H", "N"}, {"S", "Z"}, {"P", "D"}, {"T", "Y"}, {"U", "V"}, {"L", "J"}};
    pairs.resize(count);
    for (ReversedPair& pair : pairs) {
        const auto a = letter_shape(pair.from, bold_font, o), b = letter_shape(pair.to, bold_font, o);
        const auto there = compute_discrete_geodesic<2>(a, b, o), back = compute_discrete_geodesic<2>(b, a, o);
        pair.there = there.path_length;
        pair.back = back.path_length;
        report.add<2>("reversed", pair.from + " " + pair.to, there, back.path_length, pair.difference());
    }
    return pairs;
}

double median_difference(const std::vector<ReversedPair>& pairs) {
    std::vector<double> differences;
    for (const ReversedPair& pair : pairs) differences.push_back(pair.difference());
    return median(differences);
}

double mean_length(const std::vector<ReversedPair>& pairs) {
    double sum = 0.0;
    for (const ReversedPair& pair : pairs) sum += pair.mean();
    return sum / static_cast<double>(pairs.size());
}

/// Changes by rigid motions, as shares of the typical distance.
struct MotionChanges {
    std::vector<double> first;      ///< of d(a, b), when a is moved, which is aligned
    std::vector<double> second;     ///< of d(a, b), when b is moved, which is brought to a pose of its own
    std::vector<double> to_itself;  ///< d(moved a, a)
};

/// @param pairs their lengths with the same options; the first `count` of them are moved `motions` times each
MotionChanges moved_shapes(Report& report, const GeodesicOptions& o, const std::vector<ReversedPair>& pairs,
                           std::size_t count, int motions) {
    const double typical = mean_length(pairs);
    MotionChanges changes;
    int number = 0;
    for (std::size_t p = 0; p < count; ++p) {
        const auto& [from, to, length, back] = pairs[p];
        const auto a = letter_shape(from, bold_font, o), b = letter_shape(to, bold_font, o);
        const auto change = [&](const std::string& name, const GeodesicResult<2>& path, double reference) {
            const double share = std::abs(path.path_length - reference) / typical;
            report.add<2>("moved", name, path, reference, share);
            return share;
        };
        for (int i = 0; i < motions; ++i, ++number) {
            const double angle = std::remainder(0.4 + 1.7 * number, 2 * std::numbers::pi);
            auto motion = turn_by(angle);
            motion.translation = {0.031 - 0.02 * (number % 4), -0.023 + 0.017 * (number % 4)};
            const auto turned_a = moved(a, motion, a.grid.level()), turned_b = moved(b, motion, b.grid.level());
            const std::string turned = " turned by " + rounded(angle, 2);
            const auto to_b = compute_discrete_geodesic<2>(turned_a, b, o);
            const auto to_turned_b = compute_discrete_geodesic<2>(a, turned_b, o);
            const auto to_a = compute_discrete_geodesic<2>(turned_a, a, o);
            changes.first.push_back(change(from + turned + " to " + to, to_b, length));
            changes.second.push_back(change(from + " to " + to + turned, to_turned_b, length));
            changes.to_itself.push_back(change(from + turned + " to " + from, to_a, 0.0));
        }
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
    const Lengths ab = in_time(report, "A", "B", steps, quick ? 4 : 32);
    const Lengths xm = in_time(report, "X", "M", steps, quick ? 4 : 32);
    const Lengths ba = in_time(report, "B", "A", steps, quick ? 4 : 32);
    const Lengths mx = in_time(report, "M", "X", steps, quick ? 4 : 32);

    GeodesicOptions standard = settings_of_preset("standard").geodesic;
    if (quick) {
        standard.level = 5;
        standard.time_steps = 2;
    }
    const auto standard_pairs = reversed_pairs(report, standard, quick ? 2 : 12);
    GeodesicOptions fine = standard;
    if (!quick) fine = settings_of_preset("fine").geodesic;
    const auto fine_pairs = reversed_pairs(report, fine, quick ? 1 : 12);
    const MotionChanges changes = moved_shapes(report, fine, fine_pairs, quick ? 1 : 6, quick ? 1 : 2);

    reports::Svg svg(900, 330);
    const auto [low, high] = range_of({disks.computed, disks.extrapolated, solids.computed, solids.extrapolated});
    const reports::Scale x{4, 7, 80, 420}, y{std::min(0.0, low), high, 270, 30};
    draw_log2_axes(svg, x, y, "grid size h", "error of the length, %",
                   [](int e) { return "1/" + std::to_string(1 << e); });
    double row = 42;
    const auto listed = [&](const Series& series, const std::string& colour, const std::string& name) {
        plot(svg, x, y, series, colour);
        plot(svg, {0, 1, 270, 294}, {0, 1, row, row - 1}, {{0, 0}, {1, 0}}, colour);
        svg.text(302, row, name, 11, "start", colour);
        row += 18;
    };
    listed(solids.computed, "#c2603a", "balls");
    listed(disks.computed, "#1f4e8c", "disks");
    listed(solids.extrapolated, "#e0a488", "balls, extrapolated");
    listed(disks.extrapolated, "#7aa0cc", "disks, extrapolated");
    const auto [low_k, high_k] = range_of({ab.lower, ab.upper, ba.lengths, xm.lower, xm.upper, mx.lengths});
    const reports::Scale xk{1, ab.lengths.back().first, 520, 860}, yk{low_k, high_k, 270, 30};
    draw_log2_axes(svg, xk, yk, "time steps K, level " + std::to_string(steps.level), "path length",
                   [](int e) { return std::to_string(1 << e); });
    const auto with_bars = [&](const Lengths& pair, const std::string& colour, const std::string& name) {
        for (std::size_t i = 0; i < pair.lengths.size(); ++i) {
            const double at = xk(pair.lengths[i].first);
            svg.line(at, yk(pair.lower[i].second), at, yk(pair.upper[i].second), "#8fa5c2", 1.5);
        }
        plot(svg, xk, yk, pair.lengths, colour);
        svg.text(0.5 * (xk(1) + xk(2)), yk(std::max(pair.lengths[0].second, pair.lengths[1].second)) - 10, name, 11,
                 "middle", colour, true, "#ffffff");
    };
    const auto back = [&](const Lengths& pair, const std::string& colour, const std::string& name) {
        plot(svg, xk, yk, pair.lengths, colour);
        svg.text(860, yk(pair.lengths.back().second) - 8, name, 11, "end", colour);
    };
    back(ba, "#7aa0cc", "B to A");
    back(mx, "#e0a488", "M to X");
    with_bars(ab, "#1f4e8c", "A to B");
    with_bars(xm, "#c2603a", "X to M");
    figure.svg = svg.document(figure.title);
    figure.caption =
        "Left: concentric disks (K = 4) and balls (K = 2) of radius 0.20 and 0.25 against their closed forms, as "
        "computed and extrapolated. Right: two pairs of letters, there and back, with more and more time steps; there "
        "with error bars. The "
        "table adds letters there and back, and letters that were moved.";

    const auto last = [](const Series& s) { return 0.01 * s.back().second; };
    report.check("disks, finest grid, as computed", last(disks.computed), quick ? 0.09 : 0.03, "the closed form");
    report.check("disks, finest grid, extrapolated", last(disks.extrapolated), quick ? 0.05 : 0.01, "the closed form");
    report.check("balls, finest grid, extrapolated", last(solids.extrapolated), quick ? 0.10 : 0.02, "the closed form");
    figure.checks.push_back({"true errors within the error bars",
                             disks.within_bars && solids.within_bars ? "all" : "no", "all",
                             disks.within_bars && solids.within_bars, "that is what error bars are for"});
    report.check(
        "spread over K, A to B", spread(ab.lengths), quick ? 0.15 : 0.03,
        "the stiffness of a step is that of the shape it begins with, in (13): gaps that close, as between the feet of "
        "the A, cost too little in long steps, an error of first order in 1 / K");
    report.check("spread over K, B to A", spread(ba.lengths), quick ? 0.15 : 0.03,
                 "the direction that studies and `geodesic` choose, from the fuller shape: gaps open");
    report.check("spread over K, X to M", spread(xm.lengths), quick ? 0.10 : 0.03, "the same: gaps open");
    report.check("spread over K, M to X", spread(mx.lengths), quick ? 0.15 : 0.03,
                 "as from A to B: the gaps of the M close");
    report.check("there and back, median, standard", median_difference(standard_pairs), quick ? 0.20 : 0.02,
                 "a distance is symmetric");
    report.check("there and back, median, fine", median_difference(fine_pairs), quick ? 0.20 : 0.02,
                 "a distance is symmetric");
    const double most = quick ? 0.10 : 0.01;
    const auto moved_by = [&](const std::string& what, const std::vector<double>& shares, const std::string& reason) {
        const double largest = *std::max_element(shares.begin(), shares.end());
        figure.checks.push_back({what + ", of the typical distance",
                                 "median " + rounded(100 * median(shares), 2) + " %, largest of " +
                                     std::to_string(shares.size()) + " " + rounded(100 * largest, 2) + " %",
                                 "at most " + rounded(100 * most, 3) + " %", largest <= most, reason});
    };
    moved_by("first letter moved", changes.first, "rigid motions should not be seen; it is aligned");
    moved_by("second letter moved", changes.second,
             "the same; it is brought to a pose of its own, where the grid sees it as before");
    moved_by("moved letter to itself", changes.to_itself, "the distance is 0");
    return figure;
}

}  // namespace morphodesic::pipeline
