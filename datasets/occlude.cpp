#include "datasets/occlude.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <queue>
#include <set>
#include <stdexcept>
#include <string_view>

#include "datasets/collection_folder.h"
#include "datasets/csv_rows.h"
#include "datasets/drawing.h"
#include "datasets/image_reader.h"
#include "datasets/outline_geometry.h"
#include "datasets/random_source.h"
#include "datasets/read_error.h"
#include "datasets/solid_reader.h"
#include "datasets/vdb_files.h"

namespace morphodesic::datasets {

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

/// Lengths of shortest paths over the eight neighbours of pixels.
class PixelPaths {
public:
    PixelPaths(int width, int height)
        : width_(width), height_(height), length(count(), unbounded), source(count(), std::size_t(-1)) {}

    /// Extends the paths from `starts` over the pixels that `allowed(pixel)` admits, up to a length.
    template <class Allowed>
    void grow(const std::vector<std::size_t>& starts, double limit, Allowed&& allowed) {
        using Entry = std::pair<double, std::size_t>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        for (const std::size_t p : starts) {
            length[p] = 0.0;
            source[p] = p;
            queue.emplace(0.0, p);
        }
        while (!queue.empty()) {
            const auto [at, p] = queue.top();
            queue.pop();
            if (at > length[p]) continue;
            const int x = static_cast<int>(p % static_cast<std::size_t>(width_)),
                      y = static_cast<int>(p / static_cast<std::size_t>(width_));
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    if (x + dx < 0 || y + dy < 0 || x + dx >= width_ || y + dy >= height_) continue;
                    const std::size_t q = static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(width_) +
                                          static_cast<std::size_t>(x + dx);
                    const double next = at + (dx != 0 && dy != 0 ? std::numbers::sqrt2 : 1.0);
                    if (next >= length[q] || next > limit || !allowed(q)) continue;
                    length[q] = next;
                    source[q] = source[p];
                    queue.emplace(next, q);
                }
            }
        }
    }

private:
    [[nodiscard]] std::size_t count() const {
        return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    }
    int width_, height_;

public:
    std::vector<double> length;
    std::vector<std::size_t> source;  ///< the start from which the pixel is reached
};

class Occluder {
public:
    Occluder(const Coverage& object, const OcclusionOptions& options, std::uint64_t seed)
        : object_(object), options_(options), random_(seed) {
        for (std::size_t p = 0; p < object.values.size(); ++p) {
            area_ += object.values[p];
            if (object.values[p] >= 0.5F) pixels_.push_back(p);
        }
        if (pixels_.empty()) throw std::invalid_argument("there is no object to hide a part of");
    }

    OccludedPicture hide() {
        result_.hidden = {object_.width, object_.height, std::vector<float>(object_.values.size(), 0.0F)};
        if (options_.kind == "limb") {
            hide_limb();
        } else {
            hide_region();
        }
        if (options_.largest_part) hide_small_parts();
        result_.visible = object_;
        double visible = 0.0;
        for (std::size_t p = 0; p < object_.values.size(); ++p) {
            if (hidden(p)) result_.visible.values[p] = 0.0F;
            visible += result_.visible.values[p];
        }
        result_.hidden_share = 1.0 - visible / area_;
        return std::move(result_);
    }

private:
    [[nodiscard]] double x(std::size_t p) const { return double(p % static_cast<std::size_t>(object_.width)); }
    [[nodiscard]] double y(std::size_t p) const { return double(p / static_cast<std::size_t>(object_.width)); }
    [[nodiscard]] bool hidden(std::size_t p) const { return result_.hidden.values[p] > 0.0F; }
    [[nodiscard]] bool inside(std::size_t p) const { return object_.values[p] >= 0.5F; }
    std::size_t random_pixel() {
        return pixels_[std::min(pixels_.size() - 1,
                                static_cast<std::size_t>(random_.uniform(0.0, double(pixels_.size()))))];
    }

