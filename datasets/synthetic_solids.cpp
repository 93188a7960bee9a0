#include "datasets/synthetic_solids.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <stdexcept>

#include "datasets/collection_folder.h"
#include "datasets/csv_rows.h"
#include "datasets/lattice.h"
#include "datasets/random_source.h"
#include "datasets/solidify.h"
#include "datasets/vdb_files.h"
#include "datasets/voxelize.h"

namespace morphodesic::datasets {
namespace {

/// Segment with radii at its ends, squeezed along the axes.
struct Cone {
    Vector3 a, b;
    double radius_a, radius_b;
    Vector3 squeeze{1.0, 1.0, 1.0};  ///< about the middle of the segment; (1, 1, 0.5) is half as high
};

double distance_to(const Cone& cone, Vector3 x) {
    const Vector3 middle = 0.5 * (cone.a + cone.b);
    Vector3 a, b;
    double smallest = 1.0;
    for (int i = 0; i < 3; ++i) {
        x[i] = (x[i] - middle[i]) / cone.squeeze[i];
        a[i] = (cone.a[i] - middle[i]) / cone.squeeze[i];
        b[i] = (cone.b[i] - middle[i]) / cone.squeeze[i];
        smallest = std::min(smallest, cone.squeeze[i]);
    }
    const Vector3 d = b - a;
    const double length2 = dot(d, d);
    const double t = length2 > 0 ? std::clamp(dot(x - a, d) / length2, 0.0, 1.0) : 0.0;
    return smallest * (norm(x - (a + t * d)) - ((1.0 - t) * cone.radius_a + t * cone.radius_b));
}

/// Minimum with a rounding of about the given width (Quilez).
double smooth_min(double a, double b, double width) {
    const double h = std::max(width - std::abs(a - b), 0.0) / width;
    return std::min(a, b) - 0.25 * width * h * h;
}

struct Sculpture {
    std::vector<Cone> added, removed;
    double rounding = 1.0;  ///< of the joints
    double edge = 0.0;      ///< rounding of the cuts, which are
    bool stands = false;    ///< flat at z = 0
    double top = 1e9;       ///< and at this height
    [[nodiscard]] double distance(const Vector3& x) const {
        double d = 1e9;
        for (const auto& c : added) d = smooth_min(d, distance_to(c, x), rounding);
        for (const auto& c : removed) d = -smooth_min(-d, distance_to(c, x), rounding);
        if (stands) d = -smooth_min(-d, x[2], edge);
        return top < 1e9 ? -smooth_min(-d, top - x[2], 2.0 * edge) : d;
    }
};

TriangleMesh carved(const Sculpture& sculpture, int cells) {
    std::vector<Vector3> corners;
    for (const auto& c : sculpture.added) {
        for (const auto& [p, r] : {std::pair{c.a, c.radius_a}, std::pair{c.b, c.radius_b}}) {
            const double reach = r * std::max({c.squeeze[0], c.squeeze[1], c.squeeze[2], 1.0}) + sculpture.rounding;
            corners.push_back(p - Vector3{reach, reach, reach});
            corners.push_back(p + Vector3{reach, reach, reach});
        }
    }
    const Box3 box = bounding_box(corners);
    const Lattice lattice = lattice_around(box, box.longest_side() / cells, 0.0);
    std::vector<float> values(lattice.node_count());
    // Blocks that the surface cannot pass get one value: the distance changes by less than twice the way.
    constexpr int block = 4;
    const double half = 0.5 * block * lattice.spacing, reach = 2.0 * std::sqrt(3.0) * half;
    const int nx = lattice.nodes[0], ny = lattice.nodes[1], nz = lattice.nodes[2];  // clang 14 captures no bindings
    tbb::parallel_for(0, (nz + block - 1) / block, [&](int layer) {
        const int k0 = layer * block, k1 = std::min(nz, k0 + block);
        for (int j0 = 0; j0 < ny; j0 += block) {
            for (int i0 = 0; i0 < nx; i0 += block) {
                const double middle = sculpture.distance(lattice.position(i0, j0, k0) + Vector3{half, half, half});
                const bool is_far = std::abs(middle) > reach;
                for (int k = k0; k < k1; ++k) {
                    for (int j = j0; j < std::min(ny, j0 + block); ++j) {
                        for (int i = i0; i < std::min(nx, i0 + block); ++i) {
                            const double d = is_far ? middle : sculpture.distance(lattice.position(i, j, k));
                            values[lattice.index(i, j, k)] = static_cast<float>(-d);
                        }
                    }
                }
            }
        }
    });
    TriangleMesh mesh = isosurface(lattice, values);
    clean(mesh);
    return mesh;
}

void check(const CollectionOptions& options) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
}

std::string text(double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.4g", value);
    return buffer;
}
std::string numbered(const char* word, int n) {
    char buffer[48];
    std::snprintf(buffer, sizeof buffer, "%s-%03d", word, n);
    return buffer;
}

struct Foot {
    double length = 250, width = 95, arch = 0.5, instep = 65, toes = 1.0;
};

Sculpture foot_sculpture(const Foot& f) {
    const double l = f.length, w = f.width, ball = 0.36 * w;  // ball: half the width of the forefoot without flesh
    Sculpture s;
    s.rounding = 0.08 * l;
    s.edge = 0.5 * s.rounding;
    s.stands = true;
    s.top = 0.24 * l + 0.9 * f.instep;
    s.added = {
        {{0.12 * l, 0, 0.11 * l}, {0.16 * l, 0, 0.10 * l}, 0.30 * w, 0.30 * w},                   // heel
        {{0.20 * l, 0, 0.16 * l}, {0.19 * l, 0, 0.20 * l + 0.9 * f.instep}, 0.31 * w, 0.34 * w},  // ankle and leg
        {{0.15 * l, 0.10 * w, 0.06 * l}, {0.66 * l, 0.26 * w, 0.07 * l}, 0.22 * w, 0.20 * w},     // outer edge
        {{0.26 * l, -0.02 * w, 0.6 * f.instep + 0.07 * l},
         {0.70 * l, -0.14 * w, 0.09 * l},
         0.30 * w,
         0.22 * w},                                                                       // instep
        {{0.70 * l, -ball, 0.085 * l}, {0.64 * l, ball, 0.075 * l}, 0.16 * w, 0.14 * w},  // ball
    };
    const std::array<double, 5> reach{0.93, 0.925, 0.89, 0.85, 0.80}, thick{0.125, 0.085, 0.08, 0.075, 0.075};
    for (int t = 0; t < 5; ++t) {
        const double y = (-0.34 + 0.17 * t) * w;
        const double end = 0.7 * l + f.toes * (reach[t] - 0.7) * l;
        s.added.push_back(
            {{0.68 * l - 0.015 * l * t, 0.9 * y, 0.08 * l}, {end, 1.05 * y, 0.055 * l}, 0.11 * w, thick[t] * w});
    }
    // The arch: a hollow under the inner edge.
    s.removed = {{{0.28 * l, -0.62 * w, -0.06 * l + 0.02 * l * f.arch},
                  {0.56 * l, -0.66 * w, -0.06 * l + 0.02 * l * f.arch},
                  (0.26 + 0.30 * f.arch) * w,
                  (0.26 + 0.30 * f.arch) * w}};
    return s;
}

}  // namespace

