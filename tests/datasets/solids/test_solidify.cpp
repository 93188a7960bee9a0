#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>
#include <random>

#include "datasets/read_error.h"
#include "datasets/solidify.h"
#include "datasets/triangle_tree.h"
#include "datasets/voxelize.h"
#include "datasets/winding_number.h"
#include "tests/datasets/solids/solid_files.h"

namespace morphodesic::datasets {
namespace {

using namespace tests;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

using std::numbers::pi;
const double ball_volume = 4.0 / 3.0 * pi * std::pow(ball_radius, 3);

/// Largest distance of the solid's surface from the sphere.
double distance_from_sphere(const Solid& solid) {
    double largest = 0.0;
    for (const auto& p : solid.mesh.points) largest = std::max(largest, std::abs(norm(p - ball_middle) - ball_radius));
    return largest;
}

/// Rebuilding cell of the ball.
const double coarse_cell = 2.0 * ball_radius / coarse().cells;

TEST(SignedDistance, BallMeetsTheClosedForm) {
    const TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 6);
    const DyadicGrid<3> grid(5);
    const LevelSet<3> u = signed_distance(ball, grid);
    double near = 0.0, far = 0.0;
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const double exact = ball_radius - norm(grid.position(grid.node(i)) - ball_middle);
        const double error = std::abs(u.values[i] - exact) / grid.spacing();
        (std::abs(exact) < 4 * grid.spacing() ? near : far) =
            std::max(std::abs(exact) < 4 * grid.spacing() ? near : far, error);
    }
    EXPECT_LT(near, 0.004);  // facets instead of a sphere: (pi / 128)^2 0.3 / 2 / h
    EXPECT_LT(far, 0.2);
}

TEST(SignedDistance, BoxIsExactAlsoFarAway) {
    const Vector3 low{0.2, 0.3, 0.4}, high{0.7, 0.8, 0.6};
    const DyadicGrid<3> grid(5);
    const LevelSet<3> u = signed_distance(box_mesh(low, high), grid);
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const Vector3 x = grid.position(grid.node(i));
        Vector3 outside{};
        double inside = 1.0;
        for (int a = 0; a < 3; ++a) {
            outside[a] = std::max({low[a] - x[a], x[a] - high[a], 0.0});
            inside = std::min({inside, x[a] - low[a], high[a] - x[a]});
        }
        EXPECT_NEAR(u.values[i], norm(outside) > 0 ? -norm(outside) : inside, 0.2 * grid.spacing());
    }
}

TEST(WindingNumber, AgreesWithTheExactCountOfRows) {
    const TriangleMesh two = joined(ball_mesh(ball_middle, 0.3, 4), ball_mesh({0.7, 0.5, 0.5}, 0.2, 4));
    const Lattice lattice{{17, 17, 17}, {0.013, 0.017, 0.011}, 0.06};
    const auto exact = winding_numbers(two, lattice);
    const TriangleTree fast(two);
    int twice = 0;
    for (int k = 0; k < 17; ++k) {
        for (int j = 0; j < 17; ++j) {
            for (int i = 0; i < 17; ++i) {
                EXPECT_NEAR(fast.winding_number(lattice.position(i, j, k)), exact[lattice.index(i, j, k)], 0.06);
                twice += exact[lattice.index(i, j, k)] == 2;
            }
        }
    }
    EXPECT_GT(twice, 10);
}

TEST(Solidify, ClosedMeshIsTakenAsItIs) {
    const TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 5);
    const Solid solid = solid_from_triangles(ball, "ball", coarse());
    EXPECT_EQ(solid.mesh.triangles.size(), ball.triangles.size());
    EXPECT_NEAR(solid.volume, ball_volume, 2e-3 * ball_volume);
    EXPECT_LT(norm(solid.centroid - ball_middle), 1e-12);
    EXPECT_TRUE(solid.notes.empty());
}

