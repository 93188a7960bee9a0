#include "datasets/nested_shells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <span>

#include "datasets/interruption.h"
#include "datasets/triangle_tree.h"

namespace morphodesic::datasets {
namespace {

/// Share of the area of all shells: the smaller ones hold less than the smallest cavity that is kept.
constexpr double least_share_of_area = 0.01;
constexpr int most_samples = 200;     // of a shell
constexpr double all_of_it = 0.95;    // of the samples: some lie near holes
constexpr double shut = 0.9;          // a ball without 20 % of its surface still is
constexpr double perhaps_shut = 0.6;  // more than a sheet, whose front and back have -1/2 and 1/2

/// A patch, or several small ones together.
struct Shell {
    std::vector<int> patches;
    std::vector<Vector3> samples;  ///< evenly spread, just in front of the surface
    Box3 box = Box3::empty();
    double area = 0.0;
    std::unique_ptr<TriangleTree> tree;
};

void build(Shell& shell, const TriangleMesh& mesh, std::span<const int> shell_of, int number) {
    TriangleMesh part;
    part.points = mesh.points;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (shell_of[t] == number) part.triangles.push_back(mesh.triangles[t]);
    }
    const double step = 1e-4 * bounding_box(mesh.points).diagonal();
    double walked = 0.0;
    std::size_t taken = 0;
    const auto wanted = std::min<std::size_t>(most_samples, part.triangles.size());
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
        const auto c = part.corners(t);
        const Vector3 n = area_vector(c);
        walked += 0.5 * norm(n);
        if (taken >= wanted || walked * wanted < shell.area * (taken + 0.5)) continue;
        while (taken < wanted && walked * wanted >= shell.area * (taken + 0.5)) ++taken;
        shell.samples.push_back((1.0 / 3.0) * (c[0] + c[1] + c[2]) + (step / norm(n)) * n);
    }
    shell.tree = std::make_unique<TriangleTree>(part);
}

/// Generalised winding numbers of a shell, as the file has it.
std::vector<double> winding_of(const Shell& shell, std::span<const Vector3> points) {
    std::vector<double> result(points.size());
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        interruption_point();
        result[i] = shell.tree->winding_number(points[i]);
    });
    return result;
}

template <class Holds>
bool holds_for_all(std::span<const double> values, Holds&& holds) {
    return static_cast<double>(std::count_if(values.begin(), values.end(), holds)) >=
           all_of_it * static_cast<double>(values.size());
}

/// Each large patch, the small ones that are hidden, the other small ones.
class Shells {
public:
    Shells(const TriangleMesh& mesh, const Patches& patch, PatchFate& fate) : mesh_(mesh), patch_(patch), fate_(fate) {
        const double total = surface_area(mesh);
        std::vector<double> area(patch.count, 0.0);
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
            area[patch.of_triangle[t]] += 0.5 * norm(area_vector(mesh.corners(t)));
        std::vector<int> shell_of_patch(patch.count);
        int small[2] = {-1, -1};
        for (int p = 0; p < patch.count; ++p) {
            const bool is_large = area[p] >= least_share_of_area * total;
            int& number = small[fate.hidden[p] != 0 ? 1 : 0];
            if (is_large || number < 0) {
                shells_.emplace_back();
                if (!is_large) number = static_cast<int>(shells_.size()) - 1;
            }
            shell_of_patch[p] = is_large ? static_cast<int>(shells_.size()) - 1 : number;
            shells_[shell_of_patch[p]].patches.push_back(p);
            shells_[shell_of_patch[p]].area += area[p];
        }
        scraps_ = small[0];
        shell_of_.resize(mesh.triangles.size());
        for (std::size_t t = 0; t < shell_of_.size(); ++t) {
            shell_of_[t] = shell_of_patch[patch.of_triangle[t]];
            shells_[shell_of_[t]].box.include(bounding_box(mesh.corners(t)));
        }
    }

