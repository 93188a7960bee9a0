#include "analysis/leaf_order.h"

#include <algorithm>
#include <stdexcept>

#include "analysis/kernels.h"
#include "analysis/parallel.h"
#include "analysis/special_numbers.h"

namespace morphodesic::analysis {
namespace {

/// A cluster as a range of positions in tree order, with its two children.
struct Node {
    std::size_t begin = 0, end = 0;
    std::size_t left = 0, right = 0;  // numbers of the children; unused for leaves
};

std::vector<Node> ranges(const Dendrogram& tree, const std::vector<std::size_t>& order) {
    const std::size_t n = tree.leaf_count;
    std::vector<Node> nodes(n + tree.merges.size());
    for (std::size_t p = 0; p < n; ++p) nodes[order[p]] = {p, p + 1, 0, 0};
    for (std::size_t m = 0; m < tree.merges.size(); ++m) {
        const auto& merge = tree.merges[m];
        nodes[n + m] = {nodes[merge.first].begin, nodes[merge.second].end, merge.first, merge.second};
    }
    return nodes;
}

/// The dynamic programme. best(u, w): smallest length of an order of the cluster where u and w meet, with u and w at
/// its ends; every pair of positions meets in exactly one cluster, so one table holds them all.
class OrderProgramme {
public:
    OrderProgramme(const Dendrogram& tree, const DistanceMatrix& distances)
        : n_(tree.leaf_count),
          order_(tree_order(tree)),
          nodes_(ranges(tree, order_)),
          d_(n_ * n_),
          best_(n_ * n_, 0.0) {
        for (std::size_t p = 0; p < n_; ++p) {
            for (std::size_t q = 0; q < n_; ++q) d_[p * n_ + q] = distances(order_[p], order_[q]);
        }
        for (std::size_t c = n_; c < nodes_.size(); ++c) join(nodes_[c]);
    }

    [[nodiscard]] std::vector<std::size_t> solve() const {
        const Node& root = nodes_.back();
        const Node &left = nodes_[root.left], &right = nodes_[root.right];
        std::size_t u = left.begin, w = right.begin;
        for (std::size_t a = left.begin; a < left.end; ++a) {
            for (std::size_t b = right.begin; b < right.end; ++b) {
                if (best(a, b) < best(u, w)) {
                    u = a;
                    w = b;
                }
            }
        }
        std::vector<std::size_t> result;
        result.reserve(n_);
        struct Part {
            std::size_t cluster, first, last;
        };
        std::vector<Part> open{{nodes_.size() - 1, u, w}};
        while (!open.empty()) {
            const auto [cluster, first, last] = open.back();
            open.pop_back();
            if (cluster < n_) {
                result.push_back(cluster);
                continue;
            }
            std::size_t near = nodes_[cluster].left, far = nodes_[cluster].right;
            if (first >= nodes_[far].begin) std::swap(near, far);
            // The inner ends m, k of the two children.
            const auto [m_begin, m_end] = other_ends(near, first);
            const auto [k_begin, k_end] = other_ends(far, last);
            std::size_t m = m_begin, k = k_begin;
            double shortest = infinity;
            for (std::size_t a = m_begin; a < m_end; ++a) {
                for (std::size_t b = k_begin; b < k_end; ++b) {
                    const double length = best(first, a) + d_[a * n_ + b] + best(b, last);
                    if (length < shortest) {
                        shortest = length;
                        m = a;
                        k = b;
                    }
                }
            }
            open.push_back({far, k, last});
            open.push_back({near, first, m});
        }
        return result;
    }

private:
    [[nodiscard]] double best(std::size_t u, std::size_t w) const { return best_[u * n_ + w]; }

    /// Positions that can be the other end of a cluster with `end` at one end.
    [[nodiscard]] std::pair<std::size_t, std::size_t> other_ends(std::size_t cluster, std::size_t end) const {
        if (cluster < n_) return {end, end + 1};
        const Node &left = nodes_[nodes_[cluster].left], &right = nodes_[nodes_[cluster].right];
        return end < left.end ? std::pair(right.begin, right.end) : std::pair(left.begin, left.end);
    }

