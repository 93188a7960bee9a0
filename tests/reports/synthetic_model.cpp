#include "tests/reports/synthetic_model.h"

#include <cairo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

namespace morphodesic::tests {
namespace {

using namespace reports;

struct Blob {
    double radius = 0.3, depth = 0.2, lobes = 3, phase = 0;
    [[nodiscard]] std::array<double, 3> place() const {
        return {depth * 1.5, (lobes - 4.0) * 0.06 + phase * 0.08, radius * 1.2};
    }
};

Blob between(const Blob& a, const Blob& b, double t) {
    const auto mix = [t](double x, double y) { return (1 - t) * x + t * y; };
    return {mix(a.radius, b.radius), mix(a.depth, b.depth), mix(a.lobes, b.lobes), mix(a.phase, b.phase)};
}

std::string png_of(const Blob& b, int pixels, bool coloured) {
    return blob_png(pixels, b.radius, b.depth, b.lobes, b.phase, coloured);
}

std::size_t pair_index(std::size_t n, std::size_t i, std::size_t j) {
    if (i > j) std::swap(i, j);
    return n * i - i * (i + 1) / 2 + j - i - 1;
}

/// Average linkage in the plainest way; leaf order by visiting the nearer child first.
LinkageTree average_linkage(const std::vector<double>& condensed, std::size_t n, const std::string& method) {
    std::vector<std::vector<double>> d(n, std::vector<double>(n, 0.0));
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) d[i][j] = i == j ? 0.0 : condensed[pair_index(n, i, j)];
        for (std::size_t j = 0; j < n; ++j) d[i][j] = std::isnan(d[i][j]) ? 1.0 : d[i][j];
    }
    std::vector<int> id(n), size(n, 1);
    std::iota(id.begin(), id.end(), 0);
    std::vector<std::vector<int>> leaves(n);
    for (std::size_t i = 0; i < n; ++i) leaves[i] = {static_cast<int>(i)};
    std::vector<bool> alive(n, true);
    LinkageTree tree{method, {}, {}, 0.87};
    for (std::size_t row = 0; row + 1 < n; ++row) {
        std::size_t p = 0, q = 0;
        double best = 1e300;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 1; alive[i] && j < n; ++j) {
                if (alive[j] && d[i][j] < best) best = d[i][j], p = i, q = j;
            }
        }
        for (std::size_t k = 0; k < n; ++k) {
            d[p][k] = d[k][p] = (size[p] * d[p][k] + size[q] * d[q][k]) / (size[p] + size[q]);
        }
        size[p] += size[q];
        tree.merges.push_back({std::min(id[p], id[q]), std::max(id[p], id[q]), best, size[p]});
        leaves[p].insert(leaves[p].end(), leaves[q].begin(), leaves[q].end());
        id[p] = static_cast<int>(n + row);
        alive[q] = false;
        if (row + 2 == n) tree.leaf_order = leaves[p];
    }
    if (n == 1) tree.leaf_order = {0};
    return tree;
}

}  // namespace

std::string blob_png(int pixels, double radius, double depth, double lobes, double phase, bool coloured) {
    cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, pixels, pixels);
    cairo_t* cr = cairo_create(surface);
    cairo_scale(cr, pixels, pixels);
    for (int k = 0; k <= 180; ++k) {
        const double t = 2 * std::numbers::pi * k / 180;
        const double r = radius * (1 + depth * std::cos(lobes * t + phase) * std::sin(t / 2));
        cairo_line_to(cr, 0.5 + r * std::cos(t), 0.5 + r * std::sin(t));
    }
    cairo_close_path(cr);
    if (coloured) {
        cairo_pattern_t* paint = cairo_pattern_create_radial(0.5 + 0.2 * std::cos(phase), 0.4, 0.02, 0.5, 0.5, 0.5);
        cairo_pattern_add_color_stop_rgb(paint, 0, 0.85, 0.18, 0.12);
        cairo_pattern_add_color_stop_rgb(paint, 0.5, 0.95, 0.85, 0.3);
        cairo_pattern_add_color_stop_rgb(paint, 1, 0.16, 0.35, 0.75);
        cairo_set_source(cr, paint);
        cairo_pattern_destroy(paint);
    } else {
        cairo_set_source_rgb(cr, 0.29, 0.46, 0.68);
    }
    cairo_fill(cr);
    std::string bytes;
    cairo_surface_write_to_png_stream(
        surface,
        [](void* closure, const unsigned char* part, unsigned length) {
            static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(part), length);
            return CAIRO_STATUS_SUCCESS;
        },
        &bytes);
    cairo_destroy(cr);
    cairo_surface_destroy(surface);
    return bytes;
}

