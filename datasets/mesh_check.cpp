#include "datasets/mesh_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <numeric>

#include "datasets/interruption.h"
#include "datasets/ply_check.h"
#include "datasets/read_error.h"
#include "datasets/text_scan.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;

std::string at_line(std::size_t line) {
    return "line " + std::to_string(line) + ": ";
}

Vector3 coordinates(const fs::path& file, std::size_t line_number, std::string_view& line) {
    Vector3 p;
    for (double& x : p) {
        const std::string_view word = TextScan::word(line);
        if (word.empty()) refuse(file, at_line(line_number) + "a point has fewer than three coordinates");
        if (!TextScan::number(word, x)) {
            refuse(file, at_line(line_number) + "\"" + std::string(word.substr(0, 40)) + "\" is not a number");
        }
        if (const char* problem = coordinate_problem(x)) {
            refuse(file, at_line(line_number) + "a coordinate is " + problem);
        }
    }
    return p;
}

CheckedMesh check_obj(const fs::path& file, std::string_view content) {
    CheckedMesh result;
    long long largest = 0;
    std::size_t largest_line = 0, small_faces = 0;
    TextScan scan(content);
    std::string joined;
    while (!scan.done()) {
        std::string_view line = scan.line();
        std::string_view rest = line;
        const std::string_view first = TextScan::word(rest);
        // Elsewhere it ends a path or a comment.
        if (line.ends_with('\\') && (first == "v" || first == "f")) {
            joined.assign(line.substr(0, line.size() - 1));
            while (!scan.done()) {
                const std::string_view next = scan.line();
                joined += ' ';
                joined += next.ends_with('\\') ? next.substr(0, next.size() - 1) : next;
                if (!next.ends_with('\\')) break;
            }
            line = joined;
        }
        const std::string_view key = TextScan::word(line);
        if (key == "v") {
            result.points.push_back(coordinates(file, scan.line_number(), line));
        } else if (key == "f") {
            const std::size_t before = result.corners.size();
            for (std::string_view word = TextScan::word(line); !word.empty(); word = TextScan::word(line)) {
                if (word.front() == '#') break;
                long long index = 0;
                if (!TextScan::number(word.substr(0, word.find('/')), index)) {
                    refuse(file, at_line(scan.line_number()) + "\"" + std::string(word.substr(0, 40)) +
                                     "\" is not the number of a point");
                }
                if (index < 0) index += static_cast<long long>(result.points.size()) + 1;
                if (index < 1) refuse(file, at_line(scan.line_number()) + "a face names a point that does not exist");
                if (index > largest) largest = index, largest_line = scan.line_number();
                result.corners.push_back(static_cast<int>(std::min<long long>(index, largest_point_count) - 1));
            }
            const std::size_t corners = result.corners.size() - before;
            if (corners < 3) {
                ++small_faces;
                result.corners.resize(before);
                continue;
            }
            check_corner_count(file, result.face_sizes.size(), corners);
            result.face_sizes.push_back(static_cast<int>(corners));
            check_face_count(file, result.face_sizes.size());
        }
    }
    if (result.points.empty()) refuse(file, "there is not a single point (line \"v x y z\") in it");
    if (largest > static_cast<long long>(result.points.size())) {
        refuse(file, at_line(largest_line) + "a face names point " + std::to_string(largest) + " of " +
                         std::to_string(result.points.size()));
    }
    if (small_faces > 0) {
        result.notes.push_back("Skipped " + std::to_string(small_faces) + " faces of fewer than three corners.");
    }
    return result;
}

/// Next line that is neither empty nor a comment.
std::string_view next_data_line(TextScan& scan) {
    while (!scan.done()) {
        std::string_view line = scan.line();
        line = line.substr(0, line.find('#'));
        if (line.find_first_not_of(" \t\v\f") != std::string_view::npos) return line;
    }
    return {};
}

/// Cuts the mark "OFF", with its letters for further properties, off a line; also where the counts follow without a
/// blank. Files without it begin with the counts.
void skip_off_mark(const fs::path& file, std::string_view& line) {
    std::string_view rest = line;
    const std::string_view first = TextScan::word(rest);
    std::size_t count = 0;
    if (TextScan::number(first, count)) return;
    const std::size_t mark = first.find("OFF");
    const std::string_view letters = first.substr(0, mark),
                           behind = mark == std::string_view::npos ? first : first.substr(mark + 3);
    if (mark == std::string_view::npos || letters.find_first_not_of("STCN4n") != std::string_view::npos ||
        (!behind.empty() && !TextScan::number(behind, count))) {
        refuse(file, "an OFF file begins with the word OFF");
    }
    if (letters.find_first_of("4n") != std::string_view::npos)
        refuse(file, "OFF files of four or more dimensions are no solids");
    line.remove_prefix(static_cast<std::size_t>(behind.data() - line.data()));
    rest = line;
    if (TextScan::word(rest) == "BINARY") {
        throw ReadError(file, "this is a binary OFF file, a rare kind that is not read", "convert it to PLY or STL");
    }
}

