#pragma once

#include <vector>

#include "geodesic/grid/dyadic_grid.h"

namespace morphodesic::pipeline {

/// A place on the globe, degrees.
struct GeographicPosition {
    double latitude = 0.0, longitude = 0.0;
};

/// Stereographic projection of the unit sphere from the point opposite to `centre` onto the plane; `centre` goes to the
/// origin, north is up there.
class StereographicMap {
public:
    explicit StereographicMap(const GeographicPosition& centre);

    [[nodiscard]] Point<2> to_plane(const Point<3>& x) const;   ///< of a point of the unit sphere
    [[nodiscard]] Point<3> to_sphere(const Point<2>& p) const;  ///< inverse of to_plane
    [[nodiscard]] Point<3> frame(const Point<3>& x) const;      ///< x in coordinates east, north, up of the centre
    [[nodiscard]] static Point<3> sphere(const GeographicPosition& at);

private:
    Point<3> east_, north_, up_;
};

/// A discrete geodesic in the plane of the projection, with what it took to get there.
struct SpherePath {
    std::vector<Point<2>> points;    ///< x_0 .. x_K in the plane
    long relaxation_steps = 0;       ///< elementary minimisations, one vertex each
    double energy = 0.0;             ///< K sum_k |x_k - x_{k-1}|^2, distances on the sphere along the chord
    double length = 0.0;             ///< of the path with great circles between the points, radians
    double largest_deviation = 0.0;  ///< largest distance of a point from its place k/K on the great circle, radians
};

/// When a relaxation ends; lengths on the sphere, radians.
struct RelaxationStop {
    enum class Measure {
        move,      ///< no vertex moves by more in a sweep; says little where many small moves add up
        distance,  ///< no vertex is farther from its place in the exact discrete geodesic, k/K on the great circle
    };
    Measure measure = Measure::move;
    double tolerance = 1e-6;
};

/// Nonlinear Gauss-Seidel: vertex after vertex is put where the sum of the squared distances to its two neighbours is
/// least, the others fixed, by one Newton step in the coordinates of the plane, halved until it lowers the sum.
/// @param points  start x_0 .. x_K; the ends stay
SpherePath relax(const StereographicMap& map, std::vector<Point<2>> points, const RelaxationStop& stop);

/// All K at once from the straight line in the map.
SpherePath single_level_geodesic(const StereographicMap& map, const Point<2>& a, const Point<2>& b, int steps,
                                 const RelaxationStop& stop);

/// K = 1, 2, 4, ..., steps: each path starts from the one before with points put in the middle (on the map). One entry
/// per K; relaxation_steps of an entry are those of its own level. A stop by distance is K / steps times as strict on
/// the coarse levels: exactness is cheap there and handed on.
std::vector<SpherePath> cascadic_geodesics(const StereographicMap& map, const Point<2>& a, const Point<2>& b, int steps,
                                           const RelaxationStop& stop);

/// Angle between two points of the unit sphere, radians.
double great_circle_distance(const Point<3>& a, const Point<3>& b);

/// Point at the share t of the way on the great circle from a to b.
Point<3> great_circle_point(const Point<3>& a, const Point<3>& b, double t);

}  // namespace morphodesic::pipeline