    void join(const Node& node) {
        const Node &left = nodes_[node.left], &right = nodes_[node.right];
        const std::size_t width = right.end - right.begin;
        const std::size_t work = (left.end - left.begin) * width * (node.end - node.begin);
        const auto row = [&](std::size_t u) {
            // reach[k] = min over m of best(u, m) + d(m, k): u is one end of the left child, k the first of the right.
            std::vector<double> reach(width, infinity), total(width, infinity);
            const auto [m_begin, m_end] = other_ends(node.left, u);
            for (std::size_t m = m_begin; m < m_end; ++m) {
                min_plus_update(width, best(u, m), &d_[m * n_ + right.begin], reach.data());
            }
            if (width == 1) {
                total = reach;
            } else {
                const Node &a = nodes_[nodes_[node.right].left], &b = nodes_[nodes_[node.right].right];
                for (std::size_t k = right.begin; k < right.end; ++k) {
                    const Node& across = k < a.end ? b : a;  // the last leaf lies in the other grandchild
                    min_plus_update(across.end - across.begin, reach[k - right.begin], &best_[k * n_ + across.begin],
                                    &total[across.begin - right.begin]);
                }
            }
            std::copy(total.begin(), total.end(), &best_[u * n_ + right.begin]);
        };
        if (work < 100'000) {
            for (std::size_t u = left.begin; u < left.end; ++u) row(u);
        } else {
            parallel_for_each_index(left.end - left.begin, 4, [&](std::size_t i) { row(left.begin + i); });
        }
        for (std::size_t u = left.begin; u < left.end; ++u) {
            for (std::size_t w = right.begin; w < right.end; ++w) best_[w * n_ + u] = best_[u * n_ + w];
        }
    }

    std::size_t n_;
    std::vector<std::size_t> order_;
    std::vector<Node> nodes_;
    std::vector<double> d_, best_;  // by position in tree order, [n x n]
};

/// Keeps the children as they are but turns each so that the two ends that meet are near: O(n) merges, four choices
/// each.
std::vector<std::size_t> greedy_order(const Dendrogram& tree, const DistanceMatrix& distances) {
    const std::size_t n = tree.leaf_count;
    std::vector<std::vector<std::size_t>> part(n + tree.merges.size());
    for (std::size_t i = 0; i < n; ++i) part[i] = {i};
    for (std::size_t m = 0; m < tree.merges.size(); ++m) {
        std::vector<std::size_t> a = std::move(part[tree.merges[m].first]), b = std::move(part[tree.merges[m].second]);
        const double meeting[] = {distances(a.back(), b.front()), distances(a.back(), b.back()),
                                  distances(a.front(), b.front()), distances(a.front(), b.back())};
        const auto best = std::min_element(std::begin(meeting), std::end(meeting)) - std::begin(meeting);
        if (best >= 2) std::reverse(a.begin(), a.end());
        if (best % 2 == 1) std::reverse(b.begin(), b.end());
        if (a.size() < b.size()) {  // append the shorter one, reversed as a whole: the same order from the other end
            std::reverse(a.begin(), a.end());
            std::reverse(b.begin(), b.end());
            std::swap(a, b);
        }
        a.insert(a.end(), b.begin(), b.end());
        part[n + m] = std::move(a);
    }
    return part.back();
}

}  // namespace

double order_length(std::span<const std::size_t> order, const DistanceMatrix& distances) {
    double length = 0.0;
    for (std::size_t p = 1; p < order.size(); ++p) length += distances(order[p - 1], order[p]);
    return length;
}

LeafOrder optimal_leaf_order(const Dendrogram& tree, const DistanceMatrix& distances, std::size_t limit) {
    if (tree.leaf_count != distances.size()) throw std::invalid_argument("the tree belongs to another matrix");
    if (distances.missing_count() > 0)
        throw std::invalid_argument("leaf order needs all distances; fill the gaps first");
    LeafOrder result;
    if (tree.leaf_count < 3) {
        result.order = tree_order(tree);
    } else if (tree.leaf_count <= limit) {
        result.order = OrderProgramme(tree, distances).solve();
    } else {
        result.order = greedy_order(tree, distances);
        result.optimal = false;
    }
    if (!result.order.empty() && distances.labels()[result.order.back()] < distances.labels()[result.order.front()]) {
        std::reverse(result.order.begin(), result.order.end());
    }
    result.length = order_length(result.order, distances);
    return result;
}

}  // namespace morphodesic::analysis