    bool keep_cavities() {
        std::vector<int> order(shells_.size());
        std::iota(order.begin(), order.end(), 0);
        std::sort(order.begin(), order.end(),
                  [&](int a, int b) { return shells_[a].box.diagonal() > shells_[b].box.diagonal(); });
        bool is_filled = false;
        for (const int s : order) {
            if (s != scraps_ && may_lie_within_others(s)) is_filled |= judge(s);
        }
        return is_filled;
    }

private:
    [[nodiscard]] bool may_lie_within_others(int s) const {
        Box3 others = Box3::empty();
        for (int q = 0; q < static_cast<int>(shells_.size()); ++q) {
            if (q != s) others.include(shells_[q].box);
        }
        const Box3& box = shells_[s].box;
        for (int a = 0; a < 3; ++a) {
            if (!(box.low[a] > others.low[a] && box.high[a] < others.high[a])) return false;
        }
        return true;
    }

    Shell& built(int s) {
        Shell& shell = shells_[s];
        if (shell.tree == nullptr && s == scraps_) {  // they have no side of their own: as they will be turned
            TriangleMesh turned = mesh_;
            for (std::size_t t = 0; t < turned.triangles.size(); ++t) {
                if (fate_.turn[patch_.of_triangle[t]] != 0) std::swap(turned.triangles[t][1], turned.triangles[t][2]);
            }
            build(shell, turned, shell_of_, s);
        } else if (shell.tree == nullptr) {
            build(shell, mesh_, shell_of_, s);
        }
        return shell;
    }
    [[nodiscard]] bool is_turned(int s) const { return s != scraps_ && fate_.turn[shells_[s].patches.front()] != 0; }
    [[nodiscard]] bool is_left_out(int s) const { return fate_.hidden[shells_[s].patches.front()] != 0; }
    void settle(int s, bool turn) {
        for (const int p : shells_[s].patches) fate_.turn[p] = turn ? 1 : 0, fate_.hidden[p] = 0;
    }

    /// @return  whether the shell seems to be the wall of a cavity that is lost
    bool judge(int s) {
        const Shell& shell = built(s);
        const std::vector<double> own = winding_of(shell, shell.samples);
        const double in_front = std::accumulate(own.begin(), own.end(), 0.0) / static_cast<double>(own.size());
        const double closeness = 2.0 * std::abs(in_front + 0.5);
        if (closeness < 2.0 * perhaps_shut - 1.0) return false;
        const bool is_inward = in_front < -0.5;

        std::vector<double> around(shell.samples.size(), 0.0);
        bool is_around_turned = false;
        double smallest = -1.0;
        for (int q = 0; q < static_cast<int>(shells_.size()); ++q) {
            if (q == s || is_left_out(q)) continue;
            const std::vector<double> winding = winding_of(built(q), shell.samples);
            for (std::size_t i = 0; i < around.size(); ++i) around[i] += is_turned(q) ? -winding[i] : winding[i];
            const double size = shells_[q].box.diagonal();
            if ((smallest < 0.0 || size < smallest) &&
                holds_for_all(winding, [](double w) { return std::abs(w) > 0.5; })) {
                smallest = size;
                is_around_turned = is_turned(q);
            }
        }
        const bool is_shut = closeness >= 2.0 * shut - 1.0;
        const bool is_wall = is_inward != is_around_turned;
        if (holds_for_all(around, [](double w) { return w > 0.5; })) {
            if (is_wall && is_shut) settle(s, !is_inward);
            return is_wall && !is_shut;
        }
        // In a cavity it is not seen from outside either.
        if (is_shut && is_left_out(s) && holds_for_all(around, [](double w) { return w < 0.5; })) settle(s, is_inward);
        return false;
    }

    const TriangleMesh& mesh_;
    const Patches& patch_;
    PatchFate& fate_;
    std::vector<Shell> shells_;
    std::vector<int> shell_of_;  ///< [triangles]
    int scraps_ = -1;            ///< the small patches that are seen from outside
};

}  // namespace

bool keep_cavity_walls(const TriangleMesh& mesh, const Patches& patch, PatchFate& fate) {
    if (patch.count == 1) return false;
    return Shells(mesh, patch, fate).keep_cavities();
}

}  // namespace morphodesic::datasets
