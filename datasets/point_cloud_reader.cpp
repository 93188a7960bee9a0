#include "datasets/point_cloud_reader.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "datasets/mesh_check.h"
#include "datasets/read_error.h"
#include "datasets/text_scan.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& problem) {
    throw ReadError(file, problem, "export or download the file again");
}

std::string ending_of(const fs::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending;
}

bool is_usable(const Vector3& p) {
    return std::all_of(p.begin(), p.end(), [](double x) { return std::isfinite(x) && std::abs(x) < 1e18; });
}

struct Field {
    std::string name;
    std::size_t size = 4, count = 1, offset = 0, column = 0;
    char type = 'F';
};

std::vector<Vector3> read_pcd(const fs::path& file, const std::string& content, std::vector<std::string>& notes) {
    std::vector<Field> fields;
    std::size_t count = 0, width = 0, height = 1, data_begin = 0;
    bool has_points = false;
    std::string data;
    TextScan scan(content);
    while (!scan.done() && data.empty()) {
        std::string_view line = scan.line();
        const std::string_view key = TextScan::word(line);
        if (key == "FIELDS") {
            for (auto w = TextScan::word(line); !w.empty(); w = TextScan::word(line)) {
                fields.emplace_back();
                fields.back().name = w;
            }
        } else if (key == "SIZE" || key == "COUNT") {
            for (Field& f : fields) {
                std::size_t& to = key == "SIZE" ? f.size : f.count;
                if (!TextScan::number(TextScan::word(line), to) || to > 1000)
                    refuse(file, "its header has a bad " + std::string(key));
            }
        } else if (key == "TYPE") {
            for (Field& f : fields) {
                const std::string_view w = TextScan::word(line);
                f.type = w.empty() ? '?' : w.front();
            }
        } else if (key == "WIDTH" || key == "HEIGHT") {
            if (!TextScan::number(TextScan::word(line), key == "WIDTH" ? width : height))
                refuse(file, "its header has a bad " + std::string(key));
        } else if (key == "POINTS") {
            has_points = TextScan::number(TextScan::word(line), count);
            if (!has_points) refuse(file, "its header does not say how many points there are");
        } else if (key == "DATA") {
            data = TextScan::word(line);
            data_begin = static_cast<std::size_t>(line.data() - content.data());
            data_begin = std::min(content.find('\n', data_begin), content.size() - 1) + 1;
        }
    }
    if (data == "binary_compressed") {
        throw ReadError(file, "its points are compressed, which is not read",
                        "save it as ascii or binary PCD or as PLY");
    }
    if (data != "ascii" && data != "binary")
        refuse(file, "its header does not lead to data (line \"DATA ascii\" or \"DATA binary\")");
    if (!has_points) count = height > 0 && width > content.size() / height ? content.size() + 1 : width * height;
    std::size_t bytes = 0, columns = 0;
    const Field* axis[3] = {nullptr, nullptr, nullptr};
    for (Field& f : fields) {
        f.offset = bytes, f.column = columns;
        bytes += f.size * f.count, columns += f.count;
        if (f.name.size() == 1 && f.name[0] >= 'x' && f.name[0] <= 'z') axis[f.name[0] - 'x'] = &f;
    }
    for (const Field* a : axis) {
        if (a == nullptr || a->count == 0) refuse(file, "its points have no x, y and z");
        if (data == "binary" && (a->type != 'F' || (a->size != 4 && a->size != 8)))
            refuse(file, "its coordinates are not floating point numbers");
    }
    const std::size_t left = content.size() - std::min(data_begin, content.size());
    const std::size_t room = data == "binary" ? left / bytes : left / 2 + 1;
    if (count > room) {
        refuse(file, "its header promises " + std::to_string(count) + " points, more than the file has room for");
    }
    std::vector<Vector3> points;
    std::size_t unseen = 0;
    for (std::size_t i = 0; i < count; ++i) {
        Vector3 p{};
        if (data == "binary") {
            for (int a = 0; a < 3; ++a) {
                const char* from = content.data() + data_begin + i * bytes + axis[a]->offset;
                float single = 0.0F;
                if (axis[a]->size == 8) std::memcpy(&p[a], from, 8);
                if (axis[a]->size == 4) std::memcpy(&single, from, 4), p[a] = single;
            }
        } else {
            if (scan.done())
                refuse(file,
                       "its header promises " + std::to_string(count) + " points, it ends after " + std::to_string(i));
            std::string_view line = scan.line();
            for (std::size_t column = 0; column < columns; ++column) {
                const std::string_view word = TextScan::word(line);
                for (int a = 0; a < 3; ++a) {
                    if (axis[a]->column == column && !TextScan::number(word, p[a])) {
                        refuse(file, "line " + std::to_string(scan.line_number()) + ": \"" +
                                         std::string(word.substr(0, 40)) + "\" is not a number");
                    }
                }
            }
        }
        if (is_usable(p)) {
            points.push_back(p);
        } else {
            ++unseen;
        }
    }
    if (unseen > 0) notes.push_back(std::to_string(unseen) + " points without a position were left out.");
    return points;
}

std::vector<Vector3> read_xyz(const fs::path& file, const std::string& content) {
    std::vector<Vector3> points;
    std::string plain = content;
    std::replace(plain.begin(), plain.end(), ',', ' ');
    std::replace(plain.begin(), plain.end(), ';', ' ');
    TextScan scan(plain);
    while (!scan.done()) {
        std::string_view line = scan.line();
        line = line.substr(0, line.find('#'));
        const std::string_view first = TextScan::word(line);
        if (first.empty()) continue;
        Vector3 p{};
        const std::string_view second = TextScan::word(line), third = TextScan::word(line);
        if (!TextScan::number(first, p[0]) || !TextScan::number(second, p[1]) || !TextScan::number(third, p[2])) {
            if (points.empty() && scan.line_number() <= 2) continue;  // a count or a title
            refuse(file, "line " + std::to_string(scan.line_number()) + " does not begin with three numbers");
        }
        if (!is_usable(p)) refuse(file, "line " + std::to_string(scan.line_number()) + ": a coordinate is not finite");
        points.push_back(p);
    }
    return points;
}

}  // namespace

bool is_point_cloud(const fs::path& file) {
    return ending_of(file) == ".pcd" || ending_of(file) == ".xyz";
}

std::vector<Vector3> read_point_cloud(const fs::path& file, double max_megabytes, std::vector<std::string>& notes) {
    const std::string content = file_content(file, max_megabytes);
    std::vector<Vector3> points = ending_of(file) == ".pcd" ? read_pcd(file, content, notes) : read_xyz(file, content);
    if (points.empty()) refuse(file, "there are no points in it");
    return points;
}

}  // namespace morphodesic::datasets
