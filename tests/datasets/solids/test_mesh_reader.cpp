#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <numbers>

#include "datasets/mesh_reader.h"
#include "datasets/read_error.h"
#include "tests/datasets/solids/solid_files.h"

namespace morphodesic::datasets {
namespace {

using namespace tests;
using testing::HasSubstr;

const TriangleMesh box = box_mesh({0.25, 0.25, 0.25}, {0.75, 0.5, 1.0});

std::map<std::string, std::string> all_formats(const TriangleMesh& mesh) {
    return {{"a.obj", obj_text(mesh)},
            {"a.off", off_text(mesh)},
            {"text.stl", ascii_stl(mesh)},
            {"binary.stl", binary_stl(mesh)},
            {"text.ply", ply_file(mesh, "ascii")},
            {"little.ply", ply_file(mesh, "binary_little_endian")},
            {"big.ply", ply_file(mesh, "binary_big_endian")}};
}

/// Faces of any number of corners in the three formats that know them.
std::map<std::string, std::string> polygon_files(const std::vector<Vector3>& points,
                                                 const std::vector<std::vector<int>>& faces) {
    std::ostringstream obj, off, ply;
    off << "OFF\n" << points.size() << ' ' << faces.size() << " 0\n";
    ply << "ply\nformat ascii 1.0\nelement face " << faces.size() << "\nproperty list ushort int vertex_index\n"
        << "element vertex " << points.size() << "\nproperty double x\nproperty double y\nproperty double z\n"
        << "end_header\n";
    for (auto* out : {&obj, &off, &ply}) out->precision(17);
    for (const auto& face : faces) {  // in this PLY before the points, as it may be
        ply << face.size();
        for (const int c : face) ply << ' ' << c;
        ply << '\n';
    }
    for (const auto& p : points) {
        obj << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
        for (auto* out : {&off, &ply}) *out << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    }
    for (const auto& face : faces) {
        obj << 'f';
        off << face.size();
        for (const int c : face) obj << ' ' << c + 1, off << ' ' << c;
        obj << '\n', off << '\n';
    }
    return {{"a.obj", obj.str()}, {"a.off", off.str()}, {"a.ply", ply.str()}};
}

/// The message of the refusal; fails if the file is read.
std::string refusal(const std::filesystem::path& file) {
    try {
        read_mesh(file);
    } catch (const ReadError& error) {
        EXPECT_THAT(error.what(), HasSubstr(file.filename().string()));
        EXPECT_FALSE(error.remedy().empty());
        return error.problem();
    }
    ADD_FAILURE() << file << " was read";
    return "";
}

TEST(MeshReader, EveryFormatGivesTheSameBox) {
    const FileFolder folder;
    for (const auto& [name, content] : all_formats(box)) {
        MeshFile file = read_mesh(folder.write(name, content));
        clean(file.mesh);
        EXPECT_EQ(file.mesh.points.size(), 8U) << name;
        EXPECT_EQ(file.mesh.triangles.size(), 12U) << name;
        EXPECT_TRUE(topology(file.mesh).closed()) << name;
        EXPECT_NEAR(signed_volume(file.mesh), 0.5 * 0.25 * 0.75, 1e-7) << name;
    }
}

/// Coordinates whose first byte a parser of text takes for a blank, a line end or a comment.
TEST(MeshReader, EveryByteMayBeginAFile) {
    const FileFolder folder;
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
        TriangleMesh mesh = box;
        for (auto& p : mesh.points) p[0] = std::bit_cast<float>(0x3f000000U + byte) + p[0];
        for (const auto& name : {"binary.stl", "little.ply", "a.obj"}) {
            const MeshFile file = read_mesh(folder.write(name, all_formats(mesh).at(name)));
            EXPECT_EQ(file.mesh.triangles.size(), 12U) << name << ' ' << byte;
            EXPECT_NEAR(signed_volume(file.mesh), 0.5 * 0.25 * 0.75, 1e-6) << name << ' ' << byte;
        }
    }
}

TEST(MeshReader, ObjDialects) {
    const FileFolder folder;
    std::string text = "# from C:\\scans\\\r\nmtllib ../../outside.mtl\r\no part\r\ng group\r\nusemtl skin\r\n";
    for (const auto& p : box.points) {
        text += "v " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + " 1 0 0\r\n";
    }
    text += "vt 0 0\r\nvn 0 0 1\r\nf 1/1/1 3/1/1 4/1/1 2/1/1\r\nf -4//1 -3//1 -1//1 \\\r\n -2//1\r\n";
    text += "f 1 2 6 5\r\ng D:\\\r\nf 3 7 8 4\r\nf 1 5 7 3\r\nf 2 4 8 6 # quads\r\nl 1 2\r\nf 1 2\r\n";
    MeshFile file = read_mesh(folder.write("quads.obj", text));
    clean(file.mesh);
    EXPECT_EQ(file.mesh.triangles.size(), 12U);
    EXPECT_NEAR(signed_volume(file.mesh), 0.09375, 1e-6);
    ASSERT_EQ(file.notes.size(), 1U);
    EXPECT_THAT(file.notes[0], HasSubstr("fewer than three corners"));
}

TEST(MeshReader, PolygonsOfAnyNumberOfCorners) {
    const FileFolder folder;
    for (const int n : {5, 9, 10, 12, 300}) {
        std::vector<Vector3> points;
        std::vector<std::vector<int>> faces(2);
        for (int i = 0; i < n; ++i) {
            const double angle = 2 * std::numbers::pi * i / n;
            for (const double z : {0.0, 1.0}) points.push_back({std::cos(angle), std::sin(angle), z});
            faces.push_back({2 * i, (2 * i + 2) % (2 * n), (2 * i + 3) % (2 * n), 2 * i + 1});
            faces[0].insert(faces[0].begin(), 2 * i);
            faces[1].push_back(2 * i + 1);
        }
        for (const auto& [name, content] : polygon_files(points, faces)) {
            MeshFile file = read_mesh(folder.write(name, content));
            clean(file.mesh);
            EXPECT_TRUE(topology(file.mesh).closed()) << name << " of " << n;
            EXPECT_NEAR(signed_volume(file.mesh), 0.5 * n * std::sin(2 * std::numbers::pi / n), 1e-6) << name;
            EXPECT_TRUE(file.notes.empty());
        }
    }
    std::string huge = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
    for (int i = 0; i < 10'001; ++i) huge += " " + std::to_string(i % 3 + 1);
    EXPECT_THAT(refusal(folder.write("huge.obj", huge)), HasSubstr("face 1 has more than 10000 corners"));
}

/// A prism over a U with more points than corners: each of them is a corner of some triangle, whichever comes first.
TEST(MeshReader, PointsOnStraightSidesAreKept) {
    const FileFolder folder;
    const std::vector<std::array<double, 2>> outline{{0, 0}, {1.5, 0}, {3, 0}, {3, 1}, {3, 3},   {2, 3},
                                                     {2, 2}, {2, 1},   {1, 1}, {1, 3}, {0.5, 3}, {0, 3}};
    const int n = static_cast<int>(outline.size());
    for (int first = 0; first < n; ++first) {
        std::vector<Vector3> points;
        std::vector<std::vector<int>> faces(2);
        for (int i = 0; i < n; ++i) {
            const auto& p = outline[(i + first) % n];
            for (const double z : {0.0, 0.1}) points.push_back({p[0], p[1], z});
            faces.push_back({2 * i, (2 * i + 2) % (2 * n), (2 * i + 3) % (2 * n), 2 * i + 1});
            faces[0].insert(faces[0].begin(), 2 * i);
            faces[1].push_back(2 * i + 1);
        }
        for (const auto& [name, content] : polygon_files(points, faces)) {
            MeshFile file = read_mesh(folder.write(name, content));
            clean(file.mesh);
            EXPECT_TRUE(topology(file.mesh).closed()) << name << " from " << first;
            EXPECT_EQ(file.mesh.triangles.size(), 4U * n - 4U);
            EXPECT_NEAR(signed_volume(file.mesh), 0.7, 1e-6) << name;
            EXPECT_NEAR(surface_area(file.mesh), 2 * 7 + 0.1 * 16, 1e-5) << name << " from " << first;
        }
    }
}

TEST(MeshReader, FarFromTheOriginTheShapeIsTheSame) {
    const FileFolder folder;
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 1.0, 4);
    for (const double away : {1e3, 1e6, 1e9}) {
        TriangleMesh moved = ball;
        for (auto& p : moved.points) p = p + Vector3{away, -0.3 * away, 300};
        for (const auto& [name, content] : std::map<std::string, std::string>{
                 {"a.obj", obj_text(moved)}, {"a.off", off_text(moved)}, {"a.stl", ascii_stl(moved, 17)}}) {
            MeshFile file = read_mesh(folder.write(name, content));
            clean(file.mesh);
            EXPECT_TRUE(topology(file.mesh).closed()) << name;
            EXPECT_NEAR(signed_volume(file.mesh), signed_volume(ball), 1e-6) << name << " at " << away;
            EXPECT_NEAR(file.mesh.points.front()[2], moved.points[moved.triangles.front()[0]][2], 1e-6);
        }
    }
    // Corners of neighbours that differ in their last digits are one point.
    TriangleMesh soup;
    for (std::size_t t = 0; t < box.triangles.size(); ++t) {
        for (const auto& p : box.corners(t)) soup.points.push_back((1.0 + 1e-15 * static_cast<double>(t)) * p);
        const int first = 3 * static_cast<int>(t);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    MeshFile file = read_mesh(folder.write("soup.obj", obj_text(soup)));
    clean(file.mesh);
    EXPECT_EQ(file.mesh.points.size(), 8U);
}

std::string in_capitals(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
    return text;
}

TEST(MeshReader, DialectsOfEditorsAndCollections) {
    const FileFolder folder;
    const std::string mark = "\xEF\xBB\xBF", off = off_text(box);
    const std::string counts = off.substr(4);  // behind "OFF\n"
    for (const auto& [name, content] :
         std::map<std::string, std::string>{{"capitals.stl", in_capitals(ascii_stl(box))},
                                            {"mixed.stl", "Solid" + ascii_stl(box).substr(5)},
                                            {"marked.stl", mark + ascii_stl(box)},
                                            {"marked.obj", mark + obj_text(box)},
                                            {"marked.off", mark + off},
                                            {"marked.ply", mark + ply_file(box, "ascii")},
                                            {"line.off", "OFF " + counts},
                                            {"joined.off", "OFF" + counts},
                                            {"none.off", counts},
                                            {"letters.off", "COFF\n# colours follow\n" + counts}}) {
        MeshFile file = read_mesh(folder.write(name, content));
        clean(file.mesh);
        EXPECT_EQ(file.mesh.triangles.size(), 12U) << name;
        EXPECT_NEAR(signed_volume(file.mesh), 0.5 * 0.25 * 0.75, 1e-7) << name;
    }
    EXPECT_THAT(refusal(folder.write("binary.off", "OFF BINARY\n12345")), HasSubstr("binary OFF"));
    EXPECT_THAT(refusal(folder.write("four.off", "4OFF\n" + counts)), HasSubstr("four or more dimensions"));
    EXPECT_THAT(refusal(folder.write("word.off", "OFFICE\n" + counts)), HasSubstr("begins with the word"));
    EXPECT_THAT(refusal(folder.write("bare.off", "OFF\n")), HasSubstr("are missing"));
}

TEST(MeshReader, PointsWithoutFacesAreACloud) {
    const FileFolder folder;
    const TriangleMesh cloud{box.points, {}};
    for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        const MeshFile file = read_mesh(folder.write(format + ".ply", ply_file(cloud, format)));
        EXPECT_TRUE(file.mesh.triangles.empty());
        EXPECT_EQ(file.mesh.points, box.points) << format;
    }
    // Faces under another name are faces all the same: not a cloud.
    std::string odd = ply_file(box, "ascii");
    const std::size_t at = odd.find("vertex_ind");
    odd.replace(at, odd.find('\n', at) - at, "corners");
    try {
        static_cast<void>(read_mesh(folder.write("odd.ply", odd)));
        ADD_FAILURE() << "was read";
    } catch (const ReadError& error) {
        EXPECT_THAT(error.what(), HasSubstr("no list vertex_indices"));
    }
}

/// Cut off anywhere, a file is refused or, where only its last line lost its end, read; never a crash.
TEST(MeshReader, TruncatedFilesAreRefused) {
    const FileFolder folder;
    for (const auto& [name, content] : all_formats(box)) {
        for (std::size_t size = 0; size < content.size(); size += std::max<std::size_t>(1, content.size() / 97)) {
            const auto file = folder.write(name, content.substr(0, size));
            if (name == "a.obj") {  // knows no counts: a shorter file is a valid one unless points are missing
                try {
                    EXPECT_LE(read_mesh(file).mesh.triangles.size(), 12U);
                } catch (const ReadError&) {
                }
            } else if (size + 20 < content.size()) {
                EXPECT_THROW(read_mesh(file), ReadError) << name << " cut to " << size << " bytes";
            }
        }
    }
}

TEST(MeshReader, DamagedBytesNeverCrash) {
    const FileFolder folder;
    std::uint32_t random = 12345;
    for (const auto& [name, content] : all_formats(box)) {
        for (int round = 0; round < 60; ++round) {
            std::string damaged = content;
            for (int i = 0; i < 4; ++i) {
                random = random * 1664525U + 1013904223U;
                damaged[random % damaged.size()] = static_cast<char>(random >> 24);
            }
            try {
                read_mesh(folder.write(name, damaged));
            } catch (const ReadError&) {
            }
        }
    }
}

TEST(MeshReader, LiesAreNamed) {
    const FileFolder folder;
    const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
        return text.replace(text.find(from), from.size(), to);
    };
    EXPECT_THAT(refusal(folder.write("empty.ply", "")), HasSubstr("empty"));
    EXPECT_THAT(refusal(folder.path() / "absent.ply"), HasSubstr("cannot be read"));
    EXPECT_THAT(refusal(folder.write("other.ply", "hello")), HasSubstr("begins with the line"));
    EXPECT_THAT(refusal(folder.write("a.ply", replaced(ply_file(box, "ascii"), "vertex 8", "vertex 4000000000"))),
                HasSubstr("more than the file has room for"));
    EXPECT_THAT(refusal(folder.write("b.ply", replaced(ply_file(box, "binary_little_endian"), "face 12", "face 13"))),
                HasSubstr("promises 13"));
    EXPECT_THAT(refusal(folder.write("c.ply", replaced(ply_file(box, "ascii"), "3 0 2 1", "3 0 2 8"))),
                HasSubstr("names point 8 of 8"));
    EXPECT_THAT(refusal(folder.write("d.ply", replaced(ply_file(box, "ascii"), "3 0 2 1", "99999 0 2 1"))),
                HasSubstr("promises a list of 99999"));
    const std::string whole = ply_file(box, "binary_little_endian");
    EXPECT_THAT(refusal(folder.write("h.ply", whole.substr(0, whole.size() - 4))), HasSubstr("break off after 11"));
    EXPECT_THAT(refusal(folder.write("e.ply", replaced(ply_file(box, "ascii"), "0.25", "nan"))),
                HasSubstr("not finite"));
    EXPECT_THAT(refusal(folder.write("g.ply", replaced(ply_file(box, "ascii"), "0.25", "1e30"))),
                HasSubstr("point 1 is too large"));
    // The second list would push the faces of the first out of their place, and the parser would end the program.
    EXPECT_THAT(refusal(folder.write("twice.ply", replaced(ply_file(box, "ascii"), "element face",
                                                           "element vertex 0\nproperty float x\nproperty float y\n"
                                                           "property float z\nelement face"))),
                HasSubstr("two lists of points"));
    EXPECT_THAT(refusal(folder.write("f.ply", replaced(ply_file(box, "ascii"), "ascii", "morse"))), HasSubstr("morse"));

