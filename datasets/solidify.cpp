#include "datasets/solidify.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>

#include "datasets/flat_lids.h"
#include "datasets/interruption.h"
#include "datasets/mesh_smoothing.h"
#include "datasets/note_text.h"
#include "datasets/open_surface.h"
#include "datasets/read_error.h"
#include "datasets/scan_checks.h"
#include "datasets/strays.h"
#include "datasets/touching_parts.h"
#include "datasets/triangle_tree.h"
#include "datasets/voxelize.h"
#include "datasets/winding_number.h"

namespace morphodesic::datasets {
namespace {

constexpr double rough = 3e-4;            // of the diagonal: less noise moves no distance by a measurable amount
constexpr double most_correlated = 0.25;  // of bumps about half of whose variance is noise
constexpr double least_bump = 0.3;        // of the noise: independent errors make bumps of 0.7 of it
constexpr double largest_loss = 0.02;     // of the volume: parts that are too thin for the grid stay as they are
constexpr double most_specks = 5.0;       // of the limit for one, together: more are what the object is made of

/// Smooths a surface if its roughness is noise rather than detail.
void smooth_if_noisy(TriangleMesh& mesh, double size, const SolidifyOptions& options, std::vector<std::string>& notes) {
    if (!options.smooth_noise) return;
    const double noise = roughness(mesh);
    // Where the points hardly stand out, edges are what the quadrics of roughness do not fit.
    if (noise < rough * size || bump_correlation(mesh, least_bump * noise) > most_correlated) return;
    smooth_noise(mesh, noise);
    notes.push_back("The surface is rough (noise of " + number(100.0 * noise / size, "%.2f") +
                    " % of the object's size) and was smoothed.");
}

/// Distance from the surface, positive where the winding number is. Walls of one part within another are no surface: a
/// node on one lies inside, not on the border.
std::vector<float> united_values(const TriangleMesh& mesh, const Lattice& lattice,
                                 const std::vector<std::int8_t>& winding) {
    std::vector<float> values = distance_to_triangles(mesh, lattice, 3.0);
    const auto least = static_cast<float>(1e-5 * lattice.spacing);  // isosurface takes no smaller steps than 1e-4
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = winding[i] > 0 ? std::max(values[i], least) : -values[i];
    return values;
}

/// Moves the points of a surface rebuilt on a grid onto the triangles it was rebuilt from, where they are near: on the
/// grid they lie inside of what is bent outward.
/// @return  which points lie off the triangles [points]
std::vector<char> pull_to_surface(TriangleMesh& rebuilt, const TriangleTree& surface, double spacing) {
    const double off = 0.15 * spacing;
    std::vector<char> is_off(rebuilt.points.size(), 0);
    tbb::parallel_for(std::size_t{0}, is_off.size(), [&](std::size_t i) {
        interruption_point(i, 64);
        const auto nearest = surface.nearest(rebuilt.points[i], off);
        is_off[i] = nearest.distance >= off ? 1 : 0;
        rebuilt.points[i] = nearest.point;
    });
    return is_off;
}

/// The parts of a closed surface as one, rebuilt on the grid.
TriangleMesh united(const TriangleMesh& mesh, const TriangleTree& surface, const Lattice& lattice,
                    const std::vector<std::int8_t>& winding) {
    TriangleMesh result = isosurface(lattice, united_values(mesh, lattice, winding));
    pull_to_surface(result, surface, lattice.spacing);
    return result;
}

}  // namespace

Lattice lattice_around(const Box3& box, double spacing, double margin) {
    Lattice lattice;
    lattice.spacing = spacing;
    for (int a = 0; a < 3; ++a) {
        lattice.origin[a] = box.low[a] - margin - 4.0 * spacing;
        lattice.nodes[a] = static_cast<int>(std::ceil((box.high[a] + margin - lattice.origin[a]) / spacing)) + 5;
    }
    return lattice;
}

Solid finished_solid(TriangleMesh mesh, const std::filesystem::path& file, const SolidifyOptions& options,
                     std::vector<std::string> notes) {
    const auto refuse = [&] {
        throw ReadError(file,
                        "the surface encloses no volume (it is one-sided, or thinner than 1/" +
                            std::to_string(options.cells) + " of its length everywhere)",
                        "use a scan from all sides, or close the mesh first");
    };
    if (mesh.triangles.empty()) refuse();
    const Patches part = patches(mesh, true);
    std::vector<TriangleMesh> parts(part.count);
    std::vector<double> volume(part.count, 0.0);
    const Vector3 o = mesh.points.front();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        interruption_point(t);
        const auto c = mesh.corners(t);
        volume[part.of_triangle[t]] += dot(c[0] - o, cross(c[1] - o, c[2] - o)) / 6.0;
    }
    double total = 0.0, largest = 0.0, filled = 0.0;  // filled: as if there were no cavities
    for (const double v : volume) total += v, largest = std::max(largest, v), filled += std::max(v, 0.0);
    if (!(total > 0.0)) refuse();
    std::size_t specks = 0, pinholes = 0, solids = 0, cavities = 0;
    std::array<double, 2> small{};  // volume of all that may be bubbles, and specks
    const double limit = options.speck_fraction * total;
    const auto is_small = [&](double v) { return std::abs(v) < limit; };
    for (const double v : volume) {
        if (is_small(v)) small[v > 0] += std::abs(v);
    }
    double removed = 0.0;
    std::vector<char> kept(part.count);
    for (int p = 0; p < part.count; ++p) {
        const double v = volume[p];
        kept[p] = !is_small(v) || (v != 0.0 && small[v > 0] > most_specks * limit);
        if (!kept[p]) removed += std::abs(v);
        ++(v > 0 ? (kept[p] ? solids : specks) : (kept[p] ? cavities : pinholes));
    }
    std::vector<std::array<int, 3>> triangles;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (kept[part.of_triangle[t]]) triangles.push_back(mesh.triangles[t]);
    }
    mesh.triangles = std::move(triangles);
    clean(mesh);
    if (specks + pinholes > 0) {
        notes.push_back(
            "Removed " + either_or_both(specks, count(specks, "speck"), pinholes, count(pinholes, "bubble")) +
            ", together " + (removed < 1e-4 * total ? "less than 0.01" : number(100.0 * removed / total, "%.2g")) +
            " % of the volume.");
    }
    if (solids > 1) {
        notes.push_back("The object has " + count(solids, "separate part") + "; the largest holds " +
                        percent(largest / filled) + " of the volume.");
    }
    if (cavities > 0)
        notes.push_back("The object is hollow: " + std::to_string(cavities) +
                        (cavities == 1 ? " inner cavity was kept." : " inner cavities were kept."));

    Solid solid;
    solid.volume = signed_volume(mesh);
    // A closed sheet of one cell's thickness holds about this volume: less is no solid but a skin.
    const double size = bounding_box(mesh.points).diagonal();
    if (!(solid.volume > 1e-7 * size * size * size)) refuse();
    solid.centroid = volume_centroid(mesh);
    solid.mesh = std::move(mesh);
    solid.notes = std::move(notes);
    return solid;
}

