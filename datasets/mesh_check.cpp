#include "datasets/mesh_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "datasets/ply_check.h"
#include "datasets/read_error.h"
#include "datasets/text_scan.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& problem) {
    throw ReadError(file, problem, "export or download the file again");
}
std::string at_line(std::size_t line) {
    return "line " + std::to_string(line) + ": ";
}

void append(std::string& text, const Vector3& p) {
    char number[32];
    for (const double x : p) {
        text += ' ';
        text.append(number, std::to_chars(number, number + sizeof number, x).ptr);
    }
}

Vector3 coordinates(const fs::path& file, std::size_t line_number, std::string_view& line) {
    Vector3 p;
    for (double& x : p) {
        const std::string_view word = TextScan::word(line);
        if (word.empty()) refuse(file, at_line(line_number) + "a point has fewer than three coordinates");
        if (!TextScan::number(word, x)) {
            refuse(file, at_line(line_number) + "\"" + std::string(word.substr(0, 40)) + "\" is not a number");
        }
        if (!std::isfinite(x) || std::abs(x) > 1e18) {
            refuse(file, at_line(line_number) + "a coordinate is not finite");
        }
    }
    return p;
}

void check_face_count(const fs::path& file, std::size_t faces) {
    if (faces > largest_face_count) {
        throw ReadError(file, "more than " + std::to_string(largest_face_count / 1'000'000) + " million faces",
                        "reduce the mesh (decimate it); a hundred thousand triangles are plenty");
    }
}

/// Points and faces are kept, written out plainly: materials, textures, normals, groups and curves are no part of a
/// shape, and reading them would open other files and split points.
CheckedMesh check_obj(const fs::path& file, const std::string& content) {
    CheckedMesh result;
    result.format = MeshFormat::obj;
    std::string faces;
    long long largest = 0;
    std::size_t largest_line = 0, small_faces = 0;
    std::vector<long long> corners;
    TextScan scan(content);
    std::string joined;
    while (!scan.done()) {
        std::string_view line = scan.line();
        if (line.ends_with('\\')) {
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
            const Vector3 p = coordinates(file, scan.line_number(), line);
            result.points.push_back(p);
            ++result.point_count;
            result.content += 'v';
            append(result.content, p);
            result.content += '\n';
        } else if (key == "f") {
            corners.clear();
            for (std::string_view word = TextScan::word(line); !word.empty(); word = TextScan::word(line)) {
                if (word.front() == '#') break;
                long long index = 0;
                if (!TextScan::number(word.substr(0, word.find('/')), index)) {
                    refuse(file, at_line(scan.line_number()) + "\"" + std::string(word.substr(0, 40)) +
                                     "\" is not the number of a point");
                }
                if (index < 0) index += static_cast<long long>(result.point_count) + 1;
                if (index < 1) refuse(file, at_line(scan.line_number()) + "a face names a point that does not exist");
                if (index > largest) largest = index, largest_line = scan.line_number();
                corners.push_back(index);
            }
            if (corners.size() < 3) {
                ++small_faces;
                continue;
            }
            check_face_count(file, ++result.face_count);
            faces += 'f';
            for (const long long c : corners) faces += ' ', faces += std::to_string(c);
            faces += '\n';
        }
    }
    if (result.point_count == 0) refuse(file, "there is not a single point (line \"v x y z\") in it");
    if (largest > static_cast<long long>(result.point_count)) {
        refuse(file, at_line(largest_line) + "a face names point " + std::to_string(largest) + " of " +
                         std::to_string(result.point_count));
    }
    if (small_faces > 0) {
        result.notes.push_back("Skipped " + std::to_string(small_faces) + " faces of fewer than three corners.");
    }
    result.content += faces;
    if (result.face_count > 0) result.points.clear();
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

CheckedMesh check_off(const fs::path& file, const std::string& content) {
    CheckedMesh result;
    result.format = MeshFormat::off;
    TextScan scan(content);
    std::string_view line = next_data_line(scan);
    const std::string_view magic = TextScan::word(line);
    if (!magic.ends_with("OFF")) refuse(file, "an OFF file begins with the word OFF");
    if (magic.find_first_of("4n") != std::string_view::npos)
        refuse(file, "OFF files of four or more dimensions are no solids");
    if (TextScan::word(line) == "BINARY") {
        throw ReadError(file, "this is a binary OFF file, a rare kind that is not read", "convert it to PLY or STL");
    }
    line = next_data_line(scan);
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
        const Vector3 p = coordinates(file, scan.line_number(), line);
        result.points.push_back(p);
        append(result.content, p);
        result.content += '\n';
    }
    std::string text;
    std::size_t kept = 0;
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
        std::string face = std::to_string(corners);
        for (std::size_t c = 0; c < corners; ++c) {
            std::size_t index = 0;
            const std::string_view word = TextScan::word(line);
            if (!TextScan::number(word, index) || index >= points) {
                refuse(file, at_line(scan.line_number()) + "a face names point \"" + std::string(word.substr(0, 40)) +
                                 "\" of " + std::to_string(points) + " (counted from 0)");
            }
            face += ' ' + std::to_string(index);
        }
        if (corners < 3) continue;
        ++kept;
        text += face + '\n';
    }
    result.content = "OFF\n" + std::to_string(points) + ' ' + std::to_string(kept) + " 0\n" + result.content + text;
    result.point_count = points;
    result.face_count = kept;
    if (kept > 0) result.points.clear();
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
    return begin != std::string_view::npos && content.substr(begin, 5) == "solid" &&
           content.substr(0, 4096).find('\0') == std::string_view::npos;
}

