#include "analysis/linkage.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "analysis/special_numbers.h"
#include "analysis/statistics.h"

namespace morphodesic::analysis {
namespace {

/// Distance of cluster i to the union of x and y (Lance and Williams).
double joined_distance(LinkageMethod method, double xi, double yi, double xy, double nx, double ny, double ni) {
    switch (method) {
        case LinkageMethod::single:
            return std::min(xi, yi);
        case LinkageMethod::complete:
            return std::max(xi, yi);
        case LinkageMethod::average:
            return (nx * xi + ny * yi) / (nx + ny);
        case LinkageMethod::ward:
            break;
    }
    const double t = 1.0 / (nx + ny + ni);
    return std::sqrt(std::max(0.0, (ni + nx) * t * xi * xi + (ni + ny) * t * yi * yi - ni * t * xy * xy));
}

/// Numbers arbitrary cluster names 0, 1, ... by first appearance.
Clustering renumber(const std::vector<std::size_t>& names, std::size_t name_count) {
    std::vector<std::size_t> number(name_count, name_count);
    Clustering clusters(names.size());
    std::size_t next = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (number[names[i]] == name_count) number[names[i]] = next++;
        clusters[i] = number[names[i]];
    }
    return clusters;
}

/// The clusters that are left when only the first `kept` merges are made.
Clustering cut_after(const Dendrogram& tree, std::size_t kept) {
    const std::size_t n = tree.leaf_count;
    std::vector<std::size_t> parent(n + kept);
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    for (std::size_t m = 0; m < kept; ++m) parent[tree.merges[m].first] = parent[tree.merges[m].second] = n + m;
    for (std::size_t c = n + kept; c-- > 0;) parent[c] = parent[parent[c]];  // parents come later: roots spread down
    return renumber({parent.begin(), parent.begin() + static_cast<std::ptrdiff_t>(n)}, n + kept);
}

}  // namespace

const char* to_string(LinkageMethod method) {
    switch (method) {
        case LinkageMethod::single:
            return "single";
        case LinkageMethod::complete:
            return "complete";
        case LinkageMethod::average:
            return "average";
        case LinkageMethod::ward:
            return "ward";
    }
    return "?";
}

LinkageMethod parse_linkage_method(std::string_view name) {
    for (const auto method :
         {LinkageMethod::single, LinkageMethod::complete, LinkageMethod::average, LinkageMethod::ward}) {
        if (name == to_string(method)) return method;
    }
    throw std::invalid_argument("linkage '" + std::string(name) + "' is none of single, complete, average, ward");
}

Dendrogram linkage(const DistanceMatrix& distances, LinkageMethod method) {
    return linkage(distances.condensed(), distances.size(), method);
}

Dendrogram linkage(std::span<const double> condensed, std::size_t n, LinkageMethod method) {
    if (condensed.size() != (n < 2 ? 0 : n * (n - 1) / 2))
        throw std::invalid_argument("linkage: wrong number of distances");
    if (std::any_of(condensed.begin(), condensed.end(), [](double d) { return std::isnan(d); })) {
        throw std::invalid_argument("linkage needs all distances; fill the gaps first");
    }
    Dendrogram tree{n, {}};
    if (n < 2) return tree;
    // Full rows: the search for the nearest neighbour runs over contiguous memory. Dead clusters are at infinity.
    std::vector<double> d(n * n, infinity);
    for (std::size_t i = 0, pair = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j, ++pair) d[i * n + j] = d[j * n + i] = condensed[pair];
    }
    std::vector<std::size_t> size(n, 1), chain;
    chain.reserve(n);
    struct RawMerge {
        std::size_t x, y;
        double height;
    };
    std::vector<RawMerge> raw;
    raw.reserve(n - 1);
    std::size_t start = 0;
    while (raw.size() + 1 < n) {
        // Rounding can merge a cluster away that waits further down the chain; then the chain begins anew.
        if (!chain.empty() && size[chain.back()] == 0) chain.clear();
        if (chain.empty()) {
            while (size[start] == 0) ++start;
            chain.push_back(start);
        }
        std::size_t x = 0, y = 0;
        double nearest = 0.0;
        for (;;) {
            x = chain.back();
            // Among equally near ones the predecessor wins, or the chain could run in circles.
            y = chain.size() > 1 ? chain[chain.size() - 2] : n;
            nearest = y < n ? d[x * n + y] : infinity;
            const double* const row = &d[x * n];
            for (std::size_t i = 0; i < n; ++i) {
                if (row[i] < nearest) {
                    nearest = row[i];
                    y = i;
                }
            }
            if (chain.size() > 1 && y == chain[chain.size() - 2]) break;
            chain.push_back(y);
        }
        chain.resize(chain.size() - 2);
        if (x > y) std::swap(x, y);
        raw.push_back({x, y, nearest});
        const auto nx = static_cast<double>(size[x]), ny = static_cast<double>(size[y]);
        for (std::size_t i = 0; i < n; ++i) {  // the union lives on as y
            if (size[i] == 0 || i == x || i == y) continue;
            const double joined =
                joined_distance(method, d[x * n + i], d[y * n + i], nearest, nx, ny, static_cast<double>(size[i]));
            d[y * n + i] = d[i * n + y] = joined;
            d[i * n + x] = infinity;
        }
        d[y * n + x] = infinity;
        size[y] += size[x];
        size[x] = 0;
    }
    // The chain finds merges out of order; sorted by height they are the ones of the greedy algorithm.
    std::stable_sort(raw.begin(), raw.end(), [](const RawMerge& a, const RawMerge& b) { return a.height < b.height; });
    std::vector<std::size_t> parent(2 * n - 1);
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    const auto root = [&](std::size_t c) {
        while (parent[c] != c) c = parent[c] = parent[parent[c]];
        return c;
    };
    std::vector<std::size_t> leaves(2 * n - 1, 1);
    tree.merges.reserve(n - 1);
    for (const RawMerge& merge : raw) {
        const std::size_t a = root(merge.x), b = root(merge.y), made = n + tree.merges.size();
        parent[a] = parent[b] = made;
        leaves[made] = leaves[a] + leaves[b];
        tree.merges.push_back({std::min(a, b), std::max(a, b), merge.height, leaves[made]});
    }
    return tree;
}