TEST(Solidify, InsideOutIsTurned) {
    const TriangleMesh ball = inside_out(ball_mesh(ball_middle, ball_radius, 4));
    const Solid solid = solid_from_triangles(ball, "ball", coarse());
    EXPECT_GT(solid.volume, 0.99 * ball_volume);
    EXPECT_THAT(solid.notes, Contains(HasSubstr("inside out")));
}

TEST(Solidify, TurnedTrianglesAgreeAgain) {
    TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 4);
    for (std::size_t t = 0; t < ball.triangles.size(); t += 3) std::swap(ball.triangles[t][0], ball.triangles[t][1]);
    const Solid solid = solid_from_triangles(ball, "ball", coarse());
    EXPECT_GT(solid.volume, 0.99 * ball_volume);
    EXPECT_THAT(solid.notes, Contains(HasSubstr("to agree with the neighbours")));
}

TEST(Solidify, HolesAreClosed) {
    TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 5);
    std::erase_if(ball.triangles,
                  [&](const auto& t) { return ball.points[t[0]][2] > ball_middle[2] + 0.9 * ball_radius; });
    const Solid solid = solid_from_triangles(ball, "ball", coarse());
    // A cap of a tenth of the radius is missing; the lid is bent, though less than the sphere.
    const double cap = pi * std::pow(0.1 * ball_radius, 2) * (ball_radius - 0.1 * ball_radius / 3.0);
    EXPECT_GT(solid.volume, ball_volume - 0.8 * cap);
    EXPECT_LT(solid.volume, ball_volume);
    EXPECT_TRUE(topology(solid.mesh).closed());
    EXPECT_THAT(solid.notes, Contains(HasSubstr("Holes were closed")));
    SolidifyOptions strict = coarse();
    strict.close_gaps = 0.05;
    EXPECT_THROW(solid_from_triangles(ball, "ball", strict), ReadError);
}

TEST(Solidify, CracksAndLooseTrianglesDoNoHarm) {
    const TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 4);
    TriangleMesh soup;  // every triangle on its own, a little apart from the others, every other one turned
    for (std::size_t t = 0; t < ball.triangles.size(); ++t) {
        const auto c = ball.corners(t);
        const Vector3 centre = (1.0 / 3.0) * (c[0] + c[1] + c[2]);
        const int first = static_cast<int>(soup.points.size());
        for (const auto& p : c) soup.points.push_back(p + 1e-4 * (centre - p));
        soup.triangles.push_back({first, first + 1, first + 2});
        if (t % 2 == 1) std::swap(soup.triangles.back()[0], soup.triangles.back()[1]);
    }
    const Solid solid = solid_from_triangles(soup, "soup", coarse());
    EXPECT_NEAR(solid.volume, ball_volume, 0.01 * ball_volume);
    EXPECT_LT(distance_from_sphere(solid), coarse_cell);
}

TEST(Solidify, OverlappingPartsAreUnited) {
    // Two balls of radius r whose centres are r apart: the lens in common is 5/12 pi r^3.
    const TriangleMesh two = joined(ball_mesh(ball_middle, ball_radius, 5), ball_mesh({0.8, 0.5, 0.5}, ball_radius, 5));
    const Solid solid = solid_from_triangles(two, "two", coarse());
    EXPECT_NEAR(solid.volume, 2.0 * ball_volume - 5.0 / 12.0 * pi * std::pow(ball_radius, 3), 0.008 * ball_volume);
    EXPECT_THAT(solid.notes, Contains(HasSubstr("united")));
    EXPECT_EQ(patches(solid.mesh, true).count, 1);
}

TEST(Solidify, HollowObjectsStayHollow) {
    const TriangleMesh inner = inside_out(ball_mesh(ball_middle, 0.2, 4));
    const Solid solid = solid_from_triangles(joined(ball_mesh(ball_middle, ball_radius, 5), inner), "shell", coarse());
    EXPECT_NEAR(solid.volume, 4.0 / 3.0 * pi * (std::pow(ball_radius, 3) - 0.008), 0.01 * ball_volume);
    const LevelSet<3> u = signed_distance(solid.mesh, DyadicGrid<3>(4));
    EXPECT_LT(u.values[u.grid.index({8, 8, 8})], -0.15);
    EXPECT_THAT(solid.notes, Contains(HasSubstr("hollow")));
}

