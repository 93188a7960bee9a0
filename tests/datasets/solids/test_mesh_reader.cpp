#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST(MeshReader, ObjDialects) {
    const FileFolder folder;
    std::string text = "mtllib ../../outside.mtl\r\no part\r\ng group\r\nusemtl skin\r\n";
    for (const auto& p : box.points) {
        text += "v " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + " 1 0 0\r\n";
    }
    text += "vt 0 0\r\nvn 0 0 1\r\nf 1/1/1 3/1/1 4/1/1 2/1/1\r\nf -4//1 -3//1 -1//1 \\\r\n -2//1\r\n";
    text += "f 1 2 6 5\r\nf 3 7 8 4\r\nf 1 5 7 3\r\nf 2 4 8 6 # quads\r\nl 1 2\r\nf 1 2\r\n";
    MeshFile file = read_mesh(folder.write("quads.obj", text));
    clean(file.mesh);
    EXPECT_EQ(file.mesh.triangles.size(), 12U);
    EXPECT_NEAR(signed_volume(file.mesh), 0.09375, 1e-6);
    ASSERT_EQ(file.notes.size(), 1U);
    EXPECT_THAT(file.notes[0], HasSubstr("fewer than three corners"));
}

TEST(MeshReader, PointsWithoutFacesAreACloud) {
    const FileFolder folder;
    const TriangleMesh cloud{box.points, {}};
    for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        const MeshFile file = read_mesh(folder.write(format + ".ply", ply_file(cloud, format)));
        EXPECT_TRUE(file.mesh.triangles.empty());
        EXPECT_EQ(file.mesh.points, box.points) << format;
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
    EXPECT_THAT(refusal(folder.write("e.ply", replaced(ply_file(box, "ascii"), "0.25", "nan"))),
                HasSubstr("not finite"));
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
    EXPECT_THAT(refusal(folder.write("d.off", replaced(off_text(box), "0.25", "inf"))), HasSubstr("not finite"));

    EXPECT_THAT(refusal(folder.write("a.obj", replaced(obj_text(box), "f 1 3 2", "f 1 3 9"))),
                HasSubstr("point 9 of 8"));
    EXPECT_THAT(refusal(folder.write("b.obj", replaced(obj_text(box), "f 1 3 2", "f 0 3 2"))),
                HasSubstr("does not exist"));
    EXPECT_THAT(refusal(folder.write("c.obj", replaced(obj_text(box), "v 0.25", "v 1e400"))), HasSubstr("not finite"));
    EXPECT_THAT(refusal(folder.write("d.obj", "# nothing\n")), HasSubstr("not a single point"));

    std::string stl = binary_stl(box);
    stl[80] = 13;
    EXPECT_THAT(refusal(folder.write("a.stl", stl)), HasSubstr("promises 13 triangles"));
    stl = binary_stl(box);
    std::fill_n(stl.begin() + 84 + 12, 4, '\xff');
    EXPECT_THAT(refusal(folder.write("b.stl", stl)), HasSubstr("triangle 1 is not finite"));
    EXPECT_THAT(refusal(folder.write("c.stl", replaced(ascii_stl(box), "endfacet\nfacet", "facet"))),
                HasSubstr("breaks off"));
    EXPECT_THAT(refusal(folder.write("d.stl", std::string(84, '\0'))), HasSubstr("no triangles"));
}

}  // namespace
}  // namespace morphodesic::datasets
