#include <algorithm>
#include <cmath>

#include "reports/report.h"

namespace morphodesic::reports {
namespace {

class Checker {
public:
    explicit Checker(const ReportModel& model) : model_(model), n_(model.shapes.size()) {}

    std::vector<std::string> run() {
        const std::size_t pairs = n_ * (n_ - (n_ > 0)) / 2;
        length("distances", model_.distances.size(), pairs, false);
        length("errors", model_.errors.size(), pairs, true);
        length("refined", model_.refined.size(), pairs, true);
        for (const double d : model_.distances) {
            if (d < 0 || std::isinf(d)) {
                found_.push_back("distances: negative or infinite entry");
                break;
            }
        }
        for (const auto& tree : model_.linkages) check(tree);
        for (const auto& c : model_.clusterings) {
            assignment("clustering " + c.method, c.assignment, c.medoids.size());
            all_shapes("medoids of " + c.method, c.medoids);
        }
        for (const auto& e : model_.embeddings) {
            if (e.dimension != 2 && e.dimension != 3) found_.push_back(e.method + ": dimension must be 2 or 3");
            length(e.method + " coordinates", e.coordinates.size(), n_ * static_cast<std::size_t>(e.dimension), false);
            length(e.method + " stress_per_shape", e.stress_per_shape.size(), n_, true);
            length(e.method + " disparities", e.disparities.size(), pairs, true);
        }
        for (const auto& q : model_.placed) {
            if (q.nearest != -1) all_shapes("nearest shape of a placed query", {q.nearest});
            length("positions of a placed query", q.positions.size(), model_.embeddings.size(), false);
            length("stress of a placed query", q.stress.size(), model_.embeddings.size(), false);
            for (std::size_t m = 0; m < std::min(q.positions.size(), model_.embeddings.size()); ++m) {
                const auto dimension = static_cast<std::size_t>(model_.embeddings[m].dimension);
                length("position of a placed query", q.positions[m].size(), dimension, true);
            }
        }
        for (const auto& e : model_.spanning_tree) pair("spanning tree", e.a, e.b);
        for (const auto& e : model_.neighbour_graph) pair("neighbour graph", e.a, e.b);
        length("neighbours", model_.neighbours.size(), n_, true);
        for (const auto& list : model_.neighbours) all_shapes("neighbours", list);
        for (const auto& table : model_.classes) {
            length("confusion matrix", table.confusion.size(), table.classes.size(), true);
            for (const auto& row : table.confusion)
                length("confusion matrix row", row.size(), table.classes.size(), false);
            all_shapes("class medoids", table.class_medoids);
        }
        for (const auto& t : model_.trust.worst_triangles) all_shapes("triangles", {t.a, t.via, t.b});
        for (const auto& t : model_.trust.asymmetries) pair("asymmetries", t.a, t.b);
        for (const auto& t : model_.trust.not_converged) pair("pairs not converged", t.a, t.b);
        length("silhouettes", model_.trust.silhouettes.size(), n_, true);
        for (const auto& p : model_.paths) pair("path", p.a, p.b);
        if (model_.volumes) {
            check(model_.volumes->tree);
            assignment("clusters by volume", model_.volumes->assignment, 0);
        }
        return std::move(found_);
    }

private:
    void length(const std::string& what, std::size_t is, std::size_t should, bool may_be_empty) {
        if (is == should || (is == 0 && may_be_empty)) return;
        found_.push_back(what + ": " + std::to_string(is) + " entries instead of " + std::to_string(should));
    }
    void all_shapes(const std::string& what, const std::vector<int>& shapes) {
        for (const int s : shapes) {
            if (s >= 0 && static_cast<std::size_t>(s) < n_) continue;
            found_.push_back(what + ": there is no shape number " + std::to_string(s));
            return;
        }
    }
    void pair(const std::string& what, int a, int b) {
        all_shapes(what, {a, b});
        if (a == b) found_.push_back(what + ": a pair of shape " + std::to_string(a) + " with itself");
    }
    void assignment(const std::string& what, const std::vector<int>& clusters, std::size_t count) {
        length(what, clusters.size(), n_, false);
        for (const int c : clusters) {
            if (c >= 0 && (count == 0 || static_cast<std::size_t>(c) < count)) continue;
            found_.push_back(what + ": there is no cluster number " + std::to_string(c));
            return;
        }
    }
    void check(const LinkageTree& tree) {
        const std::string what = tree.method + " linkage";
        length(what, tree.merges.size(), n_ - (n_ > 0), false);
        length(what + " leaf_order", tree.leaf_order.size(), n_, false);
        all_shapes(what + " leaf_order", tree.leaf_order);
        std::vector<bool> seen(n_, false);
        for (const int leaf : tree.leaf_order) {
            if (leaf < 0 || static_cast<std::size_t>(leaf) >= n_) break;
            if (seen[static_cast<std::size_t>(leaf)]) {
                found_.push_back(what + " leaf_order: shape " + std::to_string(leaf) + " twice");
                break;
            }
            seen[static_cast<std::size_t>(leaf)] = true;
        }
        for (std::size_t row = 0; row < tree.merges.size(); ++row) {
            const auto& m = tree.merges[row];
            const int limit = static_cast<int>(n_ + row);
            if (m.first >= 0 && m.second >= 0 && m.first < limit && m.second < limit && m.first != m.second) continue;
            found_.push_back(what + ": row " + std::to_string(row) + " joins clusters that do not exist yet");
            return;
        }
    }

    const ReportModel& model_;
    std::size_t n_;
    std::vector<std::string> found_;
};

}  // namespace

std::vector<std::string> problems(const ReportModel& model) {
    return Checker(model).run();
}

}  // namespace morphodesic::reports