std::vector<std::size_t> tree_order(const Dendrogram& tree) {
    const std::size_t n = tree.leaf_count;
    if (tree.merges.empty()) {
        std::vector<std::size_t> order(n);
        std::iota(order.begin(), order.end(), std::size_t{0});
        return order;
    }
    std::vector<std::size_t> order, open{n + tree.merges.size() - 1};
    order.reserve(n);
    while (!open.empty()) {
        const std::size_t c = open.back();
        open.pop_back();
        if (c < n) {
            order.push_back(c);
        } else {
            open.push_back(tree.merges[c - n].second);
            open.push_back(tree.merges[c - n].first);
        }
    }
    return order;
}

std::vector<double> cophenetic_distances(const Dendrogram& tree) {
    const std::size_t n = tree.leaf_count;
    std::vector<double> result(n < 2 ? 0 : n * (n - 1) / 2);
    const std::vector<std::size_t> order = tree_order(tree);
    std::vector<std::size_t> begin(n + tree.merges.size()), count(n + tree.merges.size(), 1);
    for (std::size_t p = 0; p < n; ++p) begin[order[p]] = p;
    for (std::size_t m = 0; m < tree.merges.size(); ++m) {
        const auto [a, b, height, size] = tree.merges[m];
        for (std::size_t p = 0; p < count[a]; ++p) {
            for (std::size_t q = 0; q < count[b]; ++q) {
                result[DistanceMatrix::condensed_index(n, order[begin[a] + p], order[begin[b] + q])] = height;
            }
        }
        begin[n + m] = begin[a];
        count[n + m] = size;
    }
    return result;
}

double cophenetic_correlation(const Dendrogram& tree, const DistanceMatrix& distances) {
    if (tree.leaf_count != distances.size()) throw std::invalid_argument("the tree belongs to another matrix");
    return pearson_correlation(cophenetic_distances(tree), distances.condensed());
}

std::size_t cluster_count(const Clustering& clusters) {
    return clusters.empty() ? 0 : 1 + *std::max_element(clusters.begin(), clusters.end());
}

Clustering cut_by_count(const Dendrogram& tree, std::size_t count) {
    if (tree.leaf_count == 0) return {};
    if (count < 1 || count > tree.leaf_count) {
        throw std::invalid_argument("cannot cut " + std::to_string(tree.leaf_count) + " items into " +
                                    std::to_string(count) + " clusters");
    }
    return cut_after(tree, tree.leaf_count - count);
}

Clustering cut_by_height(const Dendrogram& tree, double height) {
    const auto above = std::upper_bound(tree.merges.begin(), tree.merges.end(), height,
                                        [](double h, const Merge& m) { return h < m.height; });
    return cut_after(tree, static_cast<std::size_t>(above - tree.merges.begin()));
}

SilhouetteCut cut_by_silhouette(const Dendrogram& tree, const DistanceMatrix& distances, std::size_t max_clusters) {
    SilhouetteCut result;
    result.clusters.assign(tree.leaf_count, 0);
    if (tree.leaf_count < 3) return result;
    double best = 0.0;  // that of a single cluster
    for (std::size_t count = 2; count <= std::min(max_clusters, tree.leaf_count - 1); ++count) {
        if (!(tree.merges[tree.leaf_count - count].height > 0.0)) break;  // it would part items at distance 0
        Clustering clusters = cut_by_count(tree, count);
        const double width = mean(silhouette_widths(distances, clusters));
        result.mean_silhouette.push_back(width);
        if (width > best) {
            best = width;
            result.clusters = std::move(clusters);
        }
    }
    return result;
}

}  // namespace morphodesic::analysis
