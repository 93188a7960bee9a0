#include "geodesic/energy/stretched_cells.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "geodesic/energy/heaviside.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/kernels/vector_kernels.h"

namespace morphodesic {

namespace {
// Stretches from which on the difference counts, and from which on in whole. Later onsets, 2 to 3 or 4, and earlier
// ones, 1.2 to 2, end in the same energies (measured).
constexpr double stretch_onset = 1.5, stretch_full = 2.5;
// Points of the dense quadrature for each length h of the deformed cell, along each axis.
constexpr double points_per_length = 2.0;
constexpr int least_points = 3, most_points = 24;
// The rule is good enough where variation of the integrand times its size is below this.
constexpr double least_variation = 1e-2;
// Beyond so many eps from all contours on one side H_eps leaves no such variation.
constexpr double far_away = 4.0;
// Cells that are stretched beyond any sense have infinite energies elsewhere.
constexpr double most_stretch = 1e3;

/// One cell of a time step: corner values, w in units of h.
template <int Dim>
struct Cell {
    static constexpr int corners = 1 << Dim;
    std::size_t node;  // its first one
    int low[Dim];
    double w[Dim][corners], u[corners], chi[corners];
};

template <int Dim, class T>
class StretchedMismatch {
public:
    static constexpr int corners = 1 << Dim;

    StretchedMismatch(const kernels::StepFields<Dim, T>& fields, const kernels::StepWeights& weights,
                      const kernels::StepGradients<Dim, T>& gradients)
        : f_(fields), s_(weights), g_(gradients), per_unit_(std::ldexp(1.0, weights.level)) {
        std::ptrdiff_t distance = 1;
        for (int a = 0; a < Dim; ++a) {
            stride_[a] = distance;
            distance *= f_.cells[a] + 1;
        }
        for (int c = 0; c < corners; ++c) {
            corner_[c] = 0;
            for (int a = 0; a < Dim; ++a) corner_[c] += static_cast<std::size_t>(((c >> a) & 1) * stride_[a]);
        }
        if (g_.displacement[0] && g_.u_next) {
            next_gradient_ = g_.u_next - f_.u_next_first_row * stride_[Dim - 1];
        }
    }

    double rows(int begin, int end) {
        static thread_local std::vector<unsigned char> flag;
        flag.resize(static_cast<std::size_t>(f_.cells[0]));
        double sum = 0.0;
        const int middle_rows = Dim == 3 ? f_.cells[1] : 1;
        for (int row = begin; row < end; ++row) {
            for (int middle = 0; middle < middle_rows; ++middle) {
                const std::ptrdiff_t first = row * stride_[Dim - 1] + (Dim == 3 ? middle * stride_[1] : 0);
                const T* w[Dim];
                for (int a = 0; a < Dim; ++a) w[a] = f_.displacement[a] + first;
                if (!kernels::stretched_cells<Dim, T>(flag.size(), w, stride_, per_unit_, stretch_onset, flag.data()))
                    continue;
                for (int i = 0; i < f_.cells[0]; ++i) {
                    if (!flag[static_cast<std::size_t>(i)]) continue;
                    Cell<Dim> cell = load(static_cast<std::size_t>(first + i));
                    cell.low[0] = i;
                    if constexpr (Dim == 3) cell.low[1] = middle;
                    cell.low[Dim - 1] = row;
                    sum += difference(cell);
                }
            }
        }
        return sum;
    }

private:
    Cell<Dim> load(std::size_t node) const {
        Cell<Dim> cell{};
        cell.node = node;
        for (int c = 0; c < corners; ++c) {
            const std::size_t at = node + corner_[c];
            for (int a = 0; a < Dim; ++a) cell.w[a][c] = static_cast<double>(f_.displacement[a][at]) * per_unit_;
            cell.u[c] = static_cast<double>(f_.u_previous[at]);
            cell.chi[c] = f_.mask ? static_cast<double>(f_.mask[at]) : 1.0;
        }
        return cell;
    }

    /// An edge of a cell after the step, in units of h.
    struct Edge {
        int axis, corner;
        double square, vector[Dim];
    };
    static Edge edge(const Cell<Dim>& cell, int axis, int corner) {
        Edge e{axis, corner, 0.0, {}};
        for (int a = 0; a < Dim; ++a) {
            e.vector[a] = (a == axis ? 1.0 : 0.0) + cell.w[a][corner | (1 << axis)] - cell.w[a][corner];
            e.square += e.vector[a] * e.vector[a];
        }
        return e;
    }