std::vector<GeneratedSolid> feet(const FeetOptions& options) {
    check(options);
    constexpr int cells = 190;  // some 38,000 points, as many as clean scans of feet have
    RandomSource random(options.seed);
    const double mean_volume = options.equal_volume ? signed_volume(carved(foot_sculpture({}), cells)) : 0.0;
    std::vector<GeneratedSolid> result;
    for (int i = 0; i < options.count; ++i) {
        const double v = options.variation;
        Foot foot;
        foot.length *= 1.0 + 0.12 * v * random.uniform(-1, 1);
        foot.width *= 1.0 + 0.12 * v * random.uniform(-1, 1);
        foot.arch = std::clamp(0.5 + 0.5 * v * random.uniform(-1, 1), 0.0, 1.0);
        foot.instep *= 1.0 + 0.2 * v * random.uniform(-1, 1);
        foot.toes *= 1.0 + 0.15 * v * random.uniform(-1, 1);
        GeneratedSolid solid;
        solid.name = numbered("foot", i + 1);
        solid.label = foot.arch < 1.0 / 3.0 ? "flat" : foot.arch > 2.0 / 3.0 ? "high" : "normal";
        if (i + 1 == options.count && options.count >= 3) {
            foot = {170, 120, 1.0, 100, 0.75};
            solid.label = "outlier";
        }
        solid.mesh = carved(foot_sculpture(foot), cells);
        double scale = 1.0;
        if (options.equal_volume) {
            scale = std::cbrt(mean_volume / signed_volume(solid.mesh));
            for (auto& p : solid.mesh.points) p = scale * p;
        }
        solid.parameters = {{"length", text(scale * foot.length)},
                            {"width", text(scale * foot.width)},
                            {"arch", text(foot.arch)},
                            {"instep", text(scale * foot.instep)},
                            {"toes", text(foot.toes)},
                            {"volume", text(signed_volume(solid.mesh))}};
        result.push_back(std::move(solid));
    }
    return result;
}

