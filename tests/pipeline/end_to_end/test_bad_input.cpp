// Every kind of bad file in one folder with two good shapes: the program names each with its fault and a remedy, ends
// with code 1, and the good pair is there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "analysis/matrix_csv.h"
#include "program.h"
#include "tests/datasets/solids/solid_files.h"

namespace morphodesic::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using namespace std::string_literals;

std::string big_endian(std::uint32_t v) {
    return {char(v >> 24), char(v >> 16), char(v >> 8), char(v)};
}

std::string pgm(int width, int height, const std::string& pixels) {
    return "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" + pixels;
}

/// The program as a user whom permissions bind: root reads and writes everything.
Outcome as_ordinary_user(const std::vector<std::string>& arguments, const fs::path& owned) {
    // Sanitizers reserve most of the address space; they have a limit of their own.
    std::string line = sanitized ? "export ASAN_OPTIONS=\"$ASAN_OPTIONS:hard_rss_limit_mb=4000\" "
                                   "TSAN_OPTIONS=\"$TSAN_OPTIONS:hard_rss_limit_mb=4000\"; "
                                 : "ulimit -v 4000000; ";
    if (::geteuid() == 0) {
        line += "chown -R 65534:65534 '" + owned.string() + "'; chmod 755 '" + owned.string() + "'; exec setpriv " +
                "--reuid 65534 --regid 65534 --clear-groups \"$MORPHODESIC\"";
    } else {
        line += "exec \"$MORPHODESIC\"";
    }
    for (const std::string& word : arguments) line += " '" + word + "'";
    return shell(line);
}

/// Runs a study of the folder and compares what was left out, by name, with what is expected: words of the message.
void expect_left_out(const TemporaryFolder& folder, const fs::path& collection,
                     const std::map<std::string, std::string>& expected, const std::set<std::string>& good) {
    const Outcome done = as_ordinary_user(
        quick({"run", collection.string(), "--json", "--normalize", "each", "--paths", "none"}), folder.path());
    ASSERT_EQ(done.code, 1) << done.err;
    const json summary = json::parse(done.out);
    std::vector<std::string> reasons;
    for (const json& failure : summary["failures"]) {
        EXPECT_EQ(failure["b"], "") << failure;  // a file, not a pair
        reasons.push_back(failure["reason"].get<std::string>());
    }
    for (const auto& [name_of_file, words] : expected) {
        const std::string& name = name_of_file;  // clang 14 lets no lambda hold a structured binding
        const auto said = std::find_if(reasons.begin(), reasons.end(), [&](const std::string& reason) {
            return reason.find("/" + name + ":") != std::string::npos;
        });
        if (said == reasons.end()) {
            ADD_FAILURE() << "nothing said of " << name << "\n" << summary["failures"].dump(1);
            continue;
        }
        EXPECT_THAT(*said, testing::HasSubstr(words)) << name;
        EXPECT_THAT(*said, testing::HasSubstr("; ")) << "no remedy: " << *said;
    }
    const auto distances = analysis::read_distance_csv(fs::path(collection.string() + ".study") / "distances.csv");
    EXPECT_THAT(distances.labels(), testing::UnorderedElementsAreArray(good));
    EXPECT_EQ(distances.missing_count(), 0u);
    EXPECT_EQ(summary["shapes"], good.size());
}