TEST(Solidify, UnitingKeepsCavities) {
    const TriangleMesh inner = inside_out(ball_mesh(ball_middle, 0.2, 4));
    const TriangleMesh hollow = joined(ball_mesh(ball_middle, ball_radius, 5), inner);
    const TriangleMesh knob = ball_mesh({0.82, 0.5, 0.5}, 0.1, 4);  // reaches into the wall, not through it
    const Solid solid = solid_from_triangles(joined(hollow, knob), "hollow", coarse());
    const Solid full = solid_from_triangles(joined(ball_mesh(ball_middle, ball_radius, 5), knob), "full", coarse());
    EXPECT_NEAR(full.volume - solid.volume, 4.0 / 3.0 * pi * 0.008, 0.01 * ball_volume);
    EXPECT_THAT(solid.notes, Contains(HasSubstr("hollow")));
    EXPECT_THAT(solid.notes, Not(Contains(HasSubstr("inside out"))));
    // A part that is inside out is turned all the same.
    const TriangleMesh turned = inside_out(knob);
    const Solid put_right =
        solid_from_triangles(joined(ball_mesh(ball_middle, ball_radius, 5), turned), "turned", coarse());
    EXPECT_NEAR(put_right.volume, full.volume, 1e-6 * full.volume);
    EXPECT_THAT(put_right.notes, Contains(HasSubstr("inside out")));
}

/// Nodes of the lattice lie exactly on the walls within.
TEST(Solidify, BoxesThatOverlapBecomeOneWithoutCracks) {
    TriangleMesh chain;
    for (int i = 0; i < 4; ++i) {
        const double x = 8.0 * i;
        chain = joined(chain, box_mesh({x, 0, 0}, {x + 12.0, 12, 12}));
    }
    const Solid bar = solid_from_triangles(chain, "chain");
    EXPECT_EQ(patches(bar.mesh, true).count, 1);
    EXPECT_NEAR(bar.volume, 36.0 * 12 * 12, 0.005 * 36 * 12 * 12);
    EXPECT_THAT(bar.notes, testing::ElementsAre(HasSubstr("united")));
    const TriangleMesh nested = joined(box_mesh({0, 0, 0}, {36, 36, 36}), box_mesh({12, 12, 12}, {24, 24, 24}));
    const Solid cube = solid_from_triangles(nested, "nested");
    EXPECT_EQ(patches(cube.mesh, true).count, 1);
    EXPECT_NEAR(cube.volume, 36.0 * 36 * 36, 0.005 * 36 * 36 * 36);
    EXPECT_THAT(cube.notes, testing::ElementsAre(HasSubstr("or parts of it lie within others")));
}

TEST(Solidify, SharesOfThePartsDoNotExceedTheWhole) {
    const TriangleMesh inner = inside_out(ball_mesh(ball_middle, 0.25, 4));
    const TriangleMesh nest =
        joined(joined(ball_mesh(ball_middle, ball_radius, 5), inner), ball_mesh(ball_middle, 0.15, 4));
    const Solid solid = solid_from_triangles(nest, "nest", coarse());
    EXPECT_THAT(solid.notes, Contains(HasSubstr("2 separate parts; the largest holds 88.")));  // 27 / (27 + 3.375)
}

TEST(Solidify, NonManifoldMeshes) {
    // A wall through the middle of a box: its edges have three triangles each.
    TriangleMesh walled = box_mesh({0.2, 0.2, 0.2}, {0.5, 0.8, 0.8});
    const TriangleMesh right = box_mesh({0.5, 0.2, 0.2}, {0.8, 0.8, 0.8});
    walled = joined(walled, right);
    const Solid solid = solid_from_triangles(walled, "walled", coarse());
    EXPECT_NEAR(solid.volume, 0.216, 0.003);
    EXPECT_EQ(patches(solid.mesh, true).count, 1);
}