namespace {

struct Animal {
    bool is_lion = false;
    double size = 1.0, stride = 0.0, head_turn = 0.0, tail = 0.0;  ///< angles in radians
};

Sculpture animal_sculpture(const Animal& a) {
    const double s = a.size * (a.is_lion ? 1.35 : 1.0);
    const bool lion = a.is_lion;
    Sculpture m;
    m.rounding = 28 * s;
    const double hip = 250 * s, thick = lion ? 1.15 : 1.0;
    const auto at = [&](double x, double y, double z) { return Vector3{x * s, y * s, z * s}; };
    m.added.push_back(
        {at(-150, 0, 262), at(140, 0, lion ? 285 : 268), 66 * s * thick, 74 * s * thick, {1.0, 0.85, 1.0}});
    const Vector3 neck = at(205, 0, 325);
    const Vector3 head =
        at((lion ? 205 : 215) + 60 * std::cos(a.head_turn), 60 * std::sin(a.head_turn), lion ? 362 : 365);
    const Vector3 look{std::cos(a.head_turn), std::sin(a.head_turn), -0.15}, across{-look[1], look[0], 0.0};
    m.added.push_back({at(130, 0, 285), neck, 60 * s, 48 * s});
    m.added.push_back({neck, head, 46 * s, (lion ? 60 : 54) * s});
    m.added.push_back(
        {head, head + ((lion ? 62 : 42) * s) * look, (lion ? 44 : 40) * s, (lion ? 32 : 24) * s});  // muzzle
    for (const double side : {-1.0, 1.0}) {
        const Vector3 root = head + (side * 34 * s) * across + Vector3{0, 0, 36 * s};
        const Vector3 tip = root + (side * 12 * s) * across + Vector3{0, 0, (lion ? 14 : 40) * s};
        m.added.push_back({root, tip, (lion ? 17 : 18) * s, (lion ? 15 : 6) * s});
    }
    if (lion) {
        m.added.push_back({at(165, 0, 310), at(200, 0, 335), 84 * s, 84 * s, {0.62, 1.0, 1.05}});
        m.added.push_back({at(180, 0, 280), at(180, 0, 245), 62 * s, 44 * s, {0.7, 0.9, 1.0}});
    }
    // Legs: diagonal pairs swing together; knees bend a little backwards.
    for (int leg = 0; leg < 4; ++leg) {
        const bool front = leg < 2;
        const double side = leg % 2 ? 1.0 : -1.0;
        const double swing = a.stride * (front == (leg % 2 == 0) ? 1.0 : -1.0);
        const Vector3 top = at(front ? 135 : -150, 46 * side * thick, front ? 235 : 240);
        const double half = 0.5 * (hip - 28 * s) * 0.98;
        const double upper = swing + (front ? -0.08 : 0.25), lower = swing + (front ? 0.06 : -0.22);
        const Vector3 knee = top + half * Vector3{std::sin(upper), 0, -std::cos(upper)};
        const Vector3 paw = knee + half * Vector3{std::sin(lower), 0, -std::cos(lower)};
        m.added.push_back({top, knee, (front ? 40 : 50) * s * thick, 27 * s * thick});
        m.added.push_back({knee, paw, 26 * s * thick, 21 * s * thick});
        m.added.push_back({paw, paw + Vector3{26 * s, 0, -2 * s}, 24 * s * thick, 19 * s * thick});
    }
    Vector3 p = at(-205, 0, 295);
    constexpr int pieces = 5;
    for (int i = 0; i < pieces; ++i) {
        const double angle = -0.9 + a.tail * (0.4 + 0.35 * i) + 0.12 * i;
        const Vector3 q = p + (52 * s) * Vector3{-std::cos(angle), 0.0, std::sin(angle)};
        m.added.push_back({p, q, (21 - 2 * i) * s, (19 - 2 * i) * s});
        p = q;
    }
    if (lion) m.added.push_back({p, p + Vector3{-22 * s, 0, -6 * s}, 24 * s, 15 * s});
    return m;
}

}  // namespace