    /// The value up to which a share of the object's area lies.
    double quantile(const std::vector<double>& key) const {
        std::vector<std::size_t> order;
        for (std::size_t p = 0; p < key.size(); ++p) {
            if (object_.values[p] > 0.0F && key[p] < unbounded) order.push_back(p);
        }
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key[a] < key[b]; });
        double so_far = 0.0;
        for (const std::size_t p : order) {
            so_far += object_.values[p];
            if (so_far >= options_.fraction * area_) return key[p];
        }
        return order.empty() ? 0.0 : key[order.back()];
    }

    void hide_region() {
        double angle = random_.uniform(0.0, 2.0 * std::numbers::pi);
        // Rows run downwards, and the smallest values are hidden.
        if (!options_.direction.empty()) angle = std::atan2(options_.direction[1], -options_.direction[0]);
        const double c = std::cos(angle), s = std::sin(angle);
        const std::size_t centre = random_pixel();
        std::vector<double> key(object_.values.size());
        for (std::size_t p = 0; p < key.size(); ++p) {
            const double dx = x(p) - x(centre), dy = y(p) - y(centre);
            key[p] = options_.kind == "disk"     ? std::hypot(dx, dy)
                     : options_.kind == "stripe" ? std::abs(c * dx + s * dy)
                                                 : c * dx + s * dy;
        }
        const double limit = quantile(key);
        for (std::size_t p = 0; p < key.size(); ++p) result_.hidden.values[p] = key[p] <= limit ? 1.0F : 0.0F;
    }

    void hide_limb() {
        const std::vector<std::size_t> tips = find_tips();
        const std::size_t tip =
            tips[std::min(tips.size() - 1, static_cast<std::size_t>(random_.uniform(0.0, double(tips.size()))))];
        PixelPaths paths(object_.width, object_.height);
        paths.grow({tip}, unbounded, [&](std::size_t p) { return inside(p); });
        const double limit = quantile(paths.length);
        // Background within a seam around the limb is hidden as well, or the mask would show the outline; but not what
        // is nearer to the rest of the object.
        PixelPaths around(object_.width, object_.height);
        const double seam = 2.0 + 0.08 * std::sqrt(area_);
        around.grow(pixels_, seam, [&](std::size_t p) { return !inside(p); });
        for (std::size_t p = 0; p < object_.values.size(); ++p) {
            const std::size_t from = around.source[p];
            if (from != std::size_t(-1) && paths.length[from] <= limit) result_.hidden.values[p] = 1.0F;
        }
    }

    /// Points of the object far from its middle and from each other, measured within the object.
    std::vector<std::size_t> find_tips() {
        double mx = 0.0, my = 0.0;
        for (const std::size_t p : pixels_) mx += x(p) / double(pixels_.size()), my += y(p) / double(pixels_.size());
        const auto middle = std::min_element(pixels_.begin(), pixels_.end(), [&](std::size_t a, std::size_t b) {
            return std::hypot(x(a) - mx, y(a) - my) < std::hypot(x(b) - mx, y(b) - my);
        });
        PixelPaths paths(object_.width, object_.height);
        paths.grow({*middle}, unbounded, [&](std::size_t p) { return inside(p); });
        std::vector<std::size_t> tips;
        double first = 0.0;
        while (tips.size() < 6) {
            std::size_t farthest = *middle;
            for (const std::size_t p : pixels_) {
                if (paths.length[p] < unbounded && paths.length[p] > paths.length[farthest]) farthest = p;
            }
            if (tips.empty()) first = paths.length[farthest];
            if (!tips.empty() && paths.length[farthest] < 0.5 * first) break;
            tips.push_back(farthest);
            paths.grow({farthest}, unbounded, [&](std::size_t p) { return inside(p); });
        }
        return tips;
    }

    void hide_small_parts() {
        std::vector<int> part(object_.values.size(), -1);
        std::vector<double> size;
        const auto free = [&](std::size_t p) { return inside(p) && !hidden(p); };
        for (const std::size_t start : pixels_) {
            if (!free(start) || part[start] >= 0) continue;
            PixelPaths paths(object_.width, object_.height);
            paths.grow({start}, unbounded, free);
            size.push_back(0.0);
            for (const std::size_t p : pixels_) {
                if (paths.length[p] < unbounded)
                    part[p] = static_cast<int>(size.size()) - 1, size.back() += object_.values[p];
            }
        }
        if (size.size() < 2) return;
        const int largest = static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin());
        PixelPaths around(object_.width, object_.height);
        std::vector<std::size_t> starts;
        for (const std::size_t p : pixels_) {
            if (free(p)) starts.push_back(p);
        }
        around.grow(starts, 3.0, [&](std::size_t p) { return !free(p); });
        for (std::size_t p = 0; p < object_.values.size(); ++p) {
            if (around.source[p] != std::size_t(-1) && part[around.source[p]] != largest)
                result_.hidden.values[p] = 1.0F;
        }
    }

    const Coverage& object_;
    const OcclusionOptions& options_;
    RandomSource random_;
    double area_ = 0.0;
    std::vector<std::size_t> pixels_;  // of the object
    OccludedPicture result_;
};

