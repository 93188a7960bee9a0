#include "geodesic/energy/stretched_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/kernels/heaviside_kernel.h"
#include "geodesic/kernels/sampled_mismatch.h"
#include "geodesic/kernels/vector_kernels.h"

namespace morphodesic {

namespace {
// Stretches from which on the difference counts, and from which on in whole: more points see further. With others, 1.2
// to 2 up to 2 to 4, paths end in the same energies in the mean (measured).
struct Onset {
    double from, to;
};
constexpr Onset onset_for(kernels::Quadrature rule) {
    return rule == kernels::Quadrature::few ? Onset{1.5, 2.5} : Onset{2.0, 3.0};
}
// Points of the dense quadrature for each length eps of the deformed cell, along each axis.
constexpr double points_per_eps = 1.0;
constexpr int least_points = 3, most_points = 24;
// The rule is good enough where variation of the integrand times its size is below this.
constexpr double least_variation = 1e-2;
// Beyond so many eps from all contours on one side H_eps leaves no such variation.
constexpr double far_away = 4.0;
// Cells that are stretched beyond any sense have infinite energies elsewhere.
constexpr double most_stretch = 1e3;

template <int Dim, class T>
class StretchedMismatch {
public:
    static constexpr int corners = 1 << Dim;
    using Cell = kernels::SampledCell<Dim, T>;

    StretchedMismatch(const DyadicGrid<Dim>& grid, const kernels::StepFields<Dim, T>& fields,
                      const kernels::StepWeights& weights, const kernels::StepGradients<Dim, T>& gradients)
        : grid_(grid),
          f_(fields),
          s_(weights),
          g_(gradients),
          onset_(onset_for(weights.quadrature)),
          with_gradient_(gradients.displacement[0] != nullptr),
          volume_(std::pow(grid.spacing(), Dim)),
          scale_(weights.mismatch * volume_),
          first_row_(static_cast<std::size_t>(fields.u_next_first_row) * grid.stride(Dim - 1)),
          corner_(q1::corner_offsets(grid)) {}

    double rows(int begin, int end) const {
        const auto stride = grid_.strides();
        double sum = 0.0;
        for_marked_cells(
            grid_, begin, end,
            [&](std::size_t row, unsigned char* flags) {
                const T* w[Dim];
                for (int a = 0; a < Dim; ++a) w[a] = f_.displacement[a] + row;
                return kernels::stretched_cells<Dim, T>(static_cast<std::size_t>(grid_.cells(0)), w, stride,
                                                        grid_.cells_per_unit(), onset_.from, flags);
            },
            [&](std::size_t cell) { sum += difference(cell, load(cell)); });
        return sum;
    }

private:
    Cell load(std::size_t node) const {
        Cell cell{};
        const auto low = grid_.node(node);
        cell.eps = s_.eps;
        cell.u_next = f_.u_next;
        cell.begin = first_row_;
        for (int a = 0; a < Dim; ++a) {
            cell.cells[a] = grid_.cells(a);
            cell.low[a] = low[static_cast<std::size_t>(a)];
            std::tie(cell.first[a], cell.last[a]) =
                a == Dim - 1 ? std::pair(f_.u_next_first_row, f_.u_next_last_row) : std::pair(0, grid_.cells(a));
        }
        for (int c = 0; c < corners; ++c) {
            const std::size_t at = node + corner_[static_cast<std::size_t>(c)];
            for (int a = 0; a < Dim; ++a)
                cell.w[a][c] = static_cast<double>(f_.displacement[a][at]) * grid_.cells_per_unit();
            cell.u[c] = static_cast<double>(f_.u_previous[at]);
            cell.chi[c] = f_.mask ? static_cast<double>(f_.mask[at]) : 1.0;
        }
        return cell;
    }