TEST(Solidify, KleinBottleIsNotCalledOpen) {
    constexpr int n = 60;
    TriangleMesh bottle;
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {  // a figure of eight that makes half a turn on its way around a circle
            const double u = 2.0 * pi * i / n, v = 2.0 * pi * j / n;
            const double r = 2.0 + std::cos(u / 2) * std::sin(v) - std::sin(u / 2) * std::sin(2 * v);
            bottle.points.push_back(
                {r * std::cos(u), r * std::sin(u), std::sin(u / 2) * std::sin(v) + std::cos(u / 2) * std::sin(2 * v)});
        }
    }
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const auto at = [&](int k, int l) {  // beyond the last the figure of eight goes on turned over
                return k < n ? k + n * (l % n) : n * ((2 * n - l) % n);
            };
            bottle.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            bottle.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    const Solid solid = solid_from_triangles(bottle, "bottle", coarse());
    EXPECT_THAT(solid.notes, Contains(HasSubstr("one-sided")));
    EXPECT_THAT(solid.notes, Not(Contains(HasSubstr("open"))));
}

TEST(Solidify, FlatAndOneSidedScansAreRefused) {
    TriangleMesh flat, bump;
    const int n = 40;
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i) {
            const double x = i / 40.0, y = j / 40.0;
            flat.points.push_back({x, y, 0.3 * x});
            bump.points.push_back({x, y, 0.2 * std::exp(-20.0 * ((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5)))});
        }
    }
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const int a = i + (n + 1) * j;
            flat.triangles.push_back({a, a + 1, a + n + 2});
            flat.triangles.push_back({a, a + n + 2, a + n + 1});
        }
    }
    bump.triangles = flat.triangles;
    const auto refusal = [](const auto& attempt) -> std::string {
        try {
            attempt();
        } catch (const ReadError& error) {
            return error.problem();
        }
        return "accepted";
    };
    EXPECT_THAT(refusal([&] { solid_from_triangles(flat, "flat", coarse()); }), HasSubstr("flat"));
    EXPECT_THAT(refusal([&] { solid_from_triangles(bump, "bump", coarse()); }), HasSubstr("one side"));
    EXPECT_THAT(refusal([&] { solid_from_points(flat.points, "flat", coarse()); }), HasSubstr("flat"));
    EXPECT_THAT(refusal([&] { solid_from_points(bump.points, "bump", coarse()); }), HasSubstr("one side only"));
    EXPECT_THAT(refusal([&] {
                    solid_from_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 1}}, "few", coarse());
                }),
                HasSubstr("too few"));
}

/// Triangles of a noisy surface face anywhere; that is no reason to think that the other side is missing.
TEST(Solidify, NoiseMakesNoHoles) {
    TriangleMesh scan = ball_mesh(ball_middle, ball_radius, 6);
    std::erase_if(scan.triangles,
                  [&](const auto& t) { return scan.points[t[0]][2] > ball_middle[2] + 0.9 * ball_radius; });
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0.0, 0.005);
    for (auto& p : scan.points) {
        for (double& x : p) x += noise(random);
    }
    const Solid solid = solid_from_triangles(scan, "scan");
    double share = 0.0;
    for (const std::string& note : solid.notes) std::sscanf(note.c_str(), "Holes were closed: %lf", &share);
    EXPECT_GT(share, 3.0);
    EXPECT_LT(share, 7.0);  // in truth 5 %
}

/// Every tenth triangle is split at the middle of a side, its neighbour is not: no gap, no noise.
TEST(Solidify, CornersOnTheSidesOfNeighboursAreNoNoise) {
    SolidifyOptions options;
    options.cells = 24;
    for (std::size_t first = 0; first < 10; ++first) {
        for (std::size_t side = 0; side < 3; ++side) {
            TriangleMesh box = divided_box_mesh({0, 0, 0}, {1, 1, 1}, 10);
            const std::size_t count = box.triangles.size();
            for (std::size_t t = first; t < count; t += 10) {
                const std::array<int, 3> corner = box.triangles[t];
                const int a = corner[side], b = corner[(side + 1) % 3], c = corner[(side + 2) % 3];
                const int between = static_cast<int>(box.points.size());
                box.points.push_back(0.5 * (box.points[a] + box.points[b]));
                box.triangles[t] = {a, between, c};
                box.triangles.push_back({between, b, c});
            }
            EXPECT_THAT(solid_from_triangles(box, "box", options).notes, Not(Contains(HasSubstr("smoothed"))))
                << first << " " << side;
        }
    }
}