/// The same for the same name, whatever else is in the collection (FNV-1a).
std::uint64_t mixed(std::uint64_t seed, std::string_view name) {
    std::uint64_t h = 0xcbf29ce484222325ULL ^ (seed * 0x9e3779b97f4a7c15ULL);
    for (const char c : name) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    return h;
}

/// The shape in a square picture of its own pixels, with some background around it.
Coverage square_picture(const RawShape<2>& raw) {
    const auto& geometry = dynamic_cast<const OutlineGeometry&>(*raw.geometry);
    const double reach = 1.15 * raw.extent_radius + 4.0;
    const int side = std::clamp(static_cast<int>(std::ceil(2.0 * reach)), 16, 2048);
    Drawing drawing;
    drawing.polygons = geometry.outline().loops;
    for (Loop& loop : drawing.polygons) {
        for (Point<2>& p : loop)
            p = {0.5 + (p[0] - raw.centroid[0]) / (2.0 * reach), 0.5 + (p[1] - raw.centroid[1]) / (2.0 * reach)};
    }
    return rasterize(drawing, side);
}

/// File names for the queries: folders become part of the name, the ending goes.
std::vector<std::string> query_names(const std::vector<ShapeSource>& sources) {
    std::vector<std::string> names;
    std::set<std::string> used;
    for (const ShapeSource& source : sources) {
        std::string name = source.name.substr(0, source.name.rfind('.'));
        const std::size_t slash = name.rfind('/');
        // "cat/cat-1" need not become "cat_cat-1".
        if (slash != std::string::npos && name.substr(slash + 1).starts_with(name.substr(0, slash)))
            name = name.substr(slash + 1);
        std::replace(name.begin(), name.end(), '/', '_');
        while (!used.insert(name).second) name += "+";
        names.push_back(name);
    }
    return names;
}

}  // namespace

std::vector<std::string> OcclusionOptions::problems() const {
    std::vector<std::string> result;
    if (!(fraction > 0.0 && fraction < 1.0)) result.push_back("the fraction must be above 0 and below 1");
    if (kind != "half-plane" && kind != "disk" && kind != "stripe" && kind != "limb") {
        result.push_back("kind must be half-plane, disk, stripe or limb, not \"" + kind + "\"");
    }
    if (!direction.empty()) {
        const bool usable = direction.size() >= 2 && direction.size() <= 3 &&
                            std::any_of(direction.begin(), direction.end(), [](double d) { return d != 0.0; });
        if (!usable) result.push_back("a direction has two numbers (x,y), for solids three (x,y,z), not all zero");
        if (kind != "half-plane") result.push_back("only half-plane has a direction");
        if (per_shape > 1) {
            result.push_back(
                "with a direction all queries of a shape are the same; leave it out, or make one per shape");
        }
    }
    if (per_shape < 1 || per_shape > 1000) result.push_back("the number of queries per shape must be from 1 to 1000");
    return result;
}

OccludedPicture occlude(const Coverage& object, const OcclusionOptions& options, std::uint64_t seed) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
    return Occluder(object, options, seed).hide();
}

OccludedPicture hide_polygons(const Drawing& drawing, const std::vector<std::size_t>& part, double margin, int side) {
    Drawing hidden = drawing, rest = drawing;
    hidden.polygons.clear();
    rest.polygons.clear();
    for (std::size_t i = 0; i < drawing.polygons.size(); ++i) {
        const bool is_hidden = std::find(part.begin(), part.end(), i) != part.end();
        (is_hidden ? hidden : rest).polygons.push_back(drawing.polygons[i]);
    }
    const Coverage whole = rasterize(drawing, side), cover = rasterize(hidden, side);
    OccludedPicture result{rasterize(rest, side), {side, side, std::vector<float>(whole.values.size(), 0.0F)}, 0.0};
    std::vector<std::size_t> starts;
    for (std::size_t p = 0; p < cover.values.size(); ++p) {
        if (cover.values[p] > 0.0F) starts.push_back(p);
    }
    PixelPaths around(side, side);
    around.grow(starts, margin * side, [](std::size_t) { return true; });
    double all = 0.0, visible = 0.0;
    for (std::size_t p = 0; p < whole.values.size(); ++p) {
        if (around.length[p] < unbounded && result.visible.values[p] < 0.5F) {
            result.hidden.values[p] = 1.0F;
            result.visible.values[p] = 0.0F;
        }
        all += whole.values[p];
        visible += result.visible.values[p];
    }
    if (all > 0.0) result.hidden_share = 1.0 - visible / all;
    return result;
}