TEST(BadInput, ImagesAreNamedWithFaultAndRemedyAndTheGoodPairIsThere) {
    const TemporaryFolder folder;
    const fs::path images = folder / "images";
    make_disks(images, 2);
    const std::string good = read_file(images / "disk-01.png");
    ASSERT_GT(good.size(), 100u);
    std::map<std::string, std::string> expected;
    const auto bad = [&](const std::string& name, const std::string& bytes, const std::string& words) {
        write_file(images / name, bytes);
        expected[name] = words;
    };
    bad("truncated.png", good.substr(0, good.size() / 2), "");
    bad("header only.png", good.substr(0, 33), "");
    bad("empty.png", "", "empty");
    std::string flipped = good;
    flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 0x10);
    bad("flipped.png", flipped, "check sum");
    bad("bomb.png", good.substr(0, 16) + big_endian(100000) + big_endian(100000) + good.substr(24), "100000 x 100000");
    bad("wide.png", good.substr(0, 16) + big_endian(0x7fffffff) + big_endian(1) + good.substr(24), "");
    bad("bomb.pgm", "P5\n99999999999 99999999999 255\n", "");
    bad("lie.pgm", "P5\n5000 5000 255\nx", "");
    bad("text.png", "this is not a picture", "not an image");
    bad("page.jpg", "<!DOCTYPE html><title>404</title>", "");
    bad("mesh.png", obj_text(ball_mesh({0, 0, 0}, 1, 1)), "not an image");
    bad("black.pgm", pgm(20, 20, std::string(400, '\0')), "one colour");
    bad("pixel.pgm", pgm(1, 1, "\0"s), "one colour");
    bad("no pixels.pgm", "P5\n0 0\n255\n", "");
    bad("-o.png", "x", "");
    bad("a\nb.png", "x", "");
    bad("'q\" & <b>%s%n.png", "x", "");
    bad("\xff\xfe.png", "x", "");
    bad(std::string(251, 'n') + ".png", "x", "");
    bad("solid.obj", obj_text(ball_mesh({0, 0, 0}, 1, 1)), "3D");
    write_file(images / "secret.png", good);
    fs::permissions(images / "secret.png", fs::perms::none);
    expected["secret.png"] = "you may read it";
    fs::create_symlink(images / "nowhere.png", images / "dangling.png");
    expected["dangling.png"] = "link";
    fs::create_symlink("self.png", images / "self.png");
    expected["self.png"] = "link";
    // Neither of these is a shape, and neither may stop the scan.
    fs::create_directories(images / "folder.png");
    fs::create_directory_symlink("..", images / "folder.png" / "up");
    fs::create_directory_symlink(".", images / "loop");
    ASSERT_EQ(::mkfifo((images / "pipe.png").c_str(), 0644), 0);
    expected.erase("\xff\xfe.png");  // JSON holds text: bytes that are none come back replaced
    expected["\xef\xbf\xbd\xef\xbf\xbd.png"] = "not an image";
    expect_left_out(folder, images, expected, {"disk-01.png", "disk-02.png"});
}