    /// A cell's longest edge after the step, in units of h, and the longest one along each axis; squares.
    struct Stretch {
        double longest = 0.0, along[Dim] = {};
        int axis = 0, corner = 0;  // the longest edge leaves this corner along this axis
        double edge[Dim] = {};     // as a vector
        bool sensible = true;
    };
    static Stretch stretch_of(const Cell& cell) {
        Stretch s;
        for (int axis = 0; axis < Dim; ++axis) {
            for (int c = 0; c < corners; ++c) {
                if ((c >> axis) & 1) continue;
                double edge[Dim], square = 0.0;
                for (int a = 0; a < Dim; ++a) {
                    edge[a] = (a == axis ? 1.0 : 0.0) + cell.w[a][c | (1 << axis)] - cell.w[a][c];
                    square += edge[a] * edge[a];
                }
                s.along[axis] = std::max(s.along[axis], square);
                s.sensible = s.sensible && square < most_stretch * most_stretch;  // no NaN
                if (!(square > s.longest)) continue;
                s.longest = square;
                s.axis = axis;
                s.corner = c;
                std::copy(edge, edge + Dim, s.edge);
            }
        }
        return s;
    }

    /// Least and largest value of u_k at the nodes around the deformed cell: between them it is in the cell.
    std::pair<double, double> range_there(const Cell& cell) const {
        typename DyadicGrid<Dim>::Index low{}, high{};
        for (int a = 0; a < Dim; ++a) {
            const auto at = static_cast<std::size_t>(a);
            double least = 1e300, most = -1e300;
            for (int c = 0; c < corners; ++c) {
                const double y = cell.low[a] + ((c >> a) & 1) + cell.w[a][c];
                least = std::min(least, y);
                most = std::max(most, y);
            }
            low[at] = static_cast<int>(std::clamp(std::floor(least), 1.0 * cell.first[a], 1.0 * cell.last[a]));
            high[at] = static_cast<int>(std::clamp(std::ceil(most), 1.0 * cell.first[a], 1.0 * cell.last[a]));
        }
        double least = 1e300, most = -1e300;
        for (auto i = low; i[Dim - 1] <= high[Dim - 1];) {
            const double u = static_cast<double>(f_.u_next[grid_.index(i)]);
            least = std::min(least, u);
            most = std::max(most, u);
            for (std::size_t a = 0; a < Dim && ++i[a] > high[a] && a + 1 < Dim; ++a) i[a] = low[a];
        }
        return {least, most};
    }

    /// Whether H_eps(u_k o phi) - H_eps(u_{k-1}) may vary in the cell by so much that it matters where points are.
    bool may_vary(const Cell& cell) const {
        const auto [least, most] = range_there(cell);
        const auto [least_here, most_here] = std::minmax_element(cell.u, cell.u + corners);
        const double far = far_away * s_.eps;
        if (std::min(least, *least_here) > far || std::max(most, *most_here) < -far) return false;
        const std::array<double, 4> u{least, most, *least_here, *most_here};
        std::array<double, 4> h;
        kernels::smooth_heaviside(u, s_.eps, h);
        return ((h[1] - h[0]) + (h[3] - h[2])) * std::max(h[1] - h[2], h[3] - h[0]) > least_variation;
    }

    /// Points of a cell and what they count. Kept, since cells are many.
    struct Samples {
        std::vector<double> x[Dim], factor;
    };

    /// Fills the samples of a cell: a dense grid of points, by its stretch along each axis, less those of the rule.
    void take_samples(const Stretch& stretch, double weight, Samples& samples) const {
        typename DyadicGrid<Dim>::Index count, i{};
        Point<Dim> width;
        std::size_t points = 1;
        const double eps_per_cell = grid_.spacing() / s_.eps;
        for (std::size_t a = 0; a < Dim; ++a) {
            const double wanted = std::ceil(points_per_eps * eps_per_cell * std::sqrt(stretch.along[a]));
            count[a] = std::clamp(static_cast<int>(wanted), least_points, most_points);
            points *= static_cast<std::size_t>(count[a]);
            width[a] = 1.0 / count[a];
        }
        const auto rule = kernels::quadrature_points<Dim>(s_.quadrature);
        constexpr std::size_t lanes = kernels::sample_lanes;
        const std::size_t total = (points + rule.size() + lanes - 1) / lanes * lanes;
        for (auto& x : samples.x) x.assign(total, 0.5);  // those that fill up the last lanes count nothing
        samples.factor.assign(total, 0.0);
        std::fill_n(samples.factor.begin(), points, weight / static_cast<double>(points));
        for (std::size_t p = 0; p < points; ++p) {
            for (std::size_t a = 0; a < Dim; ++a) samples.x[a][p] = (i[a] + 0.5) * width[a];
            for (std::size_t a = 0; a < Dim && ++i[a] == count[a]; ++a) i[a] = 0;
        }
        for (std::size_t q = 0; q < rule.size(); ++q) {
            for (std::size_t a = 0; a < Dim; ++a) samples.x[a][points + q] = rule[q][a];
            samples.factor[points + q] = -weight / static_cast<double>(rule.size());
        }
    }

