#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "datasets/solidify.h"
#include "datasets/triangle_mesh.h"

/// Meshes of known shape and the files they come in.
namespace morphodesic::tests {

using datasets::TriangleMesh;
using datasets::Vector3;
using datasets::operator+;
using datasets::operator-;
using datasets::operator*;

/// Surfaces are rebuilt on a grid of so many cells: quick, and fine enough for balls.
inline datasets::SolidifyOptions coarse() {
    datasets::SolidifyOptions options;
    options.cells = 64;
    return options;
}

/// The ball of most tests.
inline const Vector3 ball_middle{0.5, 0.5, 0.5};
inline constexpr double ball_radius = 0.3;

/// Sphere by repeated division of an octahedron, seen from outside.
inline TriangleMesh ball_mesh(const Vector3& centre, double radius, int divisions) {
    TriangleMesh mesh{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
    for (int d = 0; d < divisions; ++d) {
        std::map<std::pair<int, int>, int> middle;
        const auto half = [&](int a, int b) {
            const auto [it, is_new] = middle.try_emplace(std::minmax(a, b), static_cast<int>(mesh.points.size()));
            if (is_new) {
                const Vector3 m = mesh.points[a] + mesh.points[b];
                mesh.points.push_back((1.0 / datasets::norm(m)) * m);
            }
            return it->second;
        };
        std::vector<std::array<int, 3>> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const int ab = half(a, b), bc = half(b, c), ca = half(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }
    for (auto& p : mesh.points) p = centre + radius * p;
    return mesh;
}

/// The same surface seen from its other side.
inline TriangleMesh inside_out(TriangleMesh mesh) {
    turn_inside_out(mesh);
    return mesh;
}

inline TriangleMesh box_mesh(const Vector3& low, const Vector3& high) {
    TriangleMesh mesh;
    for (int c = 0; c < 8; ++c) {
        mesh.points.push_back({c & 1 ? high[0] : low[0], c & 2 ? high[1] : low[1], c & 4 ? high[2] : low[2]});
    }
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

/// A box whose faces have divisions x divisions quads, cut into triangles; points on its edges are repeated.
inline TriangleMesh divided_box_mesh(const Vector3& low, const Vector3& high, int divisions) {
    TriangleMesh mesh;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2, u = (axis + 1 + face % 2) % 3, v = (axis + 2 - face % 2) % 3;
        const int first = static_cast<int>(mesh.points.size());
        for (int j = 0; j <= divisions; ++j) {
            for (int i = 0; i <= divisions; ++i) {
                Vector3 p;
                p[axis] = face % 2 ? low[axis] : high[axis];
                p[u] = low[u] + (high[u] - low[u]) * i / divisions;
                p[v] = low[v] + (high[v] - low[v]) * j / divisions;
                mesh.points.push_back(p);
            }
        }
        for (int j = 0; j < divisions; ++j) {
            for (int i = 0; i < divisions; ++i) {
                const int a = first + i + (divisions + 1) * j, b = a + divisions + 1;
                mesh.triangles.push_back({a, a + 1, b + 1});
                mesh.triangles.push_back({a, b + 1, b});
            }
        }
    }
    return mesh;
}

inline TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
    const int first = static_cast<int>(a.points.size());
    a.points.insert(a.points.end(), b.points.begin(), b.points.end());
    for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return a;
}

inline std::string obj_text(const TriangleMesh& mesh) {
    std::ostringstream out;
    out.precision(17);
    for (const auto& p : mesh.points) out << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    for (const auto& t : mesh.triangles) out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    return out.str();
}

inline std::string off_text(const TriangleMesh& mesh) {
    std::ostringstream out;
    out.precision(17);
    out << "OFF\n" << mesh.points.size() << ' ' << mesh.triangles.size() << " 0\n";
    for (const auto& p : mesh.points) out << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    for (const auto& t : mesh.triangles) out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
    return out.str();
}

inline std::string ascii_stl(const TriangleMesh& mesh, int digits = 9) {
    std::ostringstream out;
    out.precision(digits);
    out << "solid test\n";
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        out << "facet normal 0 0 0\n outer loop\n";
        for (const auto& p : mesh.corners(t)) out << "  vertex " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
        out << " endloop\nendfacet\n";
    }
    out << "endsolid test\n";
    return out.str();
}

template <class T>
void put(std::string& to, T value, bool swapped = false) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    if (swapped) std::reverse(bytes, bytes + sizeof value);
    to.append(bytes, sizeof value);
}

inline std::string binary_stl(const TriangleMesh& mesh) {
    std::string out(80, '\0');
    out.replace(0, 5, "solid");  // as many programs write it, against the rules
    put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (int i = 0; i < 3; ++i) put(out, 0.0F);
        for (const auto& p : mesh.corners(t)) {
            for (const double x : p) put(out, static_cast<float>(x));
        }
        put(out, std::uint16_t{0});
    }
    return out;
}

inline std::string ply_file(const TriangleMesh& mesh, const std::string& format) {
    std::ostringstream head;
    head.precision(9);
    head << "ply\nformat " << format << " 1.0\ncomment made by a test\nelement vertex " << mesh.points.size()
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n";
    if (!mesh.triangles.empty()) {
        head << "element face " << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\n";
    }
    head << "end_header\n";
    if (format == "ascii") {
        for (const auto& p : mesh.points) head << p[0] << ' ' << p[1] << ' ' << p[2] << " 7\n";
        for (const auto& t : mesh.triangles) head << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
        return head.str();
    }
    const bool swapped = format == "binary_big_endian";
    std::string out = head.str();
    for (const auto& p : mesh.points) {
        for (const double x : p) put(out, static_cast<float>(x), swapped);
        put(out, std::uint8_t{7});
    }
    for (const auto& t : mesh.triangles) {
        put(out, std::uint8_t{3});
        for (const int c : t) put(out, static_cast<std::int32_t>(c), swapped);
    }
    return out;
}

/// A folder of its own for each test, removed at its end.
class FileFolder {
public:
    FileFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "morphodesic-solids-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
        path_ = name;
    }
    ~FileFolder() {
        std::error_code error;
        std::filesystem::remove_all(path_, error);
    }
    FileFolder(const FileFolder&) = delete;
    FileFolder& operator=(const FileFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    std::filesystem::path write(const std::string& name, const std::string& content) const {
        std::ofstream(path_ / name, std::ios::binary) << content;
        return path_ / name;
    }

private:
    std::filesystem::path path_;
};

}  // namespace morphodesic::tests