CheckedMesh check_off(const fs::path& file, std::string_view content) {
    CheckedMesh result;
    TextScan scan(content);
    std::string_view line = next_data_line(scan);
    skip_off_mark(file, line);
    if (line.find_first_not_of(" \t\v\f") == std::string_view::npos) line = next_data_line(scan);
    std::size_t points = 0, faces = 0;
    if (!TextScan::number(TextScan::word(line), points) || !TextScan::number(TextScan::word(line), faces)) {
        refuse(file, at_line(scan.line_number()) + "the numbers of points and faces are missing");
    }
    check_face_count(file, faces);
    if (points == 0) refuse(file, "the header promises no points");
    for (std::size_t i = 0; i < points; ++i) {
        line = next_data_line(scan);
        if (line.empty()) {
            refuse(file, "the header promises " + std::to_string(points) + " points, the file ends after " +
                             std::to_string(i));
        }
        result.points.push_back(coordinates(file, scan.line_number(), line));
    }
    for (std::size_t i = 0; i < faces; ++i) {
        line = next_data_line(scan);
        if (line.empty()) {
            refuse(file,
                   "the header promises " + std::to_string(faces) + " faces, the file ends after " + std::to_string(i));
        }
        std::size_t corners = 0;
        if (!TextScan::number(TextScan::word(line), corners)) {
            refuse(file, at_line(scan.line_number()) + "the number of corners is missing");
        }
        const std::size_t before = result.corners.size();
        for (std::size_t c = 0; c < corners; ++c) {
            std::size_t index = 0;
            const std::string_view word = TextScan::word(line);
            if (word.empty()) {
                refuse(file, at_line(scan.line_number()) + "a face of " + std::to_string(corners) +
                                 " corners names only " + std::to_string(c));
            }
            if (!TextScan::number(word, index) || index >= std::min(points, largest_point_count)) {
                refuse(file, at_line(scan.line_number()) + "a face names point \"" + std::string(word.substr(0, 40)) +
                                 "\" of " + std::to_string(points) + " (counted from 0)");
            }
            result.corners.push_back(static_cast<int>(index));
        }
        check_corner_count(file, i, corners);
        if (corners >= 3) {
            result.face_sizes.push_back(static_cast<int>(corners));
        } else {
            result.corners.resize(before);
        }
    }
    return result;
}

std::size_t binary_stl_triangles(std::string_view content) {
    std::uint32_t n = 0;
    if (content.size() >= 84) std::memcpy(&n, content.data() + 80, sizeof n);  // little endian, as this machine
    return n;
}

bool is_ascii_stl(std::string_view content) {
    if (content.size() >= 84 && content.size() == 84 + 50 * binary_stl_triangles(content)) return false;
    const std::size_t begin = content.find_first_not_of(" \t\r\n");
    return begin != std::string_view::npos && TextScan::is_word(content.substr(begin, 5), "solid") &&
           content.substr(0, 4096).find('\0') == std::string_view::npos;
}

