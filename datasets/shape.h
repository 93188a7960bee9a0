#pragma once

#include <string>
#include <vector>

#include "geodesic/grid/fields.h"

namespace morphodesic::datasets {

/// A shape ready for geodesics: normalised into the unit cube and sampled on a dyadic grid.
template <int Dim>
struct Shape {
    std::string name;   ///< path of the file relative to the collection's folder, with '/'
    std::string label;  ///< class label; empty if unknown
    std::string
        digest;  ///< hexadecimal content digest of the level set (and mask): equal exactly if the shapes are equal
    LevelSet<Dim> level_set;          ///< signed distance, > 0 inside, in units of the cube
    ScalarField<Dim> occlusion_mask;  ///< chi in [0,1], 0 where the shape is unknown; empty values: known everywhere
    double volume = 0.0;              ///< area (volume) of the object in units of the cube
    double fullness = 0.0;            ///< see fullness() of geodesic/grid/measures.h
    double scale = 1.0;               ///< file units (pixels, mm, ...) times scale = units of the cube
    std::vector<std::string> notes;   ///< what was done to the input and a user should know, one sentence each
};

}  // namespace morphodesic::datasets
