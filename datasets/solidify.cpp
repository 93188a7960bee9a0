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

#include "datasets/distance_transform.h"
#include "datasets/interruption.h"
#include "datasets/mesh_smoothing.h"
#include "datasets/open_surface.h"
#include "datasets/point_closing.h"
#include "datasets/read_error.h"
#include "datasets/strays.h"
#include "datasets/touching_parts.h"
#include "datasets/triangle_tree.h"
#include "datasets/voxelize.h"
#include "datasets/winding_number.h"

namespace morphodesic::datasets {
namespace {

constexpr double rough = 3e-4;             // of the diagonal: less noise moves no distance by a measurable amount
constexpr double most_correlated = 0.25;   // of bumps about half of whose variance is noise
constexpr double least_bump = 0.1;         // of the noise: independent errors make bumps of 0.7 of it
constexpr double largest_new_share = 0.3;  // of the surface: beyond it the other side of the object is a guess
constexpr double largest_loss = 0.02;      // of the volume: parts that are too thin for the grid stay as they are
constexpr double most_specks = 5.0;        // of the limit for one, together: more are what the object is made of
constexpr double largest_ball = 0.25;      // of the length: a larger one would lie in the object rather than on it
constexpr double deep_inside = 0.03;       // of the size: points there are no noise of the surface
constexpr double least_unused = 0.005;     // of the points: fewer are not worth a note

std::string number(double value, const char* format = "%.3g") {
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    return text;
}
std::string percent(double share) {
    return number(100.0 * share, "%.1f") + " %";
}
std::string count(std::size_t n, const char* noun) {
    return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}
/// One of two things that were counted, or both with "and" between them. @param m, n  how many; not both 0
std::string either_or_both(std::size_t m, const std::string& first, std::size_t n, const std::string& second) {
    return m == 0 ? second : n == 0 ? first : first + " and " + second;
}

void note_strays(const Strays& strays, const char* noun, const char* whole, std::vector<std::string>& notes) {
    if (strays.count == 0) return;
    notes.push_back("Left out " + count(strays.count, noun) + " far from the object (" +
                    number(100.0 * strays.share, "%.2g") + " % of the " + whole + ").");
}

/// Extent along the thinnest direction over the extent along the longest.
double flatness(const std::vector<Vector3>& points) {
    Vector3 mean{};
    for (const auto& p : points) mean = mean + (1.0 / static_cast<double>(points.size())) * p;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const auto& p : points) {
        const Eigen::Vector3d r(p[0] - mean[0], p[1] - mean[1], p[2] - mean[2]);
        covariance += r * r.transpose();
    }
    const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = -low;
    for (const auto& p : points) {
        const Eigen::Vector3d q = axes.transpose() * Eigen::Vector3d(p[0] - mean[0], p[1] - mean[1], p[2] - mean[2]);
        low = low.cwiseMin(q);
        high = high.cwiseMax(q);
    }
    const Eigen::Vector3d extent = high - low;
    return extent.maxCoeff() > 0 ? extent.minCoeff() / extent.maxCoeff() : 0.0;
}

void refuse_flat(const std::vector<Vector3>& points, const std::filesystem::path& file) {
    if (flatness(points) < 1e-5) {
        throw ReadError(file, "the surface is flat (all points lie in one plane), so it encloses no volume",
                        "use a scan of a solid, or draw the outline as an image for a study in 2D");
    }
}

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

/// How much of a rebuilt surface was not in the file, and how far from it that lies.
struct NewSurface {
    double share = 0.0;  ///< of the rebuilt surface
    double gap = 0.0;    ///< twice the largest distance of a new piece from the file's surface
};
/// Area, centre and outward normal of a piece of the rebuilt surface.
struct Piece {
    Vector3 centre, normal;
    double area;
};
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

/// About so many pieces, evenly spread over the triangles.
std::vector<Piece> pieces_of(const TriangleMesh& mesh, std::size_t wanted) {
    std::vector<Piece> result;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += mesh.triangles.size() / wanted + 1) {
        const auto c = mesh.corners(t);
        const Vector3 n = area_vector(c);
        if (norm(n) > 0) result.push_back({(1.0 / 3.0) * (c[0] + c[1] + c[2]), (1.0 / norm(n)) * n, 0.5 * norm(n)});
    }
    return result;
}

/// @param is_new  (piece, out: its distance from what the file has) -> bool
template <class IsNew>
NewSurface new_surface(const TriangleMesh& rebuilt, IsNew&& is_new) {
    const std::vector<Piece> pieces = pieces_of(rebuilt, 6000);
    std::vector<double> gap(pieces.size(), -1.0);
    tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
        interruption_point();
        double distance = 0.0;
        if (is_new(pieces[i], distance)) gap[i] = 2.0 * distance;
    });
    NewSurface result;
    double area = 0.0, new_area = 0.0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        area += pieces[i].area;
        if (gap[i] >= 0) new_area += pieces[i].area, result.gap = std::max(result.gap, gap[i]);
    }
    result.share = area > 0 ? new_area / area : 0.0;
    return result;
}