/// As of an object that stood on a floor, in any direction: no dome over it.
TEST(Solidify, FlatCutsAreClosedFlat) {
    TriangleMesh box = divided_box_mesh({0, 0, 0}, {1, 0.7, 0.4}, 40);
    std::erase_if(box.triangles, [&](const auto& t) {
        return box.points[t[0]][2] + box.points[t[1]][2] + box.points[t[2]][2] > 3 * 0.4 - 1e-9;
    });
    for (auto& p : box.points) p = {0.8 * p[0] - 0.6 * p[2], p[1], 0.6 * p[0] + 0.8 * p[2]};
    const Solid open = solid_from_triangles(box, "box");
    EXPECT_NEAR(open.volume, 0.28, 0.015 * 0.28);  // a dome would be a third too much
    EXPECT_THAT(open.notes, Contains(HasSubstr("1 wide opening was closed flat")));
    EXPECT_TRUE(topology(open.mesh).closed());

    std::vector<Vector3> points;
    std::mt19937 random(2);
    std::uniform_real_distribution<double> share;
    while (points.size() < 8000) {  // five faces of the same box, evenly
        Vector3 p{share(random), 0.7 * share(random), 0.4 * share(random)};
        const double face = (0.7 + 0.4 * 0.7 * 2 + 0.4 * 2) * share(random);
        if (face < 0.7)
            p[2] = 0.0;
        else if (face < 0.7 + 0.56)
            p[0] = face < 0.7 + 0.28 ? 0.0 : 1.0;
        else
            p[1] = face < 0.7 + 0.56 + 0.4 ? 0.0 : 0.7;
        points.push_back(p);
    }
    EXPECT_NEAR(solid_from_points(points, "cloud").volume, 0.28, 0.03 * 0.28);
}

/// Walls that lean over the opening go on round.
TEST(Solidify, OpeningsThatCloseAlreadyGoOnRound) {
    TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 5);
    std::erase_if(ball.triangles,
                  [&](const auto& t) { return ball.points[t[0]][2] > ball_middle[2] + 0.7 * ball_radius; });
    const Solid solid = solid_from_triangles(ball, "ball", coarse());
    EXPECT_NEAR(solid.volume, ball_volume, 0.02 * ball_volume);
    EXPECT_THAT(solid.notes, Not(Contains(HasSubstr("flat"))));
}

TEST(Solidify, PointCloudOfABall) {
    const TriangleMesh ball = ball_mesh(ball_middle, ball_radius, 4);
    const Solid solid = solid_from_points(ball.points, "cloud", coarse());
    EXPECT_NEAR(solid.volume, ball_volume, 0.015 * ball_volume);
    EXPECT_LT(norm(solid.centroid - ball_middle), 0.003);
    EXPECT_TRUE(topology(solid.mesh).closed());
}

TEST(Solidify, PointsThatNoSolidHasAreSaid) {
    const std::vector<Vector3> ball = ball_mesh(ball_middle, ball_radius, 5).points;
    const auto notes_with = [&](const TriangleMesh& other) {
        std::vector<Vector3> points = ball;
        points.insert(points.end(), other.points.begin(), other.points.end());
        return solid_from_points(points, "cloud", coarse()).notes;
    };
    EXPECT_THAT(solid_from_points(ball, "ball", coarse()).notes, testing::SizeIs(1));
    TriangleMesh wire;
    for (int i = 0; i < 66; ++i)
        wire.points.push_back({0.9, 0.5 + 0.1 * std::cos(0.1 * i), 0.5 + 0.1 * std::sin(0.1 * i)});
    EXPECT_THAT(notes_with(wire), Contains(HasSubstr("66 points (1.6 %) lie outside")));
    EXPECT_THAT(notes_with(ball_mesh(ball_middle, 0.15, 4)),
                Contains(HasSubstr("1026 points (20.0 %) lie deep within")));
}

