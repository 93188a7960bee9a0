#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/lattice.h"
#include "datasets/triangle_mesh.h"

namespace morphodesic::datasets {

struct SolidifyOptions {
    double close_gaps = 0.6;        ///< widest hole that is closed, as a share of the diagonal of the bounding box;
                                    ///< from 1 on also one-sided scans are closed, >= 0
    double speck_fraction = 0.002;  ///< smaller parts and cavities are removed, unless five times that together; [0, 1)
    bool smooth_noise = true;       ///< surfaces with noise are smoothed
    int cells = 144;                ///< along the longest side of the box in which damaged surfaces are rebuilt, >= 16
};

/// What a file's surface encloses.
struct Solid {
    TriangleMesh mesh;    ///< closed, without self-intersections wider than a cell, seen from outside
    double volume = 0.0;  ///< > 0
    Vector3 centroid{};
    std::vector<std::string> notes;  ///< what was done, one sentence each
    TriangleMesh drawn;              ///< triangles between the points of a cloud; none if they were not joined
    double spacing = 0.0;            ///< typical one of these points
};

/// From triangles in any state to a solid.
/// Closed surfaces without overlaps are taken as they are (turned right side out). Closed surfaces that pass through
/// themselves are united by their exact winding numbers, those of parts that touch face to face are joined. Open or
/// non-manifold ones get neighbouring triangles to agree in orientation, then each patch turned so that its front sees
/// more of the open air (Takayama et al. 2014); the inside is where the generalised winding number exceeds 1/2. United
/// and closed surfaces are rebuilt on a grid of options.cells cells, and what closes a hole is bent like a thin plate
/// held by its rim, or flat over a flat cut (flat_lids.h). Surfaces with noise above 0.03 % of the object's size are
/// smoothed before: noise is roughness that does not hang together from point to point. Stray pieces far from the
/// object are left out first of all (strays.h).
/// @param file  for messages
/// @throws ReadError if nothing is enclosed (flat, one-sided, empty)
Solid solid_from_triangles(TriangleMesh mesh, const std::filesystem::path& file, const SolidifyOptions& options = {});

/// The route of open, non-manifold and one-sided surfaces whose patches face outward already.
/// @param what     a note begins with it: what the surface is like
/// @param spacing  of the points of a cloud, 0 of a mesh
/// @throws ReadError if nothing is enclosed, or too much would be made up
Solid closed_by_winding_numbers(TriangleMesh mesh, const std::string& what, const std::filesystem::path& file,
                                const SolidifyOptions& options, std::vector<std::string> notes, double spacing = 0.0);

/// From points spread over a surface to a solid: neighbours are joined to triangles (point_surface.h), which are closed
/// as scans are. Where the points lie on no surface, or thin parts fall to pieces, morphological closing: the inside is
/// what a ball that fits through no gap between the points cannot reach from outside (point_closing.h).
/// @throws ReadError if nothing is enclosed, too much would be made up or there are too few points
Solid solid_from_points(std::vector<Vector3> points, const std::filesystem::path& file,
                        const SolidifyOptions& options = {});

/// Nodes around a box, with some spare cells on each side.
Lattice lattice_around(const Box3& box, double spacing, double margin);

/// Removes specks, checks what is left and measures it: the last step of every route, also of volumes.
/// @throws ReadError if no volume is enclosed
Solid finished_solid(TriangleMesh closed_mesh, const std::filesystem::path& file, const SolidifyOptions& options,
                     std::vector<std::string> notes);

}  // namespace morphodesic::datasets