TriangleMesh cut_by_plane(const TriangleMesh& closed_mesh, double fraction, const Vector3& direction) {
    const double length = norm(direction), total = signed_volume(closed_mesh);
    if (!(length > 0.0)) throw std::invalid_argument("the direction of a cut is zero");
    if (!(total > 0.0)) throw std::invalid_argument("there is no solid to hide a part of");
    const Vector3 normal = (1.0 / length) * direction;
    double low = unbounded, high = -unbounded;
    for (const auto& p : closed_mesh.points) low = std::min(low, dot(p, normal)), high = std::max(high, dot(p, normal));
    // Polygons of the triangles on one side of the plane {dot(x, normal) = offset}.
    const auto clipped = [&](double offset, double side, auto&& visit) {
        for (std::size_t t = 0; t < closed_mesh.triangles.size(); ++t) {
            const auto corners = closed_mesh.corners(t);
            std::vector<Vector3> polygon;
            for (std::size_t c = 0; c < 3; ++c) {
                const Vector3 &a = corners[c], &b = corners[(c + 1) % 3];
                const double da = side * (dot(a, normal) - offset), db = side * (dot(b, normal) - offset);
                if (da >= 0.0) polygon.push_back(a);
                if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) polygon.push_back(a + (da / (da - db)) * (b - a));
            }
            for (std::size_t c = 2; c < polygon.size(); ++c) visit(polygon[0], polygon[c - 1], polygon[c]);
        }
    };
    // Volume beyond the plane: seen from a point of the plane, the cut itself encloses nothing.
    const auto beyond = [&](double offset) {
        const Vector3 apex = offset * normal;
        double sum = 0.0;
        clipped(offset, 1.0, [&](const Vector3& a, const Vector3& b, const Vector3& c) {
            sum += dot(a - apex, cross(b - apex, c - apex)) / 6.0;
        });
        return sum;
    };
    for (int k = 0; k < 40; ++k) {
        const double middle = 0.5 * (low + high);
        (beyond(middle) > fraction * total ? low : high) = middle;
    }
    TriangleMesh result;
    clipped(0.5 * (low + high), -1.0, [&](const Vector3& a, const Vector3& b, const Vector3& c) {
        const int first = static_cast<int>(result.points.size());
        result.points.insert(result.points.end(), {a, b, c});
        result.triangles.push_back({first, first + 1, first + 2});
    });
    clean(result);
    return result;
}

