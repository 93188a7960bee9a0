#include "datasets/normalize.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "datasets/content_digest.h"
#include "datasets/note_text.h"
#include "datasets/read_error.h"
#include "geodesic/grid/measures.h"
#include "geodesic/grid/transfer.h"

namespace morphodesic::datasets {

namespace {

/// Two digits also of a small share, which is not to be read as none.
std::string digits_of_percent(double share) {
    char text[32];
    std::snprintf(text, sizeof text, share < 0.01 ? "%.2g" : "%.1f", 100.0 * share);
    return text;
}

/// What a grid makes of the parts of a shape, with what to do; empty if it has them all. Parts and holes are those of
/// the triangulated grid, as in the tables of paths: nodes that touch across one of the two diagonals of a cell are
/// apart.
template <int Dim>
std::string note_on_topology(const RawShape<Dim>& raw, const LevelSet<Dim>& u, const std::string& remedy) {
    if (raw.components == 0) return {};
    const ShapeMeasures seen = measure(u);
    const bool counts_holes = raw.holes >= 0;
    const int holes = seen.components - seen.euler;
    if (counts_holes) {
        if (seen.components == raw.components && holes == raw.holes) return {};
    } else if (seen.components <= raw.components) {  // parts of a mesh may lie in one another
        return {};
    }
    const auto parts = [](int n) { return count(static_cast<std::size_t>(n), "part"); };
    const auto parts_and_holes = [&](int n, int m) {
        return parts(n) + " and " + count(static_cast<std::size_t>(m), "hole");
    };
    const auto found = counts_holes ? parts_and_holes(seen.components, holes) : parts(seen.components);
    const auto given = counts_holes ? parts_and_holes(raw.components, raw.holes) : std::to_string(raw.components);
    return "On the grid of level " + std::to_string(u.grid.level()) + " it has " + found + " instead of " + given +
           ", as some or gaps between them are thinner than its cells: " + remedy + ".";
}

}  // namespace

std::vector<std::string> NormalizeOptions::problems() const {
    std::vector<std::string> result;
    if (mode != "common" && mode != "each" && mode != "none") {
        result.push_back("normalize must be common, each or none, not \"" + mode + "\"");
    }
    if (!(scale >= 0.0 && std::isfinite(scale))) result.push_back("the common scale must be finite and not negative");
    if (solved_level < 0) result.push_back("the level of the solver must not be negative");
    if (level < 1 || level > 10) result.push_back("the grid level must be from 1 to 10");
    return result;
}

double common_scale(std::span<const double> extent_radii) {
    if (extent_radii.empty()) throw std::invalid_argument("a common scale needs at least one shape");
    const double largest = *std::max_element(extent_radii.begin(), extent_radii.end());
    if (!(largest > 0.0 && std::isfinite(largest)))
        throw std::invalid_argument("extent radii must be positive and finite");
    return largest_extent_radius / largest;
}

template <int Dim>
Placement<Dim> placement_of(const RawShape<Dim>& raw, const NormalizeOptions& options,
                            std::vector<std::string>* notes) {
    Placement<Dim> placement;
    Point<Dim> middle = raw.centroid;
    const double fitting = largest_extent_radius / raw.extent_radius;
    if (options.mode == "none") {
        double side = 0.0;
        for (int a = 0; a < Dim; ++a) {
            side = std::max(side, raw.frame_high[a] - raw.frame_low[a]);
            middle[a] = 0.5 * (raw.frame_low[a] + raw.frame_high[a]);
        }
        placement.scale = 1.0 / side;
        if constexpr (Dim == 3) {  // a size that another solid would not keep is none to compare
            if (side > 1.2) {
                throw ReadError(raw.source.path, "it does not fit into the cube, whose side is one unit of the file",
                                "use --normalize common, which keeps the ratios of all sizes, or --normalize each");
            }
            placement.scale = 1.0;  // the side of the frame, but for rounding
        }
    } else if (options.mode == "each") {
        placement.scale = std::pow(unit_volume<Dim> / raw.volume, 1.0 / Dim);
        if (placement.scale > fitting) {
            placement.scale = fitting;
            if (notes != nullptr) {
                notes->push_back(std::string("Too long to have the ") + (Dim == 2 ? "area" : "volume") +
                                 " of the others in the cube: scaled to " +
                                 digits_of_percent(raw.volume * std::pow(fitting, Dim) / unit_volume<Dim>) +
                                 " % of it.");
            }
        }
    } else {
        placement.scale = options.scale > 0.0 ? options.scale : fitting;
        // A shape that joins a finished collection may be larger than all that the scale was made for.
        if (placement.scale * raw.extent_radius > 0.47) {
            placement.scale = fitting;
            if (notes != nullptr) {
                notes->push_back("Too large for the common scale: shrunk to fit, its size is not comparable.");
            }
        }
    }
    for (int a = 0; a < Dim; ++a) placement.offset[a] = 0.5 - placement.scale * middle[a];
    return placement;
}

template <int Dim>
Shape<Dim> normalize(const RawShape<Dim>& raw, const NormalizeOptions& options) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
    Shape<Dim> shape;
    shape.name = raw.source.name;
    shape.label = raw.source.label;
    shape.notes = raw.notes;
    const Placement<Dim> placement = placement_of(raw, options, &shape.notes);
    const DyadicGrid<Dim> grid(options.level);
    shape.level_set = raw.geometry->signed_distance(grid, placement);
    shape.occlusion_mask = raw.geometry->occlusion_mask(grid, placement);
    shape.scale = placement.scale;
    shape.volume = raw.volume * std::pow(placement.scale, Dim);
    shape.fullness = fullness(shape.level_set);
    const std::string finer =
        options.mode == "each" ? "use a finer --level" : "use a finer --level or --normalize each";
    const int solved_level = options.solved_level > 0 ? std::min(options.solved_level, options.level) : options.level;
    std::optional<LevelSet<Dim>> coarser;
    if (solved_level < options.level) coarser = restricted(shape.level_set, solved_level);
    const LevelSet<Dim>& seen = coarser ? *coarser : shape.level_set;
    const auto depth_of = [](const LevelSet<Dim>& u) { return *std::max_element(u.values.begin(), u.values.end()); };
    if (!(depth_of(seen) > 0.0)) {
        throw ReadError(raw.source.path, "at this scale no node of the grid lies in the shape",
                        finer + ", or leave the shape out");
    }
    // A node in its middle may well see it, but the rim of a cell and the quadrature do not.
    if (shape.volume < std::pow(grid.spacing(), Dim)) {
        throw ReadError(raw.source.path, "at this scale the whole shape is smaller than a cell of the grid",
                        finer + ", or leave the shape out");
    }
    if (depth_of(shape.level_set) < seen.grid.spacing()) {
        shape.notes.push_back("Thinner than two cells of the grid everywhere: " + finer + ".");
    }
    const std::string topology = note_on_topology(raw, seen, finer);
    if (!topology.empty()) shape.notes.push_back(topology);
    shape.digest = content_digest<Dim>(shape.level_set, shape.occlusion_mask);
    return shape;
}

template Placement<2> placement_of<2>(const RawShape<2>&, const NormalizeOptions&, std::vector<std::string>*);
template Placement<3> placement_of<3>(const RawShape<3>&, const NormalizeOptions&, std::vector<std::string>*);
template Shape<2> normalize<2>(const RawShape<2>&, const NormalizeOptions&);
template Shape<3> normalize<3>(const RawShape<3>&, const NormalizeOptions&);

}  // namespace morphodesic::datasets
