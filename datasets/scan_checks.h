#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "datasets/solidify.h"
#include "datasets/strays.h"
#include "datasets/triangle_mesh.h"

/// What scans are refused for, whether they are meshes or points, and the notes on what was not in the file.
namespace morphodesic::datasets {

/// @throws ReadError if all points lie in one plane
void refuse_flat(const std::vector<Vector3>& points, const std::filesystem::path& file);

/// Says how much was left out far from the object, if anything was.
void note_strays(const Strays& strays, const char* noun, const char* whole, std::vector<std::string>& notes);

/// Area, centre and outward normal of a piece of the rebuilt surface.
struct Piece {
    Vector3 centre, normal;
    double area;
};

/// How much of a rebuilt surface was not in the file, and how far from it that lies.
struct NewSurface {
    double share = 0.0;  ///< of the rebuilt surface
    double gap = 0.0;    ///< twice the largest distance of a new piece from the file's surface
};
/// Measures it on a few thousand pieces of the rebuilt surface.
/// @param is_new  (piece, out: its distance from what the file has) -> bool; called by several threads
NewSurface new_surface(const TriangleMesh& rebuilt, const std::function<bool(const Piece&, double&)>& is_new);

/// From this distance to what the file has on, a piece of a rebuilt surface is new.
/// @param cell     of the grid that it was rebuilt on
/// @param spacing  of the points of a cloud: where they lie a little farther apart nothing is missing; 0 of a mesh
double least_gap(double cell, double spacing);

/// Notes how much is new.
/// @throws ReadError if it is more than may be made up, or a gap is wider than may be closed
void judge_new_surface(const NewSurface& made, double size, const std::filesystem::path& file,
                       const SolidifyOptions& options, std::vector<std::string>& notes);

}  // namespace morphodesic::datasets