void judge_new_surface(const NewSurface& made, double size, const std::filesystem::path& file,
                       const SolidifyOptions& options, std::vector<std::string>& notes) {
    if (made.share > largest_new_share && options.close_gaps < 1.0) {
        throw ReadError(file,
                        "the scan shows one side only: closing it would invent " + percent(made.share) +
                            " of the surface (limit " + percent(largest_new_share) + ")",
                        "use a scan from all sides or join the views first; --close-gaps 1 closes it all the same");
    }
    if (made.gap > options.close_gaps * size) {
        throw ReadError(file,
                        "the surface has a hole " + percent(made.gap / size) +
                            " of the object's size wide, more than " + "--close-gaps allows (" +
                            percent(options.close_gaps) + ")",
                        "repair the scan, or raise --close-gaps if the hole may be closed smoothly");
    }
    if (made.share > 0.0005) {
        notes.push_back("Holes were closed: " + percent(made.share) + " of the surface is new, the widest gap is " +
                        percent(made.gap / size) + " of the object's size.");
    }
}

/// Points that are not on the surface that was made of the cloud: whole parts may be too sparse to be closed, and what
/// lies in the middle of a solid may have been the wall of a cavity.
void note_unused_points(const std::vector<Vector3>& points, double far, double size, Solid& solid) {
    const TriangleTree surface(solid.mesh);
    std::atomic<std::size_t> outside = 0, inside = 0;
    const double deep = std::max(far, deep_inside * size);
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        interruption_point(i, 64);
        const double distance = surface.nearest(points[i], deep).distance;
        if (distance < far) return;
        if (surface.winding_number(points[i]) < 0.5) {
            ++outside;
        } else if (distance >= deep) {
            ++inside;
        }
    });
    const auto note = [&](std::size_t number, const char* where, const char* why) {
        const double share = static_cast<double>(number) / static_cast<double>(points.size());
        if (share < least_unused) return;
        solid.notes.push_back(count(number, "point") + " (" + percent(share) + ") " + (number == 1 ? "lies " : "lie ") +
                              where + ": " + why + ".");
    };
    note(outside, "outside of the solid", "too sparse to be closed, or stray");
    note(inside, "deep within the solid", "if they are the wall of a cavity, it was filled");
}

/// Says why no ball up to the widest finds an inside between points, as far as other balls tell.
[[noreturn]] void refuse_points(const std::vector<Vector3>& points, double typical, double widest,
                                const std::filesystem::path& file, const SolidifyOptions& options) {
    const Box3 box = bounding_box(points);
    const double longest = box.longest_side(), size = box.diagonal(), largest = 0.55 * longest;
    // Between two walls a ball that passes through no gap between points leaves a volume, on a single one (almost)
    // none.
    const double area = static_cast<double>(points.size()) * std::numbers::pi / 6.0 * typical * typical;
    const Lattice fine = lattice_around(box, longest / 72, 2.0 * typical);
    const double thickness = 2.0 * closing(fine, distance_to_points(fine, points), 2.0 * typical).volume / area;
    if (thickness > 1.5 * typical && thickness < 10.0 * typical) {
        throw ReadError(file,
                        "the points are too few for so thin a solid: it is about " + percent(thickness / size) +
                            " of its size thick, and between neighbours lie " + percent(typical / size),
                        "use a cloud of several times as many points, or a mesh");
    }
    const Lattice coarse = lattice_around(box, longest / 36, largest);
    const std::vector<float> distance = distance_to_points(coarse, points);
    Closing before = closing(coarse, distance, widest);
    for (double r = widest, next = 1.1 * r; next <= largest; r = next, next = 1.1 * r) {
        Closing after = closing(coarse, distance, next);
        if (before.has_core && after.volume <= 1.2 * before.volume) {
            const std::string opening =
                "the points leave an opening about " + percent(2.0 * r / size) + " of the size wide";
            if (r <= largest_ball * longest) {
                throw ReadError(file, opening + ", more than --close-gaps allows (" + percent(options.close_gaps) + ")",
                                "use points from all sides, or raise --close-gaps");
            }
            throw ReadError(file,
                            opening + "; between points no more than " + percent(2.0 * largest_ball * longest / size) +
                                " can be closed",
                            "add points there (a flat floor will do), or make a mesh of the points: wider holes of "
                            "meshes are closed");
        }
        before = std::move(after);
    }
    throw ReadError(file, "the points enclose no volume (a scan of one side, or one with very wide gaps)",
                    "use points from all sides of the object");
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

    const Turned outward = turn_patches_outward(mesh, patch, TriangleTree(mesh));
    if (outward.turned > 0)
        notes.push_back("Turned " + count(outward.turned, "triangle") + " that showed their inner side.");
    if (outward.hidden > 0)
        notes.push_back("Left out " + count(outward.hidden, "triangle") + " of walls within the solid.");
    if (outward.filled_cavity) notes.emplace_back("An inner cavity was filled, as its wall is too open.");
    smooth_if_noisy(mesh, box.diagonal(), options, notes);
    const std::string crowded = "has " + count(state.crowded_edges, "edge") + " of three or more triangles";
    std::string kind = "The surface is closed but one-sided, as a Klein bottle is";
    if (state.boundary_edges > 0) {
        kind = "The surface is open (" + count(state.boundary_edges, "boundary edge") + ")";
        if (state.crowded_edges > 0) kind += " and " + crowded;
    } else if (state.crowded_edges > 0) {
        kind = "The surface " + crowded;
    }
    notes.push_back(kind + "; the inside was found by generalised winding numbers.");
    const std::vector<float> distance = distance_to_triangles(mesh, lattice, 3.0);
    const TriangleTree tree(mesh);
    TriangleMesh rebuilt = rebuilt_open(tree, lattice, distance);
    if (rebuilt.triangles.empty()) return finished_solid(std::move(rebuilt), file, options, std::move(notes));
    // New is what lies away from all triangles, and the back that a one-sided sheet would need.
    const auto is_new = [&](const Piece& piece, double& gap) {
        const auto nearest = tree.nearest(piece.centre, 2.0 * box.diagonal());
        gap = nearest.distance;
        return nearest.distance > 1.5 * h || dot(nearest.area_vector, piece.normal) < -0.3 * norm(nearest.area_vector);
    };
    judge_new_surface(new_surface(rebuilt, is_new), box.diagonal(), file, options, notes);
    // What closes a hole goes on from its rim without an edge. Away from holes the rebuilt points lie on the triangles.
    const std::vector<char> is_new_point = pull_to_surface(rebuilt, tree, h);
    fair(rebuilt, is_new_point);
    return finished_solid(std::move(rebuilt), file, options, std::move(notes));
}