namespace {

/// The tables beside queries.
class QueryTables {
public:
    void add(const std::string& file, const std::string& label, const std::string& source, const std::string& kind,
             double hidden_share) {
        const std::string row = csv_field(file) + "," + csv_field(label);
        truth_ += row + "\n";
        parameters_ +=
            row + "," + csv_field(source) + "," + csv_field(kind) + "," + std::to_string(hidden_share) + "\n";
    }
    void write(const std::filesystem::path& folder) const {
        write_text_file(folder / "truth.csv", truth_);
        write_text_file(folder / "parameters.csv", parameters_);
    }

private:
    std::string truth_ = "file,label\n", parameters_ = "file,label,source,kind,hidden_share\n";
};

void write_picture(const std::filesystem::path& folder, const std::string& name, const OccludedPicture& picture) {
    write_coverage(folder / (name + ".png"), picture.visible, true);
    write_coverage(folder / (name + ".mask.png"), picture.hidden, false);
}

/// A picture whose mask is another one than those of before; nothing if none is found.
/// @param there  digests of the masks of before; that of the new one is added
std::optional<OccludedPicture> fresh_picture(const Coverage& object, const OcclusionOptions& options,
                                             const std::string& name, std::set<std::uint64_t>& there) {
    constexpr int tries = 30;  // of six limbs the last one is missed once in 200 times
    for (int again = 0; again < tries; ++again) {
        const std::string seeding = again == 0 ? name : name + " " + std::to_string(again);
        OccludedPicture picture = occlude(object, options, mixed(options.seed, seeding));
        const std::vector<float>& mask = picture.hidden.values;
        const std::string_view bytes(reinterpret_cast<const char*>(mask.data()), mask.size() * sizeof(float));
        if (there.insert(mixed(0, bytes)).second) return picture;
    }
    return std::nullopt;
}

Vector3 random_direction(RandomSource& random) {
    for (;;) {
        const Vector3 d{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
        if (norm(d) > 0.1 && norm(d) <= 1.0) return d;
    }
}

}  // namespace

void write_hidden_limbs(const std::vector<Drawing>& men, const std::filesystem::path& folder, int side,
                        std::uint64_t seed) {
    std::set<std::string> files;
    for (const Drawing& man : men) files.insert({man.name + ".png", man.name + ".mask.png"});
    prepare_collection_folder(folder, files);
    QueryTables tables;
    for (const Drawing& man : men) {
        RandomSource random(mixed(seed, man.name));
        // Torso, head, then right arm, left arm, right leg, left leg: two polygons each.
        const std::size_t arm = random.uniform(0.0, 1.0) < 0.5 ? 2 : 4, leg = random.uniform(0.0, 1.0) < 0.5 ? 6 : 8;
        const OccludedPicture picture = hide_polygons(man, {arm, arm + 1, leg, leg + 1}, 0.03, side);
        write_picture(folder, man.name, picture);
        const std::string kind =
            std::string(arm == 2 ? "right" : "left") + " arm and " + (leg == 6 ? "right" : "left") + " leg";
        tables.add(man.name + ".png", man.label, man.name, kind, picture.hidden_share);
    }
    tables.write(folder);
}

OcclusionSummary write_occluded(const std::vector<ShapeSource>& sources, const std::filesystem::path& folder,
                                const OcclusionOptions& options, const ImportOptions& import_options) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
    keep_apart_from(sources, folder);
    const std::vector<std::string> stems = query_names(sources);
    std::vector<std::vector<std::string>> names(sources.size());
    std::set<std::string> files;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        for (int k = 0; k < options.per_shape; ++k) {
            names[i].push_back(options.per_shape == 1 ? stems[i] : stems[i] + "." + std::to_string(k + 1));
            if (sources[i].dimension == 3) {
                files.insert(names[i].back() + ".ply");
            } else {
                files.insert({names[i].back() + ".png", names[i].back() + ".mask.png"});
            }
        }
    }
    prepare_collection_folder(folder, files);
    OcclusionSummary summary;
    QueryTables tables;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const bool solid = sources[i].dimension == 3;
        if (solid && options.kind != "half-plane") {
            summary.problems.push_back({sources[i].path, "parts of solids can only be cut off by planes",
                                        "use --kind half-plane, or name a folder of images"});
            continue;
        }
        if (!options.direction.empty() && options.direction.size() != (solid ? 3U : 2U)) {
            summary.problems.push_back({sources[i].path, "the direction has the wrong number of coordinates",
                                        solid ? "give three: x,y,z" : "give two: x,y (y up)"});
            continue;
        }
        try {
            const auto add = [&](const std::string& file, double hidden_share) {
                tables.add(file, sources[i].label, sources[i].name, options.kind, hidden_share);
                ++summary.queries;
            };
            if (solid) {
                const RawShape<3> raw = read_shape_3d(sources[i], import_options);
                const TriangleMesh& mesh = dynamic_cast<const SolidGeometry&>(*raw.geometry).mesh();
                for (const std::string& name : names[i]) {
                    RandomSource random(mixed(options.seed, name));
                    const Vector3 direction =
                        options.direction.empty()
                            ? random_direction(random)
                            : Vector3{options.direction[0], options.direction[1], options.direction[2]};
                    write_ply(folder / (name + ".ply"), cut_by_plane(mesh, options.fraction, direction));
                    add(name + ".ply", options.fraction);
                }
                continue;
            }
            const Coverage object = square_picture(read_shape_2d(sources[i], import_options));
            std::set<std::uint64_t> there;
            bool more = true;  // after the first one that is not found there are no others
            for (const std::string& name : names[i]) {
                const auto picture = more ? fresh_picture(object, options, name, there) : std::nullopt;
                more = picture.has_value();
                if (picture) {
                    write_picture(folder, name, *picture);
                    add(name + ".png", picture->hidden_share);
                } else {
                    ++summary.repeated;
                    for (const char* ending : {".png", ".mask.png"}) std::filesystem::remove(folder / (name + ending));
                }
            }
        } catch (const ReadError& error) {
            summary.problems.push_back({error.file(), error.problem(), error.remedy()});
        }
    }
    if (summary.queries > 0) tables.write(folder);
    return summary;
}

}  // namespace morphodesic::datasets