TEST(BadInput, SolidsAreNamedWithFaultAndRemedyAndTheGoodPairIsThere) {
    const TemporaryFolder folder;
    const fs::path solids = folder / "solids";
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 1, 2), box = box_mesh({0, 0, 0}, {1, 2, 1});
    write_file(solids / "ball.obj", obj_text(ball));
    write_file(solids / "box.off", off_text(box));
    std::map<std::string, std::string> expected;
    std::set<std::string> good{"ball.obj", "box.off"};
    const auto bad = [&](const std::string& name, const std::string& bytes, const std::string& words = "") {
        write_file(solids / name, bytes);
        expected[name] = words;
    };
    const auto mended = [&](const std::string& name, const std::string& bytes) {
        write_file(solids / name, bytes);
        good.insert(name);
    };
    const std::string stl = binary_stl(ball), ply = ply_file(ball, "binary_little_endian"), off = off_text(box);
    bad("truncated.stl", stl.substr(0, stl.size() / 2));
    bad("truncated.ply", ply.substr(0, ply.size() / 2));
    bad("truncated.off", off.substr(0, off.size() - 20));
    bad("empty.obj", "", "empty");
    bad("empty.ply", "", "empty");
    bad("lie.stl", stl.substr(0, 80) + "\xff\xff\xff\x7f" + stl.substr(84));
    std::string lie = ply;
    lie.replace(lie.find("element face "), 16, "element face 999999999");
    bad("lie.ply", lie);
    bad("counts.off", "OFF\n4000000000 4000000000 0\n0 0 0\n");
    bad("negative.off", "OFF\n-8 -12 0\n0 0 0\n");
    bad("nan.obj", "v nan 0 0\n" + obj_text(ball), "");
    bad("infinite.off", "OFF\n4 4 0\n0 0 0\n1e999 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
    bad("range.obj", obj_text(box) + "f 1 2 99\n");
    bad("range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
    bad("no faces.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    bad("flat.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n");
    bad("one face.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    bad("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    bad("point.obj", "v 0 0 0\nf 1 1 1\n");
    bad("text.stl", "this is not a mesh");
    bad("wrong.ply", read_file(solids / "ball.obj"));
    bad("few.xyz", "0 0 0\n1 1 1\n");
    bad("words.xyz", "a b c\nd e f\n");
    bad("lie.pcd",
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2000000000\nHEIGHT 1\n"
        "POINTS 2000000000\nDATA binary\nabc");
    bad("noise.vdb", std::string(300, '\x5a'));
    bad("empty.vdb", "");
    bad("<i>%d' \".obj", "f 1 2 3\n");
    // What can be mended is, and stays in the study.
    const TriangleMesh inverted = inside_out(ball);
    mended("inverted.obj", obj_text(inverted));
    mended("unordered.obj",
           obj_text(joined(TriangleMesh{ball.points, {ball.triangles.begin(), ball.triangles.end() - 9}},
                           TriangleMesh{inverted.points, {inverted.triangles.end() - 9, inverted.triangles.end()}})));
    TriangleMesh fin = ball;  // an edge with three faces
    fin.points.push_back({0, 0, 1.2});
    fin.triangles.push_back({fin.triangles[0][0], fin.triangles[0][1], static_cast<int>(fin.points.size()) - 1});
    mended("fin.obj", obj_text(fin));
    expect_left_out(folder, solids, expected, good);
}

TEST(BadInput, AnyNameOfAGoodShapeIsCarriedThrough) {
    const TemporaryFolder folder;
    make_disks(folder / "plain", 5);
    const std::vector<std::string> names{"-rf.png", std::string(251, 'n') + ".png", "\xff\xfe\x80.png",
                                         "\xe2\x80\xae\xf0\x9f\x90\x9f \t\r\n.png", "=1+1;'\"<script>%n%s&amp;\\.png"};
    for (std::size_t i = 0; i < names.size(); ++i) {
        fs::create_directories(folder / "odd");
        fs::rename(folder / ("plain/disk-0" + std::to_string(i + 1) + ".png"), folder / "odd" / names[i]);
    }
    const Outcome done = morphodesic(quick({"run", (folder / "odd").string(), "--json"}));
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(json::parse(done.out)["shapes"], 5);
    const auto distances = analysis::read_distance_csv(folder / "odd.study/distances.csv");
    EXPECT_EQ(distances.missing_count(), 0u);
    EXPECT_THAT(distances.labels(), testing::UnorderedElementsAreArray(names));
    EXPECT_FALSE(json::parse(read_file(folder / "odd.study/report.json")).empty());
    EXPECT_THAT(read_file(folder / "odd.study/report.html"), testing::Not(testing::HasSubstr("<script>%n")));
    // The second run knows them all again.
    EXPECT_EQ(json::parse(morphodesic(quick({"run", (folder / "odd").string(), "--json"})).out)["pairs_computed"], 0);
}

TEST(BadInput, NamesGiveTheTerminalNoCommands) {
    const TemporaryFolder folder;
    make_disks(folder / "disks", 3);
    write_file(folder / "disks/\x1b]0;title\x07\x1b[2J.png", "");
    for (const std::vector<std::string>& way : {std::vector<std::string>{}, {"--quiet"}}) {
        std::vector<std::string> command{"run", (folder / "disks").string()};
        command.insert(command.end(), way.begin(), way.end());
        const Outcome done = morphodesic(quick(command));
        EXPECT_EQ(done.code, 1) << done.err;
        EXPECT_EQ((done.out + done.err).find_first_of("\x1b\x07"), std::string::npos) << done.out << done.err;
        EXPECT_THAT(done.out + done.err, testing::HasSubstr("\\x1b]0;title\\x07\\x1b[2J.png"));
    }
}

}  // namespace
}  // namespace morphodesic::tests
