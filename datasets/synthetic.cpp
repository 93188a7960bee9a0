#include "datasets/synthetic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "datasets/random_source.h"

namespace morphodesic::datasets {

namespace {

using std::numbers::pi;

std::string decimal(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

/// "bar-07": as many digits as the collection needs.
std::string numbered(const std::string& stem, int i, int count) {
    const std::string number = std::to_string(i + 1);
    const std::size_t digits = std::max<std::size_t>(2, std::to_string(count).size());
    return stem + "-" + std::string(digits - std::min(digits, number.size()), '0') + number;
}

void require_usable(const CollectionOptions& options) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
}

/// i-th of `count` equidistant numbers in [0, 1].
double fraction(int i, int count) {
    return count > 1 ? double(i) / (count - 1) : 0.0;
}

/// Turns polygons around the middle of the picture and moves them.
void move(std::vector<Loop>& polygons, double angle, const Point<2>& shift) {
    const double c = std::cos(angle), s = std::sin(angle);
    for (Loop& loop : polygons) {
        for (Point<2>& p : loop) {
            const double x = p[0] - 0.5, y = p[1] - 0.5;
            p = {0.5 + c * x - s * y + shift[0], 0.5 + s * x + c * y + shift[1]};
        }
    }
}

void move_at_random(std::vector<Loop>& polygons, RandomSource& random, double turn, double shift) {
    const double angle = random.uniform(-turn, turn), dx = random.uniform(-shift, shift),
                 dy = random.uniform(-shift, shift);
    move(polygons, angle, {dx, dy});
}

struct Person {
    const char* name;
    double head, torso, arm, leg, thickness;  // head: radius; arm and leg: one of two equal parts
};

/// Angles in degrees against "hanging straight down", to the figure's left (our right) positive, then the bend at the
/// elbow or knee.
struct Pose {
    const char* name;
    std::array<double, 4> arms, legs;  // right upper, right bend, left upper, left bend
};

constexpr std::array<Person, 3> persons = {{{"adult", 0.060, 0.20, 0.105, 0.135, 0.022},
                                            {"child", 0.060, 0.14, 0.085, 0.085, 0.020},
                                            {"giant", 0.055, 0.25, 0.130, 0.150, 0.033}}};
constexpr std::array<Pose, 5> poses = {{{"stand", {-38, 8, 38, -8}, {-16, 0, 16, 0}},
                                        {"wave", {-38, 8, 100, 55}, {-16, 0, 16, 0}},
                                        {"walk", {-60, 25, 50, 30}, {-32, -20, 32, -5}},
                                        {"cheer", {-118, -12, 118, 12}, {-26, 0, 26, 0}},
                                        {"sit", {-60, 10, 60, 30}, {-75, 70, 75, -70}}}};

Point<2> beyond(const Point<2>& from, double degrees, double length) {
    const double angle = degrees * pi / 180.0;
    return {from[0] + length * std::sin(angle), from[1] - length * std::cos(angle)};
}

void add_limb(std::vector<Loop>& polygons, const Point<2>& root, double angle, double bend, double part,
              double radius) {
    const Point<2> joint = beyond(root, angle, part), tip = beyond(joint, angle + bend, part);
    polygons.push_back(capsule_polygon(root, joint, radius));
    polygons.push_back(capsule_polygon(joint, tip, radius));
}

}  // namespace

std::vector<std::string> CollectionOptions::problems() const {
    std::vector<std::string> result;
    if (count < 1 || count > 100000) result.push_back("count must be from 1 to 100000");
    if (!(variation >= 0.0 && variation <= 1.0)) result.push_back("variation must be from 0 to 1");
    return result;
}

Loop bent_bar(const Point<2>& centre, double length, double width, double bend) {
    if (!(bend >= 0.0 && bend < 2.0 * pi)) throw std::invalid_argument("the bend of a bar must be in [0, 2 pi)");
    constexpr int along = 256, around = 64;
    const double radius = 0.5 * width;
    // The arc curves upwards: direction bend (t - 1/2) at parameter t in [0, 1].
    const auto middle = [&](double t) -> Point<2> {
        const double s = (t - 0.5) * length, a = bend * (t - 0.5);
        const double half = 0.5 * a, sinc = std::abs(half) < 1e-9 ? 1.0 : std::sin(half) / half;
        return {centre[0] + s * sinc * std::cos(half), centre[1] + s * sinc * std::sin(half)};
    };
    Loop loop;
    const auto add = [&](const Point<2>& p, double angle) {
        loop.push_back({p[0] + radius * std::cos(angle), p[1] + radius * std::sin(angle)});
    };
    for (int i = 0; i < along; ++i) add(middle(double(i) / along), bend * (double(i) / along - 0.5) - 0.5 * pi);
    for (int i = 0; i < around; ++i) add(middle(1.0), 0.5 * bend - 0.5 * pi + pi * i / around);
    for (int i = along; i > 0; --i) add(middle(double(i) / along), bend * (double(i) / along - 0.5) + 0.5 * pi);
    for (int i = 0; i < around; ++i) add(middle(0.0), -0.5 * bend + 0.5 * pi + pi * i / around);
    return loop;
}

std::vector<Drawing> bars(const CollectionOptions& options) {
    require_usable(options);
    RandomSource random(options.seed);
    std::vector<Drawing> result;
    for (int i = 0; i < options.count; ++i) {
        const double degrees = 306.0 * options.variation * fraction(i, options.count);
        Drawing& drawing = result.emplace_back();
        drawing.name = numbered("bar", i, options.count);
        drawing.label = degrees < 60.0 ? "straight" : degrees < 180.0 ? "bent" : "rolled";
        drawing.parameters = {{"bend_degrees", decimal(degrees)}};
        drawing.polygons = {bent_bar({0.5, 0.5}, 0.7, 0.08, degrees * pi / 180.0)};
        move_at_random(drawing.polygons, random, 0.25 * options.variation, 0.02);
    }
    return result;
}

std::vector<Drawing> dumbbells(const CollectionOptions& options) {
    require_usable(options);
    RandomSource random(options.seed);
    std::vector<Drawing> result;
    for (int i = 0; i < options.count; ++i) {
        const double ratio = 1.0 + 2.0 * options.variation * fraction(i, options.count);
        const double large = 0.24 * ratio / (1.0 + ratio), small = 0.24 / (1.0 + ratio);
        const Point<2> left{0.28, 0.5}, right{0.72, 0.5};
        Drawing& drawing = result.emplace_back();
        drawing.name = numbered("dumbbell", i, options.count);
        drawing.label = ratio < 1.5 ? "even" : ratio < 2.2 ? "uneven" : "lopsided";
        drawing.parameters = {
            {"radius_ratio", decimal(ratio)}, {"large_radius", decimal(large)}, {"small_radius", decimal(small)}};
        drawing.polygons = {disk_polygon(left, large), disk_polygon(right, small), capsule_polygon(left, right, 0.035)};
        move_at_random(drawing.polygons, random, 0.25 * options.variation, 0.02);
    }
    return result;
}

std::vector<Drawing> disks(const CollectionOptions& options) {
    require_usable(options);
    RandomSource random(options.seed);
    std::vector<Drawing> result;
    for (int i = 0; i < options.count; ++i) {
        const double position = fraction(i, options.count) - 0.5;
        const double radius = 0.2 + 0.2 * options.variation * (options.count > 1 ? position : 0.0);
        Drawing& drawing = result.emplace_back();
        drawing.name = numbered("disk", i, options.count);
        drawing.label = radius < 0.2 - 0.1 / 3.0 ? "small" : radius < 0.2 + 0.1 / 3.0 ? "medium" : "large";
        drawing.parameters = {{"radius", decimal(radius)}};
        drawing.polygons = {disk_polygon({0.5, 0.5}, radius, 1024)};
        move_at_random(drawing.polygons, random, 0.0, 0.05);
    }
    return result;
}

std::vector<Drawing> matchstick(const CollectionOptions& options) {
    require_usable(options);
    RandomSource random(options.seed);
    const int kinds = static_cast<int>(persons.size() * poses.size());
    std::vector<Drawing> result;
    for (int i = 0; i < options.count; ++i) {
        const Person& person = persons[static_cast<std::size_t>(i) % persons.size()];
        const Pose& pose = poses[static_cast<std::size_t>(i) / persons.size() % poses.size()];
        const auto jittered = [&](double degrees) {
            return degrees + 8.0 * options.variation * random.uniform(-1.0, 1.0);
        };
        const double radius = person.thickness;
        const Point<2> hip{0.5, 0.42}, neck{0.5, 0.42 + person.torso}, shoulder{0.5, 0.42 + person.torso - radius};
        Drawing& drawing = result.emplace_back();
        drawing.label = std::string(person.name) + "_" + pose.name;
        drawing.name = numbered(drawing.label, i / kinds, (options.count + kinds - 1) / kinds);
        drawing.parameters = {{"person", person.name}, {"pose", pose.name}};
        drawing.polygons = {capsule_polygon(hip, neck, 1.2 * radius),
                            disk_polygon({0.5, neck[1] + 0.9 * person.head + radius}, person.head)};
        for (const bool legs : {false, true}) {
            const std::array<double, 4>& angles = legs ? pose.legs : pose.arms;
            for (const std::size_t side : {0U, 2U}) {
                const double upper = jittered(angles[side]), bend = jittered(angles[side + 1]);
                add_limb(drawing.polygons, legs ? hip : shoulder, upper, bend, legs ? person.leg : person.arm, radius);
                const std::string limb = std::string(side == 0 ? "right_" : "left_") + (legs ? "leg" : "arm");
                drawing.parameters.emplace_back(limb + "_degrees", decimal(upper));
                drawing.parameters.emplace_back(limb + "_bend_degrees", decimal(bend));
            }
        }
    }
    return result;
}

template <int Dim>
LevelSet<Dim> ball(const DyadicGrid<Dim>& grid, const Point<Dim>& centre, double radius) {
    LevelSet<Dim> u(grid);
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const Point<Dim> x = grid.position(grid.node(i));
        double squared = 0.0;
        for (int a = 0; a < Dim; ++a) squared += (x[a] - centre[a]) * (x[a] - centre[a]);
        u.values[i] = radius - std::sqrt(squared);
    }
    return u;
}

template <int Dim>
LevelSet<Dim> box(const DyadicGrid<Dim>& grid, const Point<Dim>& centre, const Point<Dim>& half_sides) {
    LevelSet<Dim> u(grid);
    for (std::size_t i = 0; i < u.values.size(); ++i) {
        const Point<Dim> x = grid.position(grid.node(i));
        double squared = 0.0, nearest = -1e300;
        for (int a = 0; a < Dim; ++a) {
            const double beyond_side = std::abs(x[a] - centre[a]) - half_sides[a];
            nearest = std::max(nearest, beyond_side);
            squared += std::max(beyond_side, 0.0) * std::max(beyond_side, 0.0);
        }
        u.values[i] = nearest <= 0.0 ? -nearest : -std::sqrt(squared);
    }
    return u;
}

template LevelSet<2> ball<2>(const DyadicGrid<2>&, const Point<2>&, double);
template LevelSet<3> ball<3>(const DyadicGrid<3>&, const Point<3>&, double);
template LevelSet<2> box<2>(const DyadicGrid<2>&, const Point<2>&, const Point<2>&);
template LevelSet<3> box<3>(const DyadicGrid<3>&, const Point<3>&, const Point<3>&);

}  // namespace morphodesic::datasets
