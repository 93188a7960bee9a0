#include "geodesic/energy/path_energy.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "geodesic/energy/area_energy.h"
#include "geodesic/energy/stretched_cells.h"
#include "geodesic/grid/node_loop.h"

namespace morphodesic {

namespace {

// Slabs are the unit of parallel work. Their number depends on the grid alone, so sums keep their order.
template <int Dim>
int slab_thickness(int cells) {
    return Dim == 2 ? std::min(cells, 16) : std::min(cells, 4);
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
    const int cells = first.grid.cells(Dim - 1);
    const int thickness = slab_thickness<Dim>(cells);
    slabs_.resize(static_cast<std::size_t>(time_steps));
    for (auto& slabs : slabs_) {
        for (int begin = 0; begin < cells; begin += thickness) {
            slabs.push_back({begin, std::min(begin + thickness, cells), 0, {}});
        }
    }
    if (options_.area_weight > 0) {
        last_area_ = area_energy<Dim>(layout_.grid, last_.values.data(), eps(), 0.0, nullptr);
    }
}

template <int Dim>
const double* PathEnergy<Dim>::level_set(std::span<const double> x, int k) const {
    if (k == 0) return first_.values.data();
    if (k == layout_.time_steps) return last_.values.data();
    return x.data() + layout_.level_set(k);
}

template <int Dim>
template <class T>
void PathEnergy<Dim>::evaluate_slab(int k, Slab& slab, bool shares_rows, const Fields<T>& f, std::span<T> gradient,
                                    std::vector<T>& scatter) {
    const int last_step = layout_.time_steps, cells = layout_.grid.cells(Dim - 1);
    const std::size_t plane = layout_.grid.stride(Dim - 1);
    kernels::StepFields<Dim, T> fields{};
    std::copy(layout_.grid.cells().begin(), layout_.grid.cells().end(), fields.cells);
    kernels::StepGradients<Dim, T> out{};
    for (int a = 0; a < Dim; ++a) fields.displacement[a] = f.x + layout_.displacement(k, a);
    fields.u_previous = k == 1 ? f.first : f.x + layout_.level_set(k - 1);
    fields.u_next = k == last_step ? f.last : f.x + layout_.level_set(k);
    fields.mask = k == 1 ? f.mask : nullptr;
    // Rows of u_k that the deformed slab can reach.
    const T* w = fields.displacement[Dim - 1];
    const auto from = static_cast<std::size_t>(slab.begin) * plane, to = static_cast<std::size_t>(slab.end + 1) * plane;
    const auto [low, high] = std::minmax_element(w + from, w + to);
    const auto reached = [&](int row, T displacement) {
        const double at = row + static_cast<double>(displacement) * layout_.grid.cells_per_unit();
        return at > 0.0 ? static_cast<int>(std::min(std::floor(at), 1.0 * cells)) : 0;  // 0 for a NaN
    };
    slab.first_row = fields.u_next_first_row = std::min(reached(slab.begin, *low), cells - 3);
    fields.u_next_last_row = std::max(std::min(reached(slab.end, *high) + 1, cells), slab.first_row + 3);
    if (!gradient.empty()) {
        for (int a = 0; a < Dim; ++a) out.displacement[a] = gradient.data() + layout_.displacement(k, a);
        out.u_previous = k > 1 ? gradient.data() + layout_.level_set(k - 1) : nullptr;
        // The rows it adds to; those shared with slabs that came before are clear already.
        const auto clear_from = static_cast<std::size_t>(slab.begin + (shares_rows ? 1 : 0)) * plane;
        const auto clear_to = static_cast<std::size_t>(slab.end + (shares_rows && slab.end < cells ? 0 : 1)) * plane;
        for (T* field : out.displacement) std::fill(field + clear_from, field + clear_to, T{});
        if (out.u_previous) std::fill(out.u_previous + clear_from, out.u_previous + clear_to, T{});
        if (k < last_step) {
            scatter.assign(static_cast<std::size_t>(fields.u_next_last_row - fields.u_next_first_row + 1) * plane, T{});
            out.u_next = scatter.data();
        }
    }
    const kernels::StepWeights weights{layout_.grid.level(),
                                       options_.lambda,
                                       options_.mu,
                                       options_.outside_stiffness,
                                       eps(),
                                       static_cast<double>(last_step),
                                       eta_,
                                       barrier_weight * last_step,
                                       quadrature()};
    slab.sums = kernels::step_energy_rows<Dim, T>(slab.begin, slab.end, fields, weights, out);
    slab.sums.mismatch += stretched_mismatch<Dim, T>(layout_.grid, slab.begin, slab.end, fields, weights, out);
}

/// Terms from the sums of the slabs; total is infinite where a deformation folds: where its det is below `least`.
template <int Dim>
PathTerms PathEnergy<Dim>::collect(double least) const {
    const int steps = layout_.time_steps;
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
        admissible = admissible && terms.step_min_det[k] >= least;
        terms.min_det = std::min(terms.min_det, terms.step_min_det[k]);
        terms.total += steps * terms.deformation[k] + eta_ * terms.mismatch[k];
    }
    terms.total += terms.barrier;
    if (!admissible || !std::isfinite(terms.total)) terms.total = std::numeric_limits<double>::infinity();
    return terms;
}

template <int Dim>
template <class T>
PathTerms PathEnergy<Dim>::evaluate_as(const Fields<T>& fields, std::span<const double> x, std::span<T> gradient,
                                       Scatter<T>& scatter) {
    const int steps = layout_.time_steps;
    const int slab_count = static_cast<int>(slabs_[0].size());
    const std::size_t nodes = layout_.nodes();
    scatter.resize(slabs_.size());
    for (auto& step : scatter) step.resize(static_cast<std::size_t>(slab_count));
    // Neighbouring slabs share a row of nodes: even slabs first, then odd ones.
    for (int colour = 0; colour < 2; ++colour) {
        const int coloured = (slab_count + 1 - colour) / 2;
        for_indices(0, steps * coloured, [&](int task) {
            const auto k = static_cast<std::size_t>(task / coloured);
            const auto s = static_cast<std::size_t>(2 * (task % coloured) + colour);
            evaluate_slab<T>(task / coloured + 1, slabs_[k][s], colour == 1, fields, gradient, scatter[k][s]);
        });
    }
    PathTerms terms = collect(std::is_same_v<T, float> ? least_det_single : least_det);
    if (!std::isfinite(terms.total)) return terms;

    if (!gradient.empty()) {
        const std::size_t plane = layout_.grid.stride(Dim - 1);
        for_indices(0, steps, [&](int index) {
            const int k = index + 1;
            for (int a = 0; a < Dim; ++a) {
                clear_boundary<Dim, T>(layout_.grid, gradient.data() + layout_.displacement(k, a));
            }
            if (k == steps) return;
            T* target = gradient.data() + layout_.level_set(k);
            for (std::size_t s = 0; s < static_cast<std::size_t>(slab_count); ++s) {
                const auto i = static_cast<std::size_t>(index);
                T* out = target + static_cast<std::size_t>(slabs_[i][s].first_row) * plane;
                for (const T value : scatter[i][s]) *out++ += value;
            }
        });
    }
    if (options_.area_weight > 0) {
        const double factor = options_.area_weight / steps;
        std::vector<double> areas(static_cast<std::size_t>(steps), last_area_);
        for_indices(1, steps, [&](int k) {
            std::vector<double> part(gradient.empty() ? 0 : nodes, 0.0);
            areas[static_cast<std::size_t>(k - 1)] =
                area_energy<Dim>(layout_.grid, level_set(x, k), eps(), factor, part.empty() ? nullptr : part.data());
            for (std::size_t i = 0; i < part.size(); ++i) gradient[layout_.level_set(k) + i] += static_cast<T>(part[i]);
        });
        for (const double area : areas) terms.area += area;
        terms.total += factor * terms.area;
    }
    return terms;
}

template <int Dim>
PathTerms PathEnergy<Dim>::evaluate(std::span<const double> x, std::span<double> gradient) {
    assert(x.size() == layout_.size());
    assert(gradient.empty() || gradient.size() == layout_.size());
    const Fields<double> fields{x.data(), first_.values.data(), last_.values.data(),
                                mask_.values.empty() ? nullptr : mask_.values.data()};
    return evaluate_as<double>(fields, x, gradient, scatter_);
}

template <int Dim>
PathTerms PathEnergy<Dim>::evaluate_single(std::span<const double> x, std::span<float> gradient) {
    assert(x.size() == layout_.size());
    assert(gradient.empty() || gradient.size() == layout_.size());
    if (layout_.grid.cells(0) % kernels::single_lanes != 0) {  // not whole vectors of single precision
        std::vector<double> twice(gradient.size());
        auto terms = evaluate(x, twice);
        std::copy(twice.begin(), twice.end(), gradient.begin());
        return terms;
    }
    if (single_first_.empty()) {
        single_first_.assign(first_.values.begin(), first_.values.end());
        single_last_.assign(last_.values.begin(), last_.values.end());
        single_mask_.assign(mask_.values.begin(), mask_.values.end());
        single_x_.resize(layout_.size());
    }
    for_indices(0, layout_.field_count(), [&](int field) {
        const auto from = layout_.nodes() * static_cast<std::size_t>(field);
        for (std::size_t i = from; i < from + layout_.nodes(); ++i) single_x_[i] = static_cast<float>(x[i]);
    });
    const Fields<float> fields{single_x_.data(), single_first_.data(), single_last_.data(),
                               single_mask_.empty() ? nullptr : single_mask_.data()};
    return evaluate_as<float>(fields, x, gradient, single_scatter_);
}

template class PathEnergy<2>;
template class PathEnergy<3>;

}  // namespace morphodesic
