#include "geodesic/energy/path_energy.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "geodesic/energy/area_energy.h"

namespace morphodesic {

namespace {

// Slabs are the unit of parallel work. Their number depends on the grid alone, so sums keep their order.
template <int Dim>
int slab_thickness(int cells) {
    return Dim == 2 ? std::min(cells, 16) : std::min(cells, 4);
}

template <class Body>
void for_all(int count, const Body& body) {
    oneapi::tbb::this_task_arena::isolate([&] { oneapi::tbb::parallel_for(0, count, body); });
}

template <int Dim>
void clear_boundary(const DyadicGrid<Dim>& grid, double* field) {
    const int n = grid.nodes_per_axis();
    const auto row = static_cast<std::size_t>(n);
    const int planes = Dim == 3 ? n : 1;
    for (int plane = 0; plane < planes; ++plane) {
        double* base = field + static_cast<std::size_t>(plane) * row * row;
        if (Dim == 3 && (plane == 0 || plane == n - 1)) {
            std::fill(base, base + row * row, 0.0);
            continue;
        }
        std::fill(base, base + row, 0.0);
        std::fill(base + row * (row - 1), base + row * row, 0.0);
        for (std::size_t j = 1; j + 1 < row; ++j) base[j * row] = base[j * row + row - 1] = 0.0;
    }
}

}  // namespace

double PathTerms::path_length() const {
    double sum = 0.0;
    for (const double e : deformation) sum += std::sqrt(e);
    return sum;
}

double PathTerms::path_energy() const {
    double sum = 0.0;
    for (const double e : deformation) sum += e;
    return sum * static_cast<double>(deformation.size());
}

template <int Dim>
PathEnergy<Dim>::PathEnergy(const LevelSet<Dim>& first, const LevelSet<Dim>& last, int time_steps,
                            const GeodesicOptions& options, const ScalarField<Dim>& mask)
    : layout_{first.grid, time_steps},
      options_(options),
      first_(first),
      last_(last),
      mask_(mask),
      eta_(options.eta(time_steps)) {
    if (!(first.grid == last.grid) || (!mask.values.empty() && !(mask.grid == first.grid))) {
        throw std::invalid_argument("PathEnergy: the shapes and the mask must live on one grid");
    }
    if (first.grid.level() < 3) throw std::invalid_argument("PathEnergy: level must be at least 3");
    const int cells = first.grid.cells_per_axis();
    const int thickness = slab_thickness<Dim>(cells);
    slabs_.resize(static_cast<std::size_t>(time_steps));
    for (auto& slabs : slabs_) {
        for (int begin = 0; begin < cells; begin += thickness) {
            slabs.push_back({begin, begin + thickness, {}, 0, 0, {}});
        }
    }
}

template <int Dim>
const double* PathEnergy<Dim>::level_set(std::span<const double> x, int k) const {
    if (k == 0) return first_.values.data();
    if (k == layout_.time_steps) return last_.values.data();
    return x.data() + layout_.level_set(k);
}

template <int Dim>
void PathEnergy<Dim>::evaluate_slab(int k, Slab& slab, std::span<const double> x, std::span<double> gradient) {
    const int last_step = layout_.time_steps;
    const std::size_t plane = layout_.nodes() / static_cast<std::size_t>(layout_.grid.nodes_per_axis());
    kernels::StepFields<Dim> fields{};
    kernels::StepGradients<Dim> out{};
    for (int a = 0; a < Dim; ++a) fields.displacement[a] = x.data() + layout_.displacement(k, a);
    fields.u_previous = level_set(x, k - 1);
    fields.u_next = level_set(x, k);
    fields.mask = k == 1 && !mask_.values.empty() ? mask_.values.data() : nullptr;
    if (!gradient.empty()) {
        for (int a = 0; a < Dim; ++a) out.displacement[a] = gradient.data() + layout_.displacement(k, a);
        out.u_previous = k > 1 ? gradient.data() + layout_.level_set(k - 1) : nullptr;
        if (k < last_step) {
            // Rows of u_k that the deformed slab can reach.
            const double* w = fields.displacement[Dim - 1];
            const auto from = static_cast<std::size_t>(slab.begin) * plane;
            const auto to = static_cast<std::size_t>(slab.end + 1) * plane;
            const auto [low, high] = std::minmax_element(w + from, w + to);
            const double per_cell = layout_.grid.cells_per_axis();
            const int cells = layout_.grid.cells_per_axis();
            const auto clamped = [&](double row) { return static_cast<int>(std::clamp(row, 0.0, 1.0 * cells)); };
            slab.first_row = clamped(std::floor(slab.begin + *low * per_cell));
            slab.first_row = std::min(slab.first_row, cells - 1);
            const int last_row = std::max(clamped(std::floor(slab.end + *high * per_cell) + 1), slab.first_row + 1);
            slab.rows = last_row - slab.first_row + 1;
            slab.scatter.assign(static_cast<std::size_t>(slab.rows) * plane, 0.0);
            out.u_next = slab.scatter.data();
            out.u_next_first_row = slab.first_row;
        }
    }
    const kernels::StepWeights weights{layout_.grid.level(),
                                       options_.lambda,
                                       options_.mu,
                                       options_.outside_stiffness,
                                       eps(),
                                       static_cast<double>(last_step),
                                       eta_,
                                       barrier_weight * last_step};
    slab.sums = kernels::step_energy_rows<Dim>(slab.begin, slab.end, fields, weights, out);
}

template <int Dim>
PathTerms PathEnergy<Dim>::evaluate(std::span<const double> x, std::span<double> gradient) {
    assert(x.size() == layout_.size());
    assert(gradient.empty() || gradient.size() == layout_.size());
    const int steps = layout_.time_steps;
    const int slab_count = static_cast<int>(slabs_[0].size());
    const std::size_t nodes = layout_.nodes();
    if (!gradient.empty()) {
        for_all(layout_.field_count(), [&](int field) {
            double* out = gradient.data() + static_cast<std::size_t>(field) * nodes;
            std::fill(out, out + nodes, 0.0);
        });
    }
    // Neighbouring slabs share a row of nodes: even slabs first, then odd ones.
    for (int colour = 0; colour < 2; ++colour) {
        const int coloured = (slab_count + 1 - colour) / 2;
        for_all(steps * coloured, [&](int task) {
            const int k = task / coloured, s = 2 * (task % coloured) + colour;
            evaluate_slab(k + 1, slabs_[static_cast<std::size_t>(k)][static_cast<std::size_t>(s)], x, gradient);
        });
    }

    PathTerms terms;
    terms.deformation.assign(static_cast<std::size_t>(steps), 0.0);
    terms.mismatch.assign(static_cast<std::size_t>(steps), 0.0);
    terms.min_det = std::numeric_limits<double>::infinity();
    terms.step_min_det.assign(static_cast<std::size_t>(steps), terms.min_det);
    bool admissible = true;
    for (std::size_t k = 0; k < slabs_.size(); ++k) {
        for (const Slab& slab : slabs_[k]) {
            terms.deformation[k] += slab.sums.deformation;
            terms.mismatch[k] += slab.sums.mismatch;
            terms.barrier += slab.sums.barrier;
            if (!(slab.sums.min_det >= terms.step_min_det[k]))
                terms.step_min_det[k] = slab.sums.min_det;  // keeps a NaN
        }
        admissible = admissible && terms.step_min_det[k] >= least_det;
        terms.min_det = std::min(terms.min_det, terms.step_min_det[k]);
        terms.total += steps * terms.deformation[k] + eta_ * terms.mismatch[k];
    }
    terms.total += terms.barrier;
    if (!admissible || !std::isfinite(terms.total)) {
        terms.total = std::numeric_limits<double>::infinity();
        return terms;
    }

    if (!gradient.empty()) {
        const std::size_t plane = nodes / static_cast<std::size_t>(layout_.grid.nodes_per_axis());
        for_all(steps, [&](int index) {
            const int k = index + 1;
            for (int a = 0; a < Dim; ++a) clear_boundary(layout_.grid, gradient.data() + layout_.displacement(k, a));
            if (k == steps) return;
            double* target = gradient.data() + layout_.level_set(k);
            for (const Slab& slab : slabs_[static_cast<std::size_t>(index)]) {
                double* out = target + static_cast<std::size_t>(slab.first_row) * plane;
                for (std::size_t i = 0; i < slab.scatter.size(); ++i) out[i] += slab.scatter[i];
            }
        });
    }
    if (options_.area_weight > 0) {
        const double factor = options_.area_weight / steps;
        for (int k = 1; k <= steps; ++k) {
            double* out = gradient.empty() || k == steps ? nullptr : gradient.data() + layout_.level_set(k);
            terms.area += area_energy<Dim>(layout_.grid, level_set(x, k), eps(), factor, out);
        }
        terms.total += factor * terms.area;
    }
    return terms;
}

template class PathEnergy<2>;
template class PathEnergy<3>;

}  // namespace morphodesic