ReportModel synthetic_model(const SyntheticStudy& study) {
    std::mt19937 random(study.seed);
    const auto uniform = [&](double low, double high) { return low + (high - low) * (random() % 100000) / 100000.0; };
    const auto n = static_cast<std::size_t>(study.shapes);
    const std::array<const char*, 8> words = {"clover", "maple", "oak", "poplar", "ginkgo", "lime", "beech", "willow"};
    ReportModel m;
    m.study = "Leaves of " + std::to_string(study.classes) + " kinds";
    m.created = "2026-11-22T23:00:00Z";
    m.dimension = study.dimension;
    m.collection = "leaves";
    m.study_folder = "leaves.study";
    m.geodesic_options = {"--preset", "fast"};
    m.shapes_found = study.shapes + 1;
    m.pairs_total = m.pairs_done = static_cast<long>(n * (n - 1) / 2);
    m.seconds = 83.2;
    m.cpu_seconds = 161.9;
    m.preset = "fast";
    m.distance_unit = "length of the unit cube";
    m.failures = {
        {"empty.png", "", "the picture is one uniform colour: there is no object; draw one or remove the file"}};
    std::vector<Blob> blobs(n);
    for (std::size_t i = 0; i < n; ++i) {
        const int c = static_cast<int>(i) % study.classes;
        blobs[i] = {uniform(0.24, 0.38), 0.15 + 0.08 * (c % 4) + uniform(-0.06, 0.06), 3.0 + c % 8, uniform(-0.4, 0.4)};
        ReportShape s;
        s.name = std::string(words[static_cast<std::size_t>(c) % 8]) + "/" + words[static_cast<std::size_t>(c) % 8] +
                 "-" + std::to_string(i / static_cast<std::size_t>(study.classes) + 1) + ".png";
        s.label = study.labelled
                      ? words[static_cast<std::size_t>(c) % 8] + (c >= 8 ? std::to_string(c / 8) : std::string())
                      : "";
        s.volume = 3.14 * blobs[i].radius * blobs[i].radius;
        s.thumbnail = {png_of(blobs[i], 64, false), 64, 64, ""};
        if (i == 0) s.notes = {"Two small specks beside the object were dropped."};
        m.shapes.push_back(s);
    }
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            const auto p = blobs[i].place(), q = blobs[j].place();
            m.distances.push_back(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) + uniform(0.01, 0.03));
            m.errors.push_back(0.01 * m.distances.back() + 0.0007);
        }
    }
    m.linkages = {average_linkage(m.distances, n, "average")};
    Clustering cut{"average linkage", "best silhouette", std::vector<int>(n), {}, 0.61};
    for (std::size_t i = 0; i < n; ++i) cut.assignment[i] = static_cast<int>(i) % study.classes;
    for (int c = 0; c < study.classes; ++c) cut.medoids.push_back(c);
    Clustering medoids{"k-medoids", std::to_string(study.classes) + " clusters", cut.assignment, cut.medoids, 0.57,
                       0.83};
    if (n > 1) medoids.assignment[n - 1] = 0;
    cut.agreement = 1.0;
    m.clusterings = {cut, medoids};
    for (const int dimension : {2, 3}) {
        Embedding e{dimension == 2 ? "SMACOF" : "classical MDS",          dimension, {}, 0.08,
                    std::vector<double>(n, 1.0 / static_cast<double>(n)), {}};
        for (const auto& b : blobs) {
            for (int a = 0; a < dimension; ++a)
                e.coordinates.push_back(b.place()[static_cast<std::size_t>(a)] + uniform(-0.004, 0.004));
        }
        m.embeddings.push_back(e);
    }
    for (int q = 0; q < study.queries; ++q) {
        PlacedQuery query{"query-" + std::to_string(q + 1) + ".png", q, 0.05, {}, {0.1, 0.08}};
        for (const Embedding& e : m.embeddings) {
            const auto first = e.coordinates.begin() + static_cast<std::ptrdiff_t>(q) * e.dimension;
            query.positions.emplace_back(first, first + e.dimension);
        }
        m.placed.push_back(query);
    }
    std::vector<std::size_t> nearest(n, 0);
    std::vector<bool> joined(n, false);
    joined[0] = true;
    for (std::size_t step = 1; step < n; ++step) {  // Prim
        double best = 1e300;
        std::size_t from = 0, to = 0;
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; joined[i] && j < n; ++j) {
                if (!joined[j] && m.distances[pair_index(n, i, j)] < best)
                    best = m.distances[pair_index(n, i, j)], from = i, to = j;
            }
        }
        joined[to] = true;
        m.spanning_tree.push_back({static_cast<int>(from), static_cast<int>(to), best});
    }
    m.neighbour_graph = m.spanning_tree;
    m.graph_neighbours = 1;
    if (study.labelled) {
        ClassTable t;
        t.nearest_neighbour = 0.96;
        t.k_nearest = {{3, 0.94}, {5, 0.93}};
        t.bulls_eye = 0.91;
        t.bulls_eye_window = 20;
        t.mean_average_precision = 0.88;
        for (int k = 0; k <= 10; ++k) t.precision_recall.push_back({0.1 * k, 1 - 0.05 * k * k / 10.0});
        const auto k = static_cast<std::size_t>(study.classes);
        for (std::size_t c = 0; c < k; ++c) t.classes.push_back(m.shapes[c].label);
        t.confusion.assign(k, std::vector<int>(k, 0));
        for (std::size_t c = 0; c < k; ++c) t.confusion[c][c] = 4;
        if (k > 1) t.confusion[1][0] = 1;
        for (std::size_t c = 0; c < k; ++c) t.class_medoids.push_back(static_cast<int>(c));
        t.adjusted_rand = 0.9;
        t.adjusted_mutual_information = 0.88;
        t.permanova_f = 31.2;
        t.permanova_p = 0.001;
        t.permanova_r2 = 0.71;
        t.permutations = 999;
        m.classes = {t};
    }
    m.trust.triangles_checked = static_cast<long>(n * (n - 1) * (n - 2) / 6);
    m.trust.triangles_violated = 2;
    if (n > 2) m.trust.worst_triangles = {{0, 1, 2, 0.004, 0.006}};
    m.trust.median_asymmetry = 0.004;
    m.trust.max_asymmetry = 0.021;
    if (n > 1) m.trust.asymmetries = {{0, 1, 0.3385, 0.3382}};
    for (std::size_t i = 0; i < n; ++i) m.trust.silhouettes.push_back(uniform(-0.1, 0.9));
    for (int c = 0; c < study.classes; ++c) m.trust.stability.push_back({c, uniform(0.8, 1)});
    m.trust.stability_rand = 0.97;
    m.trust.perturbations = 100;
    m.trust.seed = 7;
    if (n > 2) m.trust.not_converged = {{0, 2, "iteration limit reached on level 6"}};
    m.trust.close_clusters = {{0, study.classes - 1, 0.012, 0.019}};
    std::vector<std::size_t> order(m.distances.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](auto x, auto y) { return m.distances[x] < m.distances[y]; });
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i < study.shapes; ++i) {
        for (int j = i + 1; j < study.shapes; ++j) pairs.emplace_back(i, j);
    }
    for (std::size_t k = 0; k < std::min<std::size_t>(order.size(), static_cast<std::size_t>(study.paths)); ++k) {
        const std::size_t p = k == 0 ? 0 : order[k];  // the first pair always has its path
        if (k > 0 && p == 0) continue;
        PathReport path;
        path.a = pairs[p].first;
        path.b = pairs[p].second;
        path.path_length = m.distances[p];
        path.error = m.errors[p];
        path.extrapolated_length = 1.004 * m.distances[p];
        path.path_energy = 1.02 * m.distances[p] * m.distances[p];
        path.total_energy = 1.3 * path.path_energy;
        path.min_det = 0.42;
        path.termination = "converged";
        path.level = 6;
        path.time_steps = study.frames - 1;
        path.seconds = 0.71;
        path.motion = "turned by 3.1 degrees, moved by (0.012, -0.004)";
        path.colour_bar = {"dissipation rate density", "1/time²", 0.0, 3.2, {"#2a5ac0", "#f2d94c", "#d92e1f"}};
        for (int f = 0; f < study.frames; ++f) {
            const double t = static_cast<double>(f) / (study.frames - 1);
            const Blob b = between(blobs[static_cast<std::size_t>(path.a)], blobs[static_cast<std::size_t>(path.b)], t);
            path.frames.push_back({t,
                                   {png_of(b, study.frame_size, true), study.frame_size, study.frame_size, ""},
                                   f == 0 ? unknown : 0.001 + 0.0001 * f,
                                   f == 0 ? unknown : 0.00004});
        }
        m.paths.push_back(path);
    }
    VolumeComparison v;
    std::vector<double> by_volume;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) by_volume.push_back(std::abs(m.shapes[i].volume - m.shapes[j].volume));
    }
    v.tree = average_linkage(by_volume, n, "average");
    for (std::size_t i = 0; i < n; ++i) v.assignment.push_back(static_cast<int>(i * 3 / n));
    v.rank_correlation = 0.31;
    v.adjusted_rand = 0.12;
    m.volumes = v;
    m.volume_spread = 0.4;
    Comparison c;
    c.other = "leaves-coarse.study";
    c.common_shapes = study.shapes;
    c.common_pairs = static_cast<int>(m.distances.size());
    c.spearman = 0.98, c.kendall = 0.91, c.pearson = 0.985, c.neighbours = 5, c.mean_overlap = 0.9;
    for (std::size_t k = 0; k < std::min<std::size_t>(m.distances.size(), 2000); ++k)
        c.distances.emplace_back(m.distances[k], m.distances[k] * uniform(0.93, 1.04));
    if (n > 2) c.moved = {{m.shapes[0].name, m.shapes[1].name, m.shapes[2].name, 0.8}};
    c.different_settings = {{"level", "6 | 5", "grid level L"}};
    m.compare = c;
    m.settings = {{"level", "6", "grid level L: 2^L + 1 nodes per axis"},
                  {"steps", "4", "number K of time steps"},
                  {"align", "rigid", "motion removed before the solve"}};
    m.versions = {{"morphodesic", "0.1.0", ""}, {"compiler", "GCC 12.2", ""}};
    m.command = "morphodesic run leaves --preset fast --out leaves.study";
    m.links = {{"distances.csv", "distances.csv", "square matrix with names"},
               {"pairs.csv", "pairs.csv", "one row per pair"}};
    return m;
}

}  // namespace morphodesic::tests
