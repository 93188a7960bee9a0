#include "datasets/occlude.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <set>
#include <stdexcept>

#include "datasets/collection_folder.h"
#include "datasets/csv_rows.h"
#include "datasets/drawing.h"
#include "datasets/image_reader.h"
#include "datasets/outline_geometry.h"
#include "datasets/random_source.h"
#include "datasets/read_error.h"

namespace morphodesic::datasets {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Lengths of shortest paths over the eight neighbours of pixels.
class PixelPaths {
public:
    PixelPaths(int width, int height)
        : width_(width), height_(height), length(count(), infinity), source(count(), std::size_t(-1)) {}

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
            if (object_.values[p] > 0.0F && key[p] < infinity) order.push_back(p);
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
        const double angle = random_.uniform(0.0, 2.0 * std::numbers::pi), c = std::cos(angle), s = std::sin(angle);
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
        paths.grow({tip}, infinity, [&](std::size_t p) { return inside(p); });
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
        paths.grow({*middle}, infinity, [&](std::size_t p) { return inside(p); });
        std::vector<std::size_t> tips;
        double first = 0.0;
        while (tips.size() < 6) {
            std::size_t farthest = *middle;
            for (const std::size_t p : pixels_) {
                if (paths.length[p] < infinity && paths.length[p] > paths.length[farthest]) farthest = p;
            }
            if (tips.empty()) first = paths.length[farthest];
            if (!tips.empty() && paths.length[farthest] < 0.5 * first) break;
            tips.push_back(farthest);
            paths.grow({farthest}, infinity, [&](std::size_t p) { return inside(p); });
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
            paths.grow({start}, infinity, free);
            size.push_back(0.0);
            for (const std::size_t p : pixels_) {
                if (paths.length[p] < infinity)
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
std::uint64_t mixed(std::uint64_t seed, const std::string& name) {
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
    if (!(fraction > 0.0 && fraction < 1.0)) result.push_back("fraction must be between 0 and 1");
    if (kind != "half-plane" && kind != "disk" && kind != "stripe" && kind != "limb") {
        result.push_back("kind must be half-plane, disk, stripe or limb, not \"" + kind + "\"");
    }
    if (per_shape < 1 || per_shape > 1000) result.push_back("the number of queries per shape must be from 1 to 1000");
    return result;
}

OccludedPicture occlude(const Coverage& object, const OcclusionOptions& options, std::uint64_t seed) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
    return Occluder(object, options, seed).hide();
}

OcclusionSummary write_occluded(const std::vector<ShapeSource>& sources, const std::filesystem::path& folder,
                                const OcclusionOptions& options, const ImportOptions& import_options) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
    const std::vector<std::string> stems = query_names(sources);
    std::vector<std::vector<std::string>> names(sources.size());
    std::set<std::string> files;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        for (int k = 0; k < options.per_shape; ++k) {
            names[i].push_back(options.per_shape == 1 ? stems[i] : stems[i] + "." + std::to_string(k + 1));
            files.insert(names[i].back() + ".png");
            files.insert(names[i].back() + ".mask.png");
        }
    }
    prepare_collection_folder(folder, files);
    OcclusionSummary summary;
    std::string truth = "file,label\n", parameters = "file,label,source,kind,hidden_share\n";
    for (std::size_t i = 0; i < sources.size(); ++i) {
        if (sources[i].dimension != 2) {
            summary.problems.push_back(
                {sources[i].path, "parts of solids cannot be hidden", "name a folder of images"});
            continue;
        }
        try {
            const Coverage object = square_picture(read_shape_2d(sources[i], import_options));
            for (const std::string& name : names[i]) {
                const OccludedPicture picture = occlude(object, options, mixed(options.seed, name));
                write_coverage(folder / (name + ".png"), picture.visible, true);
                write_coverage(folder / (name + ".mask.png"), picture.hidden, false);
                const std::string row = csv_field(name + ".png") + "," + csv_field(sources[i].label);
                truth += row + "\n";
                parameters += row + "," + csv_field(sources[i].name) + "," + options.kind + "," +
                              std::to_string(picture.hidden_share) + "\n";
                ++summary.queries;
            }
        } catch (const ReadError& error) {
            summary.problems.push_back({error.file(), error.problem(), error.remedy()});
        }
    }
    write_text_file(folder / "truth.csv", truth);
    write_text_file(folder / "parameters.csv", parameters);
    return summary;
}

}  // namespace morphodesic::datasets