Solid solid_from_triangles(TriangleMesh mesh, const std::filesystem::path& file, const SolidifyOptions& options) {
    std::vector<std::string> notes;
    const CleaningReport cleaned = clean(mesh);
    if (mesh.triangles.empty() || !(surface_area(mesh) > 0.0)) {
        throw ReadError(file, "no triangle has an area", "export the surface again, in a format that keeps its faces");
    }
    if (cleaned.degenerate_triangles + cleaned.repeated_triangles > 0) {
        const std::size_t m = cleaned.degenerate_triangles, n = cleaned.repeated_triangles;
        notes.push_back(
            "Dropped " +
            either_or_both(m, count(m, "triangle") + " with two equal corners", n, count(n, "repeated triangle")) +
            ".");
    }
    Patches patch = patches(mesh);
    const std::size_t turned = orient_patches(mesh, patch);
    if (turned > 0) notes.push_back("Turned " + count(turned, "triangle") + " to agree with the neighbours.");
    const Strays strays = leave_out_strays(mesh, options.speck_fraction);
    if (strays.count > 0) patch = patches(mesh);
    note_strays(strays, "stray triangle", "area", notes);
    refuse_flat(mesh.points, file);
    MeshTopology state = topology(mesh);

    const Box3 box = bounding_box(mesh.points);
    const double h = box.longest_side() / options.cells;
    const Lattice lattice = lattice_around(box, h, 0.0);

    if (state.closed()) {
        smooth_if_noisy(mesh, box.diagonal(), options, notes);
        std::vector<std::int8_t> winding;
        int low = 0, high = 0;
        const auto measure_winding = [&] {
            winding = winding_numbers(mesh, lattice);
            const auto [lowest, highest] = std::minmax_element(winding.begin(), winding.end());
            low = *lowest, high = *highest;
        };
        measure_winding();
        if (low == -1 && high <= 0) {
            turn_inside_out(mesh);
            for (auto& w : winding) w = static_cast<std::int8_t>(-w);
            low = 0, high = 1;
            notes.push_back("The surface was inside out and was turned.");
        }
        if (low < 0) {
            // Without a negative winding number what is turned inward is the wall of a cavity.
            TriangleMesh upright = mesh;
            const bool changed = turn_patches_outward(upright, patch, TriangleTree(mesh)).turned > 0;
            if (changed && topology(upright).closed()) {
                mesh = std::move(upright);
                measure_winding();
                notes.emplace_back("Parts that were inside out were turned.");
            }
        }
        if (low >= 0 && high == 1) {
            if (parts_touch(mesh, patch, h)) {
                const TriangleTree surface(mesh);
                close_slits(surface, lattice, winding);
                TriangleMesh whole = united(mesh, surface, lattice, winding);
                const double volume = signed_volume(mesh);
                if (std::abs(signed_volume(whole) - volume) < largest_loss * volume) {
                    notes.push_back("Touching parts were joined.");
                    mesh = std::move(whole);
                }
            }
            return finished_solid(std::move(mesh), file, options, std::move(notes));
        }
        if (low < 0 || high > 1) {
            const TriangleTree surface(mesh);
            notes.emplace_back(patch.count == 1
                                   ? "The surface passes through itself; its overlapping parts were united."
                                   : "The surface passes through itself, or parts of it lie within others and face the "
                                     "same way; all of it was united.");
            return finished_solid(united(mesh, surface, lattice, winding), file, options, std::move(notes));
        }
        // Closed but thinner than a cell everywhere: the winding number found no node inside.
        return finished_solid(std::move(mesh), file, options, std::move(notes));
    }

    const std::string crowded = "has " + count(state.crowded_edges, "edge") + " of three or more triangles";
    std::string kind = "The surface is closed but one-sided, as a Klein bottle is";
    if (state.boundary_edges > 0) {
        kind = "The surface is open (" + count(state.boundary_edges, "boundary edge") + ")";
        if (state.crowded_edges > 0) kind += " and " + crowded;
    } else if (state.crowded_edges > 0) {
        kind = "The surface " + crowded;
    }
    const Turned outward = turn_patches_outward(mesh, patch, TriangleTree(mesh));
    if (outward.turned > 0)
        notes.push_back("Turned " + count(outward.turned, "triangle") + " that showed " +
                        (outward.turned == 1 ? "its" : "their") + " inner side.");
    if (outward.hidden > 0)
        notes.push_back("Left out " + count(outward.hidden, "triangle") + " of walls within the solid.");
    if (outward.filled_cavity) notes.emplace_back("An inner cavity was filled, as its wall is too open.");
    return closed_by_winding_numbers(std::move(mesh), kind, file, options, std::move(notes));
}