std::vector<GeneratedSolid> quadrupeds(const CollectionOptions& options) {
    check(options);
    RandomSource random(options.seed);
    constexpr std::array<const char*, 4> poses{"stand", "walk", "look", "tail"};
    std::vector<GeneratedSolid> result;
    for (int i = 0; i < options.count; ++i) {
        const int pose = i / 2 % 4;
        const double v = options.variation;
        Animal animal;
        animal.is_lion = i % 2 == 1;
        animal.size = 1.0 + 0.1 * v * random.uniform(-1, 1);
        animal.stride = v * (pose == 1 ? 0.38 : 0.0) + 0.06 * v * random.uniform(-1, 1);
        animal.head_turn = v * (pose == 2 ? 0.7 : 0.0) + 0.1 * v * random.uniform(-1, 1);
        animal.tail = v * (pose == 3 ? 1.1 : 0.1) + 0.15 * v * random.uniform(-1, 1);
        GeneratedSolid solid;
        solid.label = animal.is_lion ? "lion" : "cat";
        solid.name = numbered(solid.label.c_str(), i / 2 + 1);
        solid.mesh = carved(animal_sculpture(animal), 110);
        solid.parameters = {{"pose", poses[pose]},           {"size", text(animal.size)},
                            {"stride", text(animal.stride)}, {"head_turn", text(animal.head_turn)},
                            {"tail", text(animal.tail)},     {"volume", text(signed_volume(solid.mesh))}};
        result.push_back(std::move(solid));
    }
    return result;
}

void write_collection(const std::filesystem::path& folder, const std::vector<GeneratedSolid>& solids) {
    std::set<std::string> names;
    for (const auto& solid : solids) names.insert(solid.name + ".ply");
    prepare_collection_folder(folder, names);
    std::string labels = "file,label\n", parameters;
    for (const auto& solid : solids) {
        write_ply(folder / (solid.name + ".ply"), solid.mesh);
        labels += csv_field(solid.name + ".ply") + "," + csv_field(solid.label) + "\n";
        if (parameters.empty()) {
            parameters = "file";
            for (const auto& [name, value] : solid.parameters) parameters += "," + csv_field(name);
            parameters += "\n";
        }
        parameters += csv_field(solid.name + ".ply");
        for (const auto& [name, value] : solid.parameters) parameters += "," + csv_field(value);
        parameters += "\n";
    }
    write_text_file(folder / "labels.csv", labels);
    write_text_file(folder / "parameters.csv", parameters);
}