    /// Whether H_eps(u_k o phi) or H_eps(u_{k-1}) may vary in the cell by so much that points matter.
    bool may_vary(const Cell<Dim>& cell) const {
        int low[Dim], high[Dim];
        for (int a = 0; a < Dim; ++a) {
            double least = 1e300, most = -1e300;
            for (int c = 0; c < corners; ++c) {
                const double at = cell.low[a] + ((c >> a) & 1) + cell.w[a][c];
                least = std::min(least, at);
                most = std::max(most, at);
            }
            low[a] = static_cast<int>(std::clamp(std::floor(least), 0.0, 1.0 * f_.cells[a]));
            high[a] = static_cast<int>(std::clamp(std::ceil(most), 0.0, 1.0 * f_.cells[a]));
        }
        low[Dim - 1] = std::max(low[Dim - 1], f_.u_next_first_row);
        high[Dim - 1] = std::min(high[Dim - 1], f_.u_next_last_row);
        double least = 1e300, most = -1e300;
        const int low_row = Dim == 3 ? low[1] : 0, high_row = Dim == 3 ? high[1] : 0;
        for (int z = low[Dim - 1]; z <= high[Dim - 1]; ++z) {
            for (int y = low_row; y <= high_row; ++y) {
                const T* u = f_.u_next + z * stride_[Dim - 1] + (Dim == 3 ? y * stride_[1] : 0);
                for (int x = low[0]; x <= high[0]; ++x) {
                    least = std::min(least, static_cast<double>(u[x]));
                    most = std::max(most, static_cast<double>(u[x]));
                }
            }
        }
        const auto [least_here, most_here] = std::minmax_element(cell.u, cell.u + corners);
        const double far = far_away * s_.eps;
        if (std::min(least, *least_here) > far || std::max(most, *most_here) < -far) return false;
        const auto h = [&](double u) { return smooth_heaviside(u, s_.eps); };
        const double a = h(least), b = h(most), c = h(*least_here), d = h(*most_here);
        return ((b - a) + (d - c)) * std::max(b - c, d - a) > least_variation;
    }

    struct Gradient {
        double w[Dim][corners] = {}, u[corners] = {};
    };

    /// Adds factor chi d^2 at a point of the cell to the sum, d = H_eps(u_k o phi) - H_eps(u_{k-1}), and its gradients.
    double at_point(const Cell<Dim>& cell, const Point<Dim>& x, double factor, Gradient& gradient) const {
        double shape[corners], u = 0.0, chi = 0.0;
        Point<Dim> y;
        for (int a = 0; a < Dim; ++a) y[static_cast<std::size_t>(a)] = cell.low[a] + x[static_cast<std::size_t>(a)];
        for (int c = 0; c < corners; ++c) {
            shape[c] = q1::shape<Dim>(c, x);
            u += shape[c] * cell.u[c];
            chi += shape[c] * cell.chi[c];
            for (int a = 0; a < Dim; ++a) y[static_cast<std::size_t>(a)] += shape[c] * cell.w[a][c];
        }
        std::ptrdiff_t node = 0;
        for (int a = 0; a < Dim; ++a) {
            auto& at = y[static_cast<std::size_t>(a)];
            const int first = a == Dim - 1 ? f_.u_next_first_row : 0;
            const int last = a == Dim - 1 ? f_.u_next_last_row : f_.cells[a];
            at = std::clamp(at, 1.0 * first, 1.0 * last);
            const int low = std::min(static_cast<int>(at), last - 1);
            at -= low;
            node += low * stride_[a];
        }
        double there = 0.0, slope[Dim] = {}, share[corners];
        for (int c = 0; c < corners; ++c) {
            const double v = static_cast<double>(f_.u_next[node + static_cast<std::ptrdiff_t>(corner_[c])]);
            share[c] = q1::shape<Dim>(c, y);
            there += share[c] * v;
            for (int a = 0; a < Dim; ++a) slope[a] += q1::shape_slope<Dim>(c, y, a) * v;
        }
        const double d = smooth_heaviside(there, s_.eps) - smooth_heaviside(u, s_.eps);
        if (g_.displacement[0]) {
            const double force = 2.0 * factor * chi * d * smooth_delta(there, s_.eps);
            const double back = 2.0 * factor * chi * d * smooth_delta(u, s_.eps);
            for (int c = 0; c < corners; ++c) {
                for (int a = 0; a < Dim; ++a) gradient.w[a][c] += force * slope[a] * shape[c];
                gradient.u[c] -= back * shape[c];
                if (next_gradient_) {
                    next_gradient_[node + static_cast<std::ptrdiff_t>(corner_[c])] +=
                        static_cast<T>(scale_ * force * share[c]);
                }
            }
        }
        return factor * chi * d * d;
    }