TEST(Solidify, CloudsThatCannotBeClosedAreToldApart) {
    const auto refusal = [](std::vector<Vector3> points, const SolidifyOptions& options) -> std::string {
        try {
            solid_from_points(std::move(points), "cloud", options);
        } catch (const ReadError& error) {
            return error.what();
        }
        return "accepted";
    };
    // An opening that only the option forbids.
    std::vector<Vector3> holed = ball_mesh(ball_middle, ball_radius, 5).points;
    std::erase_if(holed, [](const Vector3& p) { return p[2] < ball_middle[2] - 0.92 * ball_radius; });
    SolidifyOptions strict = coarse();
    strict.close_gaps = 0.12;
    EXPECT_THAT(refusal(holed, strict), HasSubstr("raise --close-gaps"));
    // A plate whose thickness is no more than a few distances between points.
    std::vector<Vector3> plate;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> share;
    for (int i = 0; i < 22000; ++i) {
        Vector3 p{100 * share(random), 100 * share(random), share(random)};
        if (i < 20000) p[2] = i % 2;
        if (i >= 20000) p[i % 2] = i / 2 % 2 * 100;
        plate.push_back(p);
    }
    EXPECT_THAT(refusal(plate, coarse()), HasSubstr("too few for so thin"));
}

TEST(Solidify, SpecksAreRemoved) {
    const TriangleMesh two = joined(ball_mesh(ball_middle, ball_radius, 4), ball_mesh({0.9, 0.9, 0.9}, 0.02, 2));
    const Solid solid = solid_from_triangles(two, "speck", coarse());
    EXPECT_EQ(patches(solid.mesh, true).count, 1);
    EXPECT_THAT(solid.notes, Contains("Removed 1 speck, together 0.027 % of the volume."));
    // Of any size that is asked for.
    SolidifyOptions generous = coarse();
    generous.speck_fraction = 0.05;
    const TriangleMesh larger = joined(ball_mesh(ball_middle, ball_radius, 4), ball_mesh({0.9, 0.9, 0.9}, 0.1, 3));
    EXPECT_EQ(patches(solid_from_triangles(larger, "part", coarse()).mesh, true).count, 2);
    const Solid alone = solid_from_triangles(larger, "speck", generous);
    EXPECT_EQ(patches(alone.mesh, true).count, 1);
    EXPECT_THAT(alone.notes, Contains(HasSubstr("Removed 1 speck, together 3.5 % of the volume.")));
}

TEST(Solidify, ManySmallPartsAreNoSpecks) {
    TriangleMesh balls, ball_and_balls = ball_mesh({-0.6, 0.5, 0.5}, 0.4, 4);
    for (int i = 0; i < 600; ++i) {  // each of 0.17 % of all, or 0.012 % of the large one
        const TriangleMesh ball = ball_mesh({0.1 * (i % 10), 0.1 * (i / 10 % 10), 0.1 * (i / 100)}, 0.02, 1);
        balls = joined(balls, ball);
        ball_and_balls = joined(ball_and_balls, ball);
    }
    const Solid alone = solid_from_triangles(balls, "balls");
    EXPECT_NEAR(alone.volume, signed_volume(balls), 1e-9);
    EXPECT_THAT(alone.notes, testing::ElementsAre(HasSubstr("600 separate parts; the largest holds 0.2 %")));
    const Solid beside = solid_from_triangles(ball_and_balls, "ball and balls");
    EXPECT_NEAR(beside.volume, signed_volume(ball_and_balls), 1e-9);
    EXPECT_THAT(beside.notes, testing::ElementsAre(HasSubstr("601 separate parts")));
}

}  // namespace
}  // namespace morphodesic::datasets