Solid closed_by_winding_numbers(TriangleMesh mesh, const std::string& what, const std::filesystem::path& file,
                                const SolidifyOptions& options, std::vector<std::string> notes, double spacing) {
    const Box3 box = bounding_box(mesh.points);
    const double h = box.longest_side() / options.cells;
    const Lattice lattice = lattice_around(box, h, 0.0);
    smooth_if_noisy(mesh, box.diagonal(), options, notes);
    notes.push_back(what + "; the inside was found by generalised winding numbers.");
    const std::vector<float> distance = distance_to_triangles(mesh, lattice, 3.0);
    const TriangleTree tree(mesh);
    TriangleMesh rebuilt = rebuilt_open(tree, lattice, distance);
    if (rebuilt.triangles.empty()) return finished_solid(std::move(rebuilt), file, options, std::move(notes));
    // New is what lies away from all triangles, and the back that a one-sided sheet would need. Single triangles of a
    // noisy surface face anywhere, so several are asked.
    const double near = least_gap(h, spacing);
    const auto is_new = [&](const Piece& piece, double& gap) {
        const double far = 2.0 * box.diagonal();
        gap = tree.nearest(piece.centre, far).distance;
        if (gap > near) return true;
        Vector3 facing{};
        for (int side = 0; side < 6; ++side) {
            Vector3 x = piece.centre;
            x[side / 2] += side % 2 == 0 ? h : -h;
            const Vector3 n = tree.nearest(x, far).area_vector;
            if (norm(n) > 0) facing = facing + (1.0 / norm(n)) * n;
        }
        return dot(facing, piece.normal) < -0.3 * norm(facing);
    };
    judge_new_surface(new_surface(rebuilt, is_new), box.diagonal(), file, options, notes);
    // What closes a hole goes on from its rim without an edge. Away from holes the rebuilt points lie on the triangles.
    std::vector<char> is_new_point = pull_to_surface(rebuilt, tree, h);
    if (const std::size_t flat = flatten_lids(rebuilt, is_new_point, tree, h + spacing, box.diagonal()); flat > 0) {
        notes.push_back(count(flat, "wide opening") + (flat == 1 ? " was" : " were") + " closed flat.");
    }
    fair(rebuilt, is_new_point);
    return finished_solid(std::move(rebuilt), file, options, std::move(notes));
}

}  // namespace morphodesic::datasets