CheckedMesh check_stl(const fs::path& file, std::string_view content) {
    CheckedMesh result;
    if (is_ascii_stl(content)) {
        TextScan scan(content);
        std::size_t corners = 0, facets = 0, ended = 0;
        bool complete = false;
        while (!scan.done()) {
            std::string_view line = scan.line();
            const std::string_view key = TextScan::word(line);
            if (TextScan::is_word(key, "facet")) ++facets;
            if (TextScan::is_word(key, "endfacet")) ++ended;
            if (TextScan::is_word(key, "endsolid")) complete = true;
            if (!TextScan::is_word(key, "vertex")) continue;
            result.points.push_back(coordinates(file, scan.line_number(), line));
            ++corners;
        }
        if (corners == 0) refuse(file, "there are no triangles in it");
        if (corners % 3 != 0 || facets * 3 != corners || ended != facets || !complete) {
            refuse(file, "it breaks off (" + std::to_string(corners) + " corners, " + std::to_string(facets) +
                             " facets" + (complete ? ")" : ", no endsolid)"));
        }
    } else {
        if (content.size() < 84)
            refuse(file, "too short for an STL file (" + std::to_string(content.size()) + " bytes)");
        const std::size_t n = binary_stl_triangles(content);
        if (n == 0) refuse(file, "the header promises no triangles");
        if ((content.size() - 84) / 50 < n) {
            refuse(file, "the header promises " + std::to_string(n) + " triangles, the file ends after " +
                             std::to_string((content.size() - 84) / 50));
        }
        check_face_count(file, n);
        for (std::size_t t = 0; t < n; ++t) {
            interruption_point(t);
            float c[9];
            std::memcpy(c, content.data() + 84 + 50 * t + 12, sizeof c);
            for (const float x : c) {
                if (const char* problem = coordinate_problem(x)) {
                    refuse(file, "a coordinate of triangle " + std::to_string(t + 1) + " is " + problem);
                }
            }
            for (int i = 0; i < 9; i += 3) result.points.push_back({c[i], c[i + 1], c[i + 2]});
        }
        const std::string_view rest = content.substr(84 + 50 * n);
        if (rest.size() % 50 == 0 && rest.find_first_not_of('\0') != std::string_view::npos) {
            refuse(file, "the header promises " + std::to_string(n) + " triangles, the file holds " +
                             std::to_string(n + rest.size() / 50));
        }
        if (!rest.empty()) {
            result.notes.push_back(std::to_string(rest.size()) + " bytes behind the last triangle were ignored.");
        }
    }
    check_face_count(file, result.points.size() / 3);
    result.face_sizes.assign(result.points.size() / 3, 3);
    result.corners.resize(result.points.size());
    std::iota(result.corners.begin(), result.corners.end(), 0);
    return result;
}

}  // namespace

const char* coordinate_problem(double x) {
    if (!std::isfinite(x)) return "not finite";
    return std::abs(x) > largest_coordinate ? "too large (more than 1e18)" : nullptr;
}

void check_face_count(const fs::path& file, std::size_t faces) {
    if (faces > largest_face_count) {
        throw ReadError(file, "more than " + std::to_string(largest_face_count / 1'000'000) + " million faces",
                        "reduce the mesh (decimate it); a hundred thousand triangles are plenty");
    }
}

void check_corner_count(const fs::path& file, std::size_t face, std::size_t corners) {
    if (corners > most_corners) {
        throw ReadError(
            file, "face " + std::to_string(face + 1) + " has more than " + std::to_string(most_corners) + " corners",
            "cut the faces into triangles before you save it");
    }
}

std::string file_content(const fs::path& file, double max_megabytes) {
    std::error_code error;
    const auto size = fs::file_size(file, error);
    if (error)
        throw ReadError(file, "it cannot be read (" + error.message() + ")", "check the path and its permissions");
    if (size == 0) refuse(file, "the file is empty");
    if (static_cast<double>(size) > 1e6 * max_megabytes) {
        throw ReadError(file, "the file has " + std::to_string(size / 1'000'000) + " megabytes, more than the limit",
                        "reduce the mesh or raise --max-megabytes");
    }
    std::string content(size, '\0');
    std::ifstream in(file, std::ios::binary);
    constexpr std::size_t piece = std::size_t{1} << 25;
    for (std::size_t done = 0; in && done < size; done += piece) {
        interruption_point();
        in.read(content.data() + done, static_cast<std::streamsize>(std::min(piece, size - done)));
    }
    if (!in) {
        throw ReadError(file, "it cannot be read to its end", "check its permissions and the disk");
    }
    return content;
}

MeshFormat mesh_format(const fs::path& file, std::string_view content) {
    const std::string ending = lower_case(file.extension().string());
    if (content.substr(0, 4) == "ply\n" || content.substr(0, 4) == "ply\r") return MeshFormat::ply;
    const std::string_view first_word = content.substr(0, content.find_first_of(" \t\r\n"));
    if (first_word.size() <= 8 && first_word.ends_with("OFF")) return MeshFormat::off;
    if (ending == ".obj") return MeshFormat::obj;
    if (ending == ".stl") return MeshFormat::stl;
    if (ending == ".off") return MeshFormat::off;
    if (ending == ".ply") refuse(file, "a PLY file begins with the line \"ply\"");
    throw ReadError(file, "this is not a mesh that can be read", "use PLY, OBJ, STL or OFF");
}

CheckedMesh check_mesh(const fs::path& file, const std::string& content) {
    const std::string_view text = TextScan::without_mark(content);
    switch (mesh_format(file, text)) {
        case MeshFormat::obj:
            return check_obj(file, text);
        case MeshFormat::off:
            return check_off(file, text);
        case MeshFormat::stl:
            return check_stl(file, is_ascii_stl(text) ? text : std::string_view(content));
        case MeshFormat::ply:
            return check_ply(file, text);
    }
    return {};
}

}  // namespace morphodesic::datasets