Solid solid_from_points(std::vector<Vector3> points, const std::filesystem::path& file,
                        const SolidifyOptions& options) {
    TriangleMesh cloud{std::move(points), {}};
    clean(cloud);
    std::vector<std::string> notes;
    if (!cloud.points.empty()) note_strays(leave_out_strays(cloud.points), "stray point", "points", notes);
    if (cloud.points.size() < 50) {
        throw ReadError(file, "only " + count(cloud.points.size(), "different point") + ", too few for a surface",
                        "use a denser point cloud or a mesh");
    }
    refuse_flat(cloud.points, file);
    const std::vector<double> spacings = sorted_spacings(cloud.points);
    const double typical = spacings[spacings.size() / 2];
    const Box3 box = bounding_box(cloud.points);
    const double size = box.diagonal();
    // From the typical gap between points up to the widest that may be closed; the first that holds tight: a ball a
    // quarter larger finds (almost) the same solid, so no leak was left.
    const double longest = box.longest_side();
    const double widest = std::min(0.5 * options.close_gaps * size, largest_ball * longest);
    double radius = 0.0, tight_volume = 0.0;
    {
        const Lattice coarse = lattice_around(box, longest / 72, widest);
        const std::vector<float> distance = distance_to_points(coarse, cloud.points);
        Closing before = closing(coarse, distance, typical);
        for (double r = typical; r <= widest && radius == 0.0;) {
            const double next = 1.25 * r;
            Closing after = closing(coarse, distance, next);
            if (before.has_core && after.volume <= 1.2 * before.volume) radius = r, tight_volume = before.volume;
            before = std::move(after);
            r = next;
        }
    }
    if (radius == 0.0) refuse_points(cloud.points, typical, widest, file, options);
    const double h = std::max(longest / options.cells, radius / 8.0);
    const Lattice lattice = lattice_around(box, h, 2.0 * radius);
    const std::vector<float> distance = distance_to_points(lattice, cloud.points);
    Closing closed = closing(lattice, distance, radius);
    for (int round = 0; round < 5 && closed.volume < 0.85 * tight_volume; ++round) {  // a leak the coarse nodes hid
        radius *= 1.12;
        closed = closing(lattice, distance, radius);
    }
    TriangleMesh rebuilt = isosurface(lattice, closed.values);
    notes.push_back("A cloud of " + count(cloud.points.size(), "point") + "; the inside is what a ball of radius " +
                    percent(radius / size) + " of the object's size cannot reach between them.");
    if (rebuilt.triangles.empty()) return finished_solid(std::move(rebuilt), file, options, std::move(notes));
    const auto is_new = [&](const Piece& piece, double& gap) {
        std::array<int, 3> node;
        for (int a = 0; a < 3; ++a) node[a] = static_cast<int>(std::lround((piece.centre[a] - lattice.origin[a]) / h));
        gap = distance[lattice.index(node[0], node[1], node[2])];
        return gap > 2.0 * typical;
    };
    judge_new_surface(new_surface(rebuilt, is_new), size, file, options, notes);
    Solid solid = finished_solid(std::move(rebuilt), file, options, std::move(notes));
    note_unused_points(cloud.points, 2.0 * radius, size, solid);
    return solid;
}

}  // namespace morphodesic::datasets