    double difference(std::size_t node, const Cell& cell) const {
        const Stretch stretch = stretch_of(cell);
        const double from = onset_.from * onset_.from, to = onset_.to * onset_.to;
        const double t = std::clamp((stretch.longest - from) / (to - from), 0.0, 1.0);
        const double weight = t * t * (3.0 - 2.0 * t), weight_slope = 6.0 * t * (1.0 - t) / (to - from);
        if (!stretch.sensible || weight == 0.0 || !may_vary(cell)) return 0.0;

        static thread_local Samples samples;
        take_samples(stretch, weight, samples);
        kernels::SamplePoints<Dim> points{samples.factor.size(), {}, samples.factor.data()};
        for (std::size_t a = 0; a < Dim; ++a) points.x[a] = samples.x[a].data();
        auto sums = kernels::sampled_mismatch<Dim, T>(cell, points, with_gradient_, scale_, g_.u_next);
        if (!with_gradient_) return volume_ * sums.mismatch;
        for (int a = 0; a < Dim; ++a) {
            const double pull = sums.mismatch / weight * weight_slope * 2.0 * stretch.edge[a];
            sums.w[a][stretch.corner] -= pull;
            sums.w[a][stretch.corner | (1 << stretch.axis)] += pull;
        }
        for (int c = 0; c < corners; ++c) {
            const std::size_t at = node + corner_[static_cast<std::size_t>(c)];
            for (int a = 0; a < Dim; ++a) {
                g_.displacement[a][at] += static_cast<T>(scale_ * grid_.cells_per_unit() * sums.w[a][c]);
            }
            if (g_.u_previous) g_.u_previous[at] += static_cast<T>(scale_ * sums.u[c]);
        }
        return volume_ * sums.mismatch;
    }

    const DyadicGrid<Dim>& grid_;
    const kernels::StepFields<Dim, T>& f_;
    const kernels::StepWeights& s_;
    const kernels::StepGradients<Dim, T>& g_;
    Onset onset_;
    bool with_gradient_;
    double volume_, scale_;  // of a cell; that times eta
    std::size_t first_row_;  // node at which the rows of u_k at hand start
    std::array<std::size_t, corners> corner_;
};

}  // namespace

template <int Dim, class T>
double stretched_mismatch(const DyadicGrid<Dim>& grid, int row_begin, int row_end,
                          const kernels::StepFields<Dim, T>& fields, const kernels::StepWeights& weights,
                          const kernels::StepGradients<Dim, T>& gradients) {
    return StretchedMismatch<Dim, T>(grid, fields, weights, gradients).rows(row_begin, row_end);
}

#define MORPHODESIC_INSTANTIATE(Dim, T)                                                                              \
    template double stretched_mismatch<Dim, T>(const DyadicGrid<Dim>&, int, int, const kernels::StepFields<Dim, T>&, \
                                               const kernels::StepWeights&, const kernels::StepGradients<Dim, T>&);
MORPHODESIC_INSTANTIATE(2, double)
MORPHODESIC_INSTANTIATE(3, double)
MORPHODESIC_INSTANTIATE(2, float)
MORPHODESIC_INSTANTIATE(3, float)
#undef MORPHODESIC_INSTANTIATE

}  // namespace morphodesic
