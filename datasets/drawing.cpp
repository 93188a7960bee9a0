#include "datasets/drawing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>

#include "datasets/collection_folder.h"
#include "datasets/content_digest.h"
#include "datasets/csv_rows.h"
#include "datasets/outline_geometry.h"

namespace morphodesic::datasets {

namespace {

using std::numbers::pi;

std::string parameter_table(const std::vector<Drawing>& drawings) {
    std::string table = "file,label";
    for (const auto& [name, value] : drawings.front().parameters) table += "," + csv_field(name);
    table += "\n";
    for (const Drawing& drawing : drawings) {
        table += csv_field(drawing.name + ".png") + "," + csv_field(drawing.label);
        for (const auto& [name, value] : drawing.parameters) table += "," + csv_field(value);
        table += "\n";
    }
    return table;
}

}  // namespace

Loop disk_polygon(const Point<2>& centre, double radius, int corners) {
    Loop loop;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2.0 * pi * i / corners;
        loop.push_back({centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle)});
    }
    return loop;
}

Loop capsule_polygon(const Point<2>& a, const Point<2>& b, double radius, int corners) {
    const double direction = std::atan2(b[1] - a[1], b[0] - a[0]);
    Loop loop;
    for (const auto& [end, start] :
         {std::make_pair(b, direction - 0.5 * pi), std::make_pair(a, direction + 0.5 * pi)}) {
        for (int i = 0; i <= corners / 2; ++i) {
            const double angle = start + 2.0 * pi * i / corners;
            loop.push_back({end[0] + radius * std::cos(angle), end[1] + radius * std::sin(angle)});
        }
    }
    return loop;
}

Coverage rasterize(const Drawing& drawing, int side) {
    if (side < 8 || side > 8192) throw std::invalid_argument("the side of a picture must be from 8 to 8192 pixels");
    constexpr int lines = 16;
    Coverage coverage{side, side,
                      std::vector<float>(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0.0F)};
    struct Hit {
        double x;
        int winding;
    };
    std::vector<std::vector<Hit>> hits(static_cast<std::size_t>(side) * lines);
    for (const Loop& loop : drawing.polygons) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const Point<2>& p = loop[i];
            const Point<2>& q = loop[(i + 1) % loop.size()];
            // In pixels, y down; line number l lies at y = (l + 1/2) / lines.
            const double ax = p[0] * side, ay = (1.0 - p[1]) * side, bx = q[0] * side, by = (1.0 - q[1]) * side;
            const double low = std::clamp(std::min(ay, by), 0.0, double(side)),
                         high = std::clamp(std::max(ay, by), 0.0, double(side));
            for (int l = std::max(0, static_cast<int>(low * lines) - 1);
                 l < side * lines && (l + 0.5) / lines < high + 1.0; ++l) {
                const double y = (l + 0.5) / lines;
                if ((ay <= y) == (by <= y)) continue;
                hits[static_cast<std::size_t>(l)].push_back({ax + (y - ay) / (by - ay) * (bx - ax), by > ay ? 1 : -1});
            }
        }
    }
    for (int l = 0; l < side * lines; ++l) {
        std::vector<Hit>& line = hits[static_cast<std::size_t>(l)];
        std::sort(line.begin(), line.end(), [](const Hit& a, const Hit& b) { return a.x < b.x; });
        float* const row =
            coverage.values.data() + static_cast<std::size_t>(l / lines) * static_cast<std::size_t>(side);
        int winding = 0;
        for (std::size_t i = 0; i + 1 < line.size(); ++i) {
            winding += line[i].winding;
            if (winding == 0) continue;
            const double from = std::clamp(line[i].x, 0.0, double(side)),
                         to = std::clamp(line[i + 1].x, 0.0, double(side));
            for (int column = static_cast<int>(from); column < side && column < to; ++column) {
                const double length = std::min(to, column + 1.0) - std::max(from, double(column));
                row[column] += static_cast<float>(length / lines);
            }
        }
    }
    for (float& v : coverage.values) v = std::min(v, 1.0F);
    return coverage;
}

Shape<2> shape_of(const Drawing& drawing, int level, bool centred) {
    const int side = std::clamp(4 << level, 256, 2048);
    const Outline outline = outline_of(rasterize(drawing, side));
    const OutlineMoments m = moments(outline);
    if (!(m.area > 0.0)) throw std::invalid_argument(drawing.name + " lies outside the unit square or is empty");
    Placement<2> placement{1.0 / side, {0.0, 0.0}};
    if (centred) placement.offset = {0.5 - m.centroid[0] / side, 0.5 - m.centroid[1] / side};
    Shape<2> shape;
    shape.name = drawing.name;
    shape.label = drawing.label;
    shape.level_set = signed_distance(outline, DyadicGrid<2>(level), placement);
    shape.volume = m.area / (double(side) * side);
    shape.digest = content_digest(shape.level_set);
    return shape;
}

void write_collection(const std::filesystem::path& folder, const std::vector<Drawing>& drawings, int side) {
    if (drawings.empty()) throw std::invalid_argument("a collection needs at least one shape");
    std::set<std::string> names;
    for (const Drawing& drawing : drawings) {
        if (!names.insert(drawing.name + ".png").second)
            throw std::invalid_argument("two shapes are called " + drawing.name);
    }
    prepare_collection_folder(folder, names);
    std::string labels = "file,label\n";
    for (const Drawing& drawing : drawings) {
        write_coverage(folder / (drawing.name + ".png"), rasterize(drawing, side), true);
        labels += csv_field(drawing.name + ".png") + "," + csv_field(drawing.label) + "\n";
    }
    write_text_file(folder / "labels.csv", labels);
    write_text_file(folder / "parameters.csv", parameter_table(drawings));
}

}  // namespace morphodesic::datasets