    EXPECT_THAT(refusal(folder.write("a.off", replaced(off_text(box), "8 12", "9 12"))),
                HasSubstr("promises 12 faces"));
    EXPECT_THAT(refusal(folder.write("b.off", replaced(off_text(box), "8 12", "8 13"))), HasSubstr("ends after 12"));
    EXPECT_THAT(refusal(folder.write("c.off", replaced(off_text(box), "3 0 2 1", "3 0 2 -1"))),
                HasSubstr("\"-1\" of 8"));
    EXPECT_THAT(refusal(folder.write("e.off", replaced(off_text(box), "3 0 2 1", "2000000000 0 2 1"))),
                HasSubstr("a face of 2000000000 corners names only 3"));
    EXPECT_THAT(refusal(folder.write("d.off", replaced(off_text(box), "0.25", "inf"))), HasSubstr("not finite"));

    EXPECT_THAT(refusal(folder.write("a.obj", replaced(obj_text(box), "f 1 3 2", "f 1 3 9"))),
                HasSubstr("point 9 of 8"));
    EXPECT_THAT(refusal(folder.write("b.obj", replaced(obj_text(box), "f 1 3 2", "f 0 3 2"))),
                HasSubstr("does not exist"));
    EXPECT_THAT(refusal(folder.write("c.obj", replaced(obj_text(box), "v 0.25", "v 1e400"))), HasSubstr("not finite"));
    EXPECT_THAT(refusal(folder.write("e.obj", replaced(obj_text(box), "v 0.25", "v -1e151"))), HasSubstr("too large"));
    EXPECT_THAT(refusal(folder.write("d.obj", "# nothing\n")), HasSubstr("not a single point"));

    std::string stl = binary_stl(box);
    stl[80] = 13;
    EXPECT_THAT(refusal(folder.write("a.stl", stl)), HasSubstr("promises 13 triangles"));
    stl[80] = 11;
    EXPECT_THAT(refusal(folder.write("e.stl", stl)), HasSubstr("promises 11 triangles, the file holds 12"));
    stl[80] = 12;  // padding is none
    const MeshFile padded = read_mesh(folder.write("f.stl", stl + std::string(100, '\0')));
    EXPECT_EQ(padded.mesh.triangles.size(), 12U);
    EXPECT_THAT(padded.notes, testing::ElementsAre("100 bytes behind the last triangle were ignored."));
    std::fill_n(stl.begin() + 84 + 12, 4, '\xff');
    EXPECT_THAT(refusal(folder.write("b.stl", stl)), HasSubstr("triangle 1 is not finite"));
    EXPECT_THAT(refusal(folder.write("c.stl", replaced(ascii_stl(box), "endfacet\nfacet", "facet"))),
                HasSubstr("breaks off"));
    EXPECT_THAT(refusal(folder.write("d.stl", std::string(84, '\0'))), HasSubstr("no triangles"));
}

}  // namespace
}  // namespace morphodesic::datasets