CheckedMesh check_stl(const fs::path& file, std::string content) {
    CheckedMesh result;
    result.format = MeshFormat::stl;
    if (is_ascii_stl(content)) {
        TextScan scan(content);
        std::size_t corners = 0, facets = 0, ended = 0;
        bool complete = false;
        std::string plain = "solid shape\n";
        while (!scan.done()) {
            std::string_view line = scan.line();
            const std::string_view key = TextScan::word(line);
            if (key == "facet") ++facets;
            if (key == "endfacet") ++ended;
            if (key == "endsolid") complete = true;
            if (key != "vertex") continue;
            const Vector3 p = coordinates(file, scan.line_number(), line);
            if (corners % 3 == 0) plain += "facet normal 0 0 0\nouter loop\n";
            plain += "vertex";
            append(plain, p);
            plain += '\n';
            if (++corners % 3 == 0) plain += "endloop\nendfacet\n";
        }
        if (corners == 0) refuse(file, "there are no triangles in it");
        if (corners % 3 != 0 || facets * 3 != corners || ended != facets || !complete) {
            refuse(file, "it breaks off (" + std::to_string(corners) + " corners, " + std::to_string(facets) +
                             " facets" + (complete ? ")" : ", no endsolid)"));
        }
        result.content = plain + "endsolid shape\n";
        result.face_count = corners / 3;
    } else {
        if (content.size() < 84)
            refuse(file, "too short for an STL file (" + std::to_string(content.size()) + " bytes)");
        const std::size_t n = binary_stl_triangles(content);
        if (n == 0) refuse(file, "the header promises no triangles");
        if ((content.size() - 84) / 50 < n) {
            refuse(file, "the header promises " + std::to_string(n) + " triangles, the file ends after " +
                             std::to_string((content.size() - 84) / 50));
        }
        for (std::size_t t = 0; t < n; ++t) {
            float c[9];
            std::memcpy(c, content.data() + 84 + 50 * t + 12, sizeof c);
            for (const float x : c) {
                if (!std::isfinite(x) || std::abs(x) > 1e18F) {
                    refuse(file, "a coordinate of triangle " + std::to_string(t + 1) + " is not finite");
                }
            }
        }
        if (content.size() > 84 + 50 * n) result.notes.push_back("Bytes behind the last triangle were ignored.");
        content.resize(84 + 50 * n);
        std::fill_n(content.begin(), 80, ' ');  // a header that begins with "solid" misleads parsers
        result.content = std::move(content);
        result.face_count = n;
    }
    check_face_count(file, result.face_count);
    result.point_count = 3 * result.face_count;
    return result;
}

}  // namespace

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
    in.read(content.data(), static_cast<std::streamsize>(size));
    if (!in || in.gcount() != static_cast<std::streamsize>(size)) {
        throw ReadError(file, "it cannot be read to its end", "check its permissions and the disk");
    }
    return content;
}

MeshFormat mesh_format(const fs::path& file, std::string_view content) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    if (content.substr(0, 4) == "ply\n" || content.substr(0, 4) == "ply\r") return MeshFormat::ply;
    const std::string_view first_word = content.substr(0, content.find_first_of(" \t\r\n"));
    if (first_word.size() <= 8 && first_word.ends_with("OFF")) return MeshFormat::off;
    if (ending == ".obj") return MeshFormat::obj;
    if (ending == ".stl") return MeshFormat::stl;
    if (ending == ".off") return MeshFormat::off;
    if (ending == ".ply") refuse(file, "a PLY file begins with the line \"ply\"");
    throw ReadError(file, "this is not a mesh that can be read", "use PLY, OBJ, STL or OFF");
}

CheckedMesh check_mesh(const fs::path& file, std::string content) {
    switch (mesh_format(file, content)) {
        case MeshFormat::obj:
            return check_obj(file, content);
        case MeshFormat::off:
            return check_off(file, content);
        case MeshFormat::stl:
            return check_stl(file, std::move(content));
        case MeshFormat::ply:
            return check_ply(file, std::move(content));
    }
    return {};
}

}  // namespace morphodesic::datasets