namespace {

/// Triangles in order of their distance from a random one, until their area reaches the wanted one.
std::vector<int> random_patch(const TriangleMesh& mesh, double wanted_area, RandomSource& random) {
    const auto start = static_cast<std::size_t>(random.uniform(0, static_cast<double>(mesh.triangles.size())));
    const Vector3 centre = mesh.corners(std::min(start, mesh.triangles.size() - 1))[0];
    std::vector<std::pair<double, int>> order;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vector3 r = mesh.corners(t)[0] - centre;
        order.emplace_back(dot(r, r), static_cast<int>(t));
    }
    std::sort(order.begin(), order.end());
    std::vector<int> patch;
    double area = 0.0;
    for (const auto& [distance, t] : order) {
        if (area >= wanted_area) break;
        patch.push_back(t);
        area += 0.5 * norm(area_vector(mesh.corners(t)));
    }
    return patch;
}

/// Merges points that share a cell of a grid into their mean.
/// @param places  of the points, by which they are sorted into cells: where they were before noise moved them
TriangleMesh clustered(const TriangleMesh& mesh, const std::vector<Vector3>& places, double cell) {
    TriangleMesh result;
    std::map<std::array<long, 3>, int> number;
    std::vector<int> merged, members;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        std::array<long, 3> key;
        for (int a = 0; a < 3; ++a) key[a] = std::lround(std::floor(places[i][a] / cell));
        const auto [it, is_new] = number.try_emplace(key, static_cast<int>(result.points.size()));
        if (is_new) result.points.push_back({0, 0, 0}), members.push_back(0);
        result.points[it->second] = result.points[it->second] + mesh.points[i];
        ++members[it->second];
        merged.push_back(it->second);
    }
    for (std::size_t i = 0; i < members.size(); ++i) result.points[i] = (1.0 / members[i]) * result.points[i];
    for (const auto& t : mesh.triangles) result.triangles.push_back({merged[t[0]], merged[t[1]], merged[t[2]]});
    clean(result);
    return result;
}

/// Cuts each triangle into four.
TriangleMesh halved(const TriangleMesh& mesh) {
    TriangleMesh result{mesh.points, {}};
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
        const auto [it, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<int>(result.points.size()));
        if (is_new) result.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));
        return it->second;
    };
    for (const auto& [a, b, c] : mesh.triangles) {
        const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        result.triangles.insert(result.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    return result;
}

}  // namespace

TriangleMesh damaged(const TriangleMesh& mesh, const DamageOptions& options) {
    RandomSource random(options.seed);
    const double diagonal = bounding_box(mesh.points).diagonal();
    const TriangleMesh dense = halved(mesh);
    TriangleMesh noisy = dense;
    for (auto& p : noisy.points) {
        for (double& x : p) {
            double sum = 0.0;  // of twelve uniform numbers: close to a normal distribution of variance 1
            for (int i = 0; i < 12; ++i) sum += random.uniform(-0.5, 0.5);
            x += options.noise * diagonal * sum;
        }
    }
    TriangleMesh result = noisy;
    if (options.kept < 1.0) {
        double cell = 1e-3 * diagonal;
        const double wanted = options.kept * static_cast<double>(noisy.points.size());
        while (static_cast<double>(result.points.size()) > wanted && cell < 0.1 * diagonal) {
            result = clustered(noisy, dense.points, cell);
            cell *= 1.1;
        }
    }
    const double area = surface_area(result);
    for (int i = 0; i < 4 && options.turned > 0; ++i) {
        for (const int t : random_patch(result, options.turned * area / 4, random)) {
            std::swap(result.triangles[t][0], result.triangles[t][1]);
        }
    }
    for (int i = 0; i < 5 && options.holes > 0; ++i) {
        std::vector<int> hole = random_patch(result, options.holes * area / 5, random);
        std::sort(hole.rbegin(), hole.rend());
        for (const int t : hole) result.triangles.erase(result.triangles.begin() + t);
    }
    clean(result);
    return result;
}

}  // namespace morphodesic::datasets
