#include "geodesic/solver/trajectories.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "geodesic/grid/node_loop.h"
#include "geodesic/grid/q1_element.h"
#include "geodesic/solver/mismatch_points.h"
#include "geodesic/solver/row_places.h"

namespace morphodesic {

namespace {

// Squeezed and stretched cells of the background are taken as less so.
constexpr float least_stretch = 0.25F, most_stretch = 4.0F;
// Points are followed back to this part of a cell.
constexpr double near_enough = 0.02;
constexpr int most_iterations = 20;

template <int Dim>
using Matrix = Eigen::Matrix<float, Dim, Dim>;

float tamed_stretch(float stretch) {
    return std::clamp(stretch, least_stretch, most_stretch);
}

template <int Dim>
[[gnu::noinline]] Matrix<Dim> with_tamed_stretches(const Matrix<Dim>& m) {
    if (!m.allFinite()) return Matrix<Dim>::Identity();
    if constexpr (Dim == 2) {
        // A similarity and a similarity with a reflection, of sizes (s1 + s2) / 2 and (s1 - s2) / 2 for the singular
        // values s1 >= |s2|, s2 with the sign of the determinant.
        Matrix<2> cofactor;
        cofactor << m(1, 1), -m(1, 0), -m(0, 1), m(0, 0);
        const Matrix<2> turned = 0.5F * (m + cofactor), mirrored = 0.5F * (m - cofactor);
        const float p = turned.col(0).norm(), q = mirrored.col(0).norm();
        const float s1 = tamed_stretch(p + q), s2 = std::copysign(tamed_stretch(std::abs(p - q)), p - q);
        Matrix<2> result = Matrix<2>::Zero();
        if (p > 0.0F) result += 0.5F * (s1 + s2) / p * turned;
        if (q > 0.0F) result += 0.5F * (s1 - s2) / q * mirrored;
        return result;
    } else {
        const Eigen::JacobiSVD<Matrix<Dim>> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
        const auto s = svd.singularValues().unaryExpr(&tamed_stretch);
        return svd.matrixU() * s.asDiagonal() * svd.matrixV().transpose();
    }
}

template <int Dim>
Matrix<Dim> tamed(const Matrix<Dim>& m) {
    const bool is_tame = m.squaredNorm() < most_stretch && m.determinant() > least_stretch;  // most are
    return is_tame ? m : with_tamed_stretches<Dim>(m);
}

/// Central differences of a field at a node, one-sided on the boundary.
template <int Dim, class T>
std::array<float, Dim> slope(const DyadicGrid<Dim>& grid, const std::array<int, Dim>& node, const T* field,
                             std::size_t i) {
    std::array<float, Dim> d;
    std::size_t stride = 1;
    for (std::size_t a = 0; a < Dim; ++a) {
        const std::size_t up = node[a] < grid.cells(static_cast<int>(a)) ? stride : 0, down = node[a] > 0 ? stride : 0;
        stride *= static_cast<std::size_t>(grid.nodes(static_cast<int>(a)));
        d[a] = static_cast<float>((field[i + up] - field[i - down]) * static_cast<T>(grid.cells_per_unit())) /
               static_cast<float>((up ? 1 : 0) + (down ? 1 : 0));
    }
    return d;
}

/// grad u at the nodes, weighted by delta_eps^2 over the quadrature points around: what counts is the rim, and it is
/// narrower than a cell. Far from the rim: central differences.
template <int Dim>
std::array<std::vector<float>, Dim> rim_gradient(const DyadicGrid<Dim>& grid, std::span<const Point<Dim>> points,
                                                 const double* u, double eps) {
    const auto corners = q1::corner_offsets(grid);
    const double per_cell = grid.cells_per_unit();
    std::array<std::vector<float>, Dim> sum;
    for (auto& c : sum) c.assign(grid.node_count(), 0.0F);
    std::vector<float> weight(grid.node_count(), 0.0F);
    q1::for_each_cell(grid, [&](std::size_t node) {
        double v[1 << Dim];
        bool near = false;
        for (std::size_t c = 0; c < (1 << Dim); ++c) {
            v[c] = u[node + corners[c]];
            near = near || std::abs(v[c]) < 8 * eps || v[c] * v[0] < 0;
        }
        if (!near) return;
        for (const Point<Dim>& y : points) {
            double value = 0.0, g[Dim] = {};
            for (int c = 0; c < (1 << Dim); ++c) {
                value += q1::shape<Dim>(c, y) * v[c];
                for (int a = 0; a < Dim; ++a) g[a] += q1::shape_slope<Dim>(c, y, a) * v[c] * per_cell;
            }
            const double t = 1.0 / (1.0 + value * value / (eps * eps)), w = t * t;
            for (int c = 0; c < (1 << Dim); ++c) {
                const std::size_t i = node + corners[static_cast<std::size_t>(c)];
                const double s = w * q1::shape<Dim>(c, y);
                weight[i] += static_cast<float>(s);
                for (int a = 0; a < Dim; ++a) sum[static_cast<std::size_t>(a)][i] += static_cast<float>(s * g[a]);
            }
        }
    });
    for_each_node(grid, [&](std::size_t i, const std::array<int, Dim>& node) {
        constexpr float floor = 1e-3F;
        const auto g = slope<Dim>(grid, node, u, i);
        for (std::size_t a = 0; a < Dim; ++a) sum[a][i] = (sum[a][i] + floor * g[a]) / (weight[i] + floor);
    });
    return sum;
}
}  // namespace

template <int Dim>
Trajectories<Dim>::Trajectories(const PathLayout<Dim>& layout, const DyadicGrid<Dim>& coarse)
    : layout_(layout), coarse_(coarse), frames_(static_cast<std::size_t>(layout.time_steps)) {
    for (Frame& frame : frames_) {
        for (auto* fields : {&frame.fraction, &frame.q}) {
            for (auto& c : *fields) c.assign(layout.nodes(), 0.0F);
        }
        for (auto& c : frame.a) c.assign(layout.nodes(), 0.0F);
        frame.cell.resize(layout.nodes());
    }
}

template <int Dim>
void Trajectories<Dim>::update(const PathEnergy<Dim>& energy, std::span<const double> x) {
    follow(x);
    for_indices(1, layout_.time_steps, [&](int k) {
        frames_[static_cast<std::size_t>(k)].gradient = rim_gradient<Dim>(
            layout_.grid, mismatch_points<Dim>(energy.quadrature()), energy.level_set(x, k), energy.eps());
    });
    differentiate(energy, x);
}

/// P_k = P_{k-1} o phi_k^-1.
template <int Dim>
void Trajectories<Dim>::follow(std::span<const double> x) {
    const auto& grid = layout_.grid;
    const double h = grid.spacing(), fine_per_coarse = 1 << (grid.level() - coarse_.level());
    for (int k = 0; k < layout_.time_steps; ++k) {
        Frame& frame = frames_[static_cast<std::size_t>(k)];
        for (auto& c : frame.origin) c.assign(layout_.nodes(), 0.0F);
        std::array<const double*, Dim> w{};
        if (k > 0) w = layout_.displacements(x.data(), k);
        for_rows(grid, [&](std::size_t row) {
            RowPlaces<Dim> here(grid, row), origin = here;
            if (k > 0) {
                RowPlaces<Dim> before = here;
                before.solve(here, w, grid.cells_per_unit(), 1.0, near_enough, most_iterations);
                for (std::size_t a = 0; a < Dim; ++a) {
                    const double* moved = before.sample(frames_[static_cast<std::size_t>(k - 1)].origin[a].data());
                    for (std::size_t i = 0; i < here.count(); ++i) {
                        const double move = (before[a][i] - here[a][i]) * h + moved[i];
                        frame.origin[a][row + i] = static_cast<float>(move);
                        origin[a][i] = here[a][i] + move * grid.cells_per_unit();
                    }
                }
            }
            for (std::size_t a = 0; a < Dim; ++a) {
                for (std::size_t i = 0; i < here.count(); ++i) origin[a][i] /= fine_per_coarse;
            }
            std::array<float*, Dim> fraction;
            for (std::size_t a = 0; a < Dim; ++a) fraction[a] = frame.fraction[a].data() + row;
            origin.locate(coarse_, frame.cell.data() + row, fraction);
        });
    }
}

template <int Dim>
void Trajectories<Dim>::finish() {
    for (Frame& frame : frames_) {
        frame.origin = {};
        frame.gradient = {};
    }
}

/// A_{k+1} = D phi_{k+1} A_k at the nodes of frame k, A_k = (D P_k)^-1, and q_k = grad u_k A_k.
template <int Dim>
void Trajectories<Dim>::differentiate(const PathEnergy<Dim>& energy, std::span<const double> x) {
    const auto& grid = layout_.grid;
    for_indices(0, layout_.time_steps, [&](int k) {
        Frame& frame = frames_[static_cast<std::size_t>(k)];
        for_each_node(grid, [&](std::size_t i, const std::array<int, Dim>& node) {
            Matrix<Dim> back = Matrix<Dim>::Identity(), forth = Matrix<Dim>::Identity();
            for (int r = 0; r < Dim; ++r) {
                const auto s = slope<Dim>(grid, node, frame.origin[static_cast<std::size_t>(r)].data(), i);
                const auto t = slope<Dim>(grid, node, x.data() + layout_.displacement(k + 1, r), i);
                for (int c = 0; c < Dim; ++c) {
                    back(r, c) += s[static_cast<std::size_t>(c)];
                    forth(r, c) += t[static_cast<std::size_t>(c)];
                }
            }
            const Matrix<Dim> until = tamed<Dim>(back).inverse();
            const Matrix<Dim> a = tamed<Dim>(forth * until);
            for (int r = 0; r < Dim; ++r) {
                for (int c = 0; c < Dim; ++c) frame.a[static_cast<std::size_t>(r * Dim + c)][i] = a(r, c);
            }
            if (k == 0) return;
            const float near = near_contour(energy.level_set(x, k)[i], energy.eps());
            for (int c = 0; c < Dim; ++c) {
                float q = 0.0F;
                for (int r = 0; r < Dim; ++r) q += frame.gradient[static_cast<std::size_t>(r)][i] * until(r, c);
                frame.q[static_cast<std::size_t>(c)][i] = q * near;
            }
        });
    });
}
template <int Dim>
Matrix<Dim> Trajectories<Dim>::jacobian_at(int k, std::size_t node, const Point<Dim>& fraction) const {
    const auto corners = q1::corner_offsets(layout_.grid);
    Matrix<Dim> back = Matrix<Dim>::Identity();
    for (int a = 0; a < Dim; ++a) {
        for (int c = 0; c < (1 << Dim); ++c) {
            const float p = frame(k).origin[static_cast<std::size_t>(a)][node + corners[static_cast<std::size_t>(c)]];
            for (int b = 0; b < Dim; ++b) {
                back(a, b) +=
                    static_cast<float>(q1::shape_slope<Dim>(c, fraction, b) * layout_.grid.cells_per_unit()) * p;
            }
        }
    }
    return tamed<Dim>(back).inverse();
}

template <int Dim>
std::array<float, Dim> Trajectories<Dim>::origin_at(int k, std::size_t node, const Point<Dim>& fraction) const {
    const auto corners = q1::corner_offsets(layout_.grid);
    const auto cell = layout_.grid.node(node);
    std::array<float, Dim> p;
    for (std::size_t a = 0; a < Dim; ++a) {
        p[a] = static_cast<float>((cell[a] + fraction[a]) * layout_.grid.spacing());
        for (int c = 0; c < (1 << Dim); ++c) {
            p[a] += static_cast<float>(q1::shape<Dim>(c, fraction)) *
                    frame(k).origin[a][node + corners[static_cast<std::size_t>(c)]];
        }
    }
    return p;
}

template class Trajectories<2>;
template class Trajectories<3>;

}  // namespace morphodesic