    double difference(const Cell<Dim>& cell) {
        Edge longest{};
        double stretch[Dim] = {};
        for (int axis = 0; axis < Dim; ++axis) {
            for (int c = 0; c < corners; ++c) {
                if ((c >> axis) & 1) continue;
                const Edge e = edge(cell, axis, c);
                stretch[axis] = std::max(stretch[axis], e.square);
                if (e.square > longest.square) longest = e;
            }
        }
        const double from = stretch_onset * stretch_onset, to = stretch_full * stretch_full;
        const double t = std::clamp((longest.square - from) / (to - from), 0.0, 1.0);
        const double weight = t * t * (3.0 - 2.0 * t), weight_slope = 6.0 * t * (1.0 - t) / (to - from);
        if (!(longest.square < most_stretch * most_stretch) || weight == 0.0 || !may_vary(cell)) return 0.0;

        double volume = 1.0;
        for (int a = 0; a < Dim; ++a) volume /= per_unit_;
        scale_ = s_.mismatch * volume;
        Gradient gradient;
        double sum = 0.0;
        int count[Dim], total = 1;
        for (int a = 0; a < Dim; ++a) {
            count[a] = std::clamp(static_cast<int>(std::ceil(points_per_length * std::sqrt(stretch[a]))), least_points,
                                  most_points);
            total *= count[a];
        }
        for (int p = 0; p < total; ++p) {
            Point<Dim> x;
            for (int a = 0, rest = p; a < Dim; ++a) {
                x[static_cast<std::size_t>(a)] = (rest % count[a] + 0.5) / count[a];
                rest /= count[a];
            }
            sum += at_point(cell, x, weight / total, gradient);
        }
        const auto rule = kernels::quadrature_points<Dim>(s_.quadrature);
        for (const auto& x : rule) sum += at_point(cell, x, -weight / static_cast<double>(rule.size()), gradient);
        if (!g_.displacement[0]) return volume * sum;
        for (int a = 0; a < Dim; ++a) {
            const double pull = sum / weight * weight_slope * 2.0 * longest.vector[a];
            gradient.w[a][longest.corner] -= pull;
            gradient.w[a][longest.corner | (1 << longest.axis)] += pull;
        }
        for (int c = 0; c < corners; ++c) {
            const std::size_t at = cell.node + corner_[c];
            for (int a = 0; a < Dim; ++a) {
                g_.displacement[a][at] += static_cast<T>(scale_ * per_unit_ * gradient.w[a][c]);
            }
            if (g_.u_previous) g_.u_previous[at] += static_cast<T>(scale_ * gradient.u[c]);
        }
        return volume * sum;
    }

    const kernels::StepFields<Dim, T>& f_;
    const kernels::StepWeights& s_;
    const kernels::StepGradients<Dim, T>& g_;
    double per_unit_, scale_ = 0.0;
    std::ptrdiff_t stride_[Dim];
    std::size_t corner_[corners];
    T* next_gradient_ = nullptr;
};

}  // namespace

template <int Dim, class T>
double stretched_mismatch(int row_begin, int row_end, const kernels::StepFields<Dim, T>& fields,
                          const kernels::StepWeights& weights, const kernels::StepGradients<Dim, T>& gradients) {
    return StretchedMismatch<Dim, T>(fields, weights, gradients).rows(row_begin, row_end);
}

template double stretched_mismatch<2, double>(int, int, const kernels::StepFields<2, double>&,
                                              const kernels::StepWeights&, const kernels::StepGradients<2, double>&);
template double stretched_mismatch<3, double>(int, int, const kernels::StepFields<3, double>&,
                                              const kernels::StepWeights&, const kernels::StepGradients<3, double>&);
template double stretched_mismatch<2, float>(int, int, const kernels::StepFields<2, float>&,
                                             const kernels::StepWeights&, const kernels::StepGradients<2, float>&);
template double stretched_mismatch<3, float>(int, int, const kernels::StepFields<3, float>&,
                                             const kernels::StepWeights&, const kernels::StepGradients<3, float>&);

}  // namespace morphodesic
