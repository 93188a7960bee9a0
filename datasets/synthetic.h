#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datasets/drawing.h"
#include "geodesic/grid/fields.h"

/// Shapes from formulas and fonts: demos, tests, benchmarks. Pictures of one collection share one scale. The same
/// options always give the same pictures (for letters: as long as the same fonts are installed).
namespace morphodesic::datasets {

struct CollectionOptions {
    int count = 24;          ///< shapes in total, >= 1
    double variation = 1.0;  ///< how varied, in [0, 1]: share of the full range of every parameter
    std::uint64_t seed = 1;  ///< of the random part (turns, places, jitter)

    [[nodiscard]] std::vector<std::string> problems() const;  ///< every violated constraint; empty if usable
};

struct LettersOptions : CollectionOptions {
    std::string characters = "ABMX";           ///< UTF-8; every character is a class
    std::vector<std::filesystem::path> fonts;  ///< font files; empty: all installed fonts that have the characters
};

/// Letters in turn from every font (from some of them if there are more fonts than rounds), with random turn, slant,
/// stroke width and size.
/// @throws ReadError if a font cannot be read or lacks a character, or if no font is installed
std::vector<Drawing> letters(const LettersOptions& options);

/// Text fonts below the usual folders that have all the characters as outlines, no hairlines, sorted by path.
std::vector<std::filesystem::path> installed_fonts(const std::string& characters);

/// Bars of one length and width, from straight to rolled up (bend angle 0 to 306 degrees times the variation); classes
/// straight, bent (from 60 degrees), rolled (from 180 degrees). Place and turn are random.
std::vector<Drawing> bars(const CollectionOptions& options);

/// Two disks joined by a bar; the ratio of their radii runs from 1 to 3 (variation 1) with the sum kept; classes even,
/// uneven (from ratio 1.5), lopsided (from 2.2). Place and turn are random.
std::vector<Drawing> dumbbells(const CollectionOptions& options);

/// Disks with radii from 0.1 to 0.3 (variation 1) of the picture; classes small, medium, large. Places are random.
/// Their distances are known: sqrt(pi (2 lambda + 2 mu)) |r1 - r0|.
std::vector<Drawing> disks(const CollectionOptions& options);

/// Matchstick men: persons (adult, child, giant, differing in proportions) in poses (stand, wave, walk, cheer, sit),
/// with random limb angles around each pose; the class is person_pose.
std::vector<Drawing> matchstick(const CollectionOptions& options);

/// Exact signed distance of a ball, > 0 inside.
template <int Dim>
LevelSet<Dim> ball(const DyadicGrid<Dim>& grid, const Point<Dim>& centre, double radius);

/// Exact signed distance of a box with sides along the axes, > 0 inside.
template <int Dim>
LevelSet<Dim> box(const DyadicGrid<Dim>& grid, const Point<Dim>& centre, const Point<Dim>& half_sides);

/// Bar with round ends, its middle line a circular arc of the given length that turns by `bend` radians (0 <= bend < 2
/// pi); the middle of the arc lies in `centre` and runs along x.
Loop bent_bar(const Point<2>& centre, double length, double width, double bend);

}  // namespace morphodesic::datasets
