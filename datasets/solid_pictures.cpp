#include "datasets/solid_pictures.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/RayTracer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "datasets/normalize.h"
#include "datasets/text_scan.h"
#include "datasets/vdb_files.h"

namespace morphodesic::datasets {
namespace {

using Colour = std::array<double, 3>;

/// Nine colours of viridis (van der Walt, Smith 2015), in between linear.
Colour viridis(double t) {
    static constexpr std::array<Colour, 9> table{{{0.267, 0.005, 0.329},
                                                  {0.279, 0.175, 0.483},
                                                  {0.230, 0.322, 0.546},
                                                  {0.173, 0.449, 0.558},
                                                  {0.128, 0.567, 0.551},
                                                  {0.158, 0.684, 0.502},
                                                  {0.369, 0.789, 0.383},
                                                  {0.678, 0.864, 0.190},
                                                  {0.993, 0.906, 0.144}}};
    const double s = std::clamp(std::isfinite(t) ? t : 0.0, 0.0, 1.0) * 8.0;
    const int i = std::min(static_cast<int>(s), 7);
    Colour c;
    for (int a = 0; a < 3; ++a) c[a] = table[i][a] + (s - i) * (table[i + 1][a] - table[i][a]);
    return c;
}

constexpr Colour plain{0.62, 0.70, 0.80};

Colour coloured(double t, const ColourRange& range) {
    return range.map ? range.map(t) : viridis(t);
}

double share(double value, const ColourRange& range) {
    return range.high > range.low ? (value - range.low) / (range.high - range.low) : 0.0;
}

/// Light from the upper left behind the camera; the colour belongs to the place that is seen.
class PlaceShader : public openvdb::tools::BaseShader {
public:
    PlaceShader(const ScalarField<3>* colour, const ColourRange& range, const openvdb::Vec3R& light)
        : colour_(colour), range_(range), light_(light) {}

    openvdb::tools::Film::RGBA operator()(const openvdb::Vec3R& xyz, const openvdb::Vec3R& normal,
                                          const openvdb::Vec3R& direction) const override {
        const Colour c =
            colour_ == nullptr ? plain : coloured(share(value_at(*colour_, {xyz[0], xyz[1], xyz[2]}), range_), range_);
        const double diffuse = std::max(0.0, normal.dot(light_)), facing = std::abs(normal.dot(direction));
        const double brightness = std::min(1.0, 0.28 + 0.25 * facing + 0.55 * diffuse);
        return {c[0] * brightness, c[1] * brightness, c[2] * brightness, 1.0};
    }
    [[nodiscard]] BaseShader* copy() const override { return new PlaceShader(*this); }

private:
    const ScalarField<3>* colour_;
    ColourRange range_;
    openvdb::Vec3R light_;
};

std::uint16_t byte(double v) {
    return static_cast<std::uint16_t>(std::lround(255.0 * std::clamp(v, 0.0, 1.0)));
}

}  // namespace

std::array<double, 3> turned(const Rotation& turn, const std::array<double, 3>& direction) {
    std::array<double, 3> result{};
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = 0; b < 3; ++b) result[a] += turn[3 * a + b] * direction[b];
    }
    return result;
}

std::array<double, 3> turned_back(const Rotation& turn, const std::array<double, 3>& direction) {
    std::array<double, 3> result{};
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = 0; b < 3; ++b) result[a] += turn[3 * b + a] * direction[b];
    }
    return result;
}

ViewAxes axes_of(const View& view) {
    const double azimuth = view.azimuth * std::numbers::pi / 180.0,
                 elevation = view.elevation * std::numbers::pi / 180.0;
    const auto u = static_cast<std::size_t>(view.up_axis), a = (u + 1) % 3, b = (u + 2) % 3;
    ViewAxes axes;
    axes.from[a] = std::cos(elevation) * std::cos(azimuth);
    axes.from[b] = std::cos(elevation) * std::sin(azimuth);
    axes.from[u] = std::sin(elevation);
    axes.right[a] = -std::sin(azimuth);
    axes.right[b] = std::cos(azimuth);
    axes.up[a] = -std::sin(elevation) * std::cos(azimuth);
    axes.up[b] = -std::sin(elevation) * std::sin(azimuth);
    axes.up[u] = std::cos(elevation);
    for (auto* direction : {&axes.right, &axes.up, &axes.from}) *direction = turned_back(view.turn, *direction);
    return axes;
}

PixelImage shaded_view(const LevelSet<3>& shape, const View& view, const ScalarField<3>* colour,
                       const ColourRange& range) {
    if (view.width < 16 || view.height < 16 || view.width > 4096 || view.height > 4096 || view.up_axis < 0 ||
        view.up_axis > 2 || !(view.zoom > 0)) {
        throw std::invalid_argument("shaded_view: size from 16 to 4096 pixels, up axis 0, 1 or 2, zoom > 0");
    }
    PixelImage image{view.width, view.height, 4, 255.0, {}};
    image.values.assign(4 * image.pixel_count(), 0);

    const int n = shape.grid.nodes_per_axis();
    const double h = shape.grid.spacing();
    const auto band = static_cast<float>(3.0 * h);
    std::vector<float> outward(shape.values.size());
    bool has_inside = false;
    for (int k = 0; k < n; ++k) {
        for (int j = 0; j < n; ++j) {
            for (int i = 0; i < n; ++i) {
                const std::size_t node = shape.grid.index({i, j, k});
                has_inside |= shape.values[node] > 0;
                outward[node] = std::clamp(static_cast<float>(-shape.values[node]), -band, band);
            }
        }
    }
    if (!has_inside) return image;
    auto grid = openvdb::FloatGrid::create(band);
    const openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(
        openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(n - 1)), outward.data());
    openvdb::tools::copyFromDense(dense, *grid, 0.0F);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(h));
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    // Only voxels near the surface are active, which is what the ray intersector walks through.
    for (auto it = grid->beginValueOn(); it; ++it) {
        if (std::abs(*it) >= band) it.setValueOff();
    }
    if (grid->activeVoxelCount() == 0) return image;

    const ViewAxes axes = axes_of(view);
    const openvdb::Vec3R centre(0.5, 0.5, 0.5), from(axes.from.data()), right(axes.right.data());
    const openvdb::Vec3R above(axes.up.data());
    openvdb::Vec3R light = 0.55 * from + 0.65 * from.cross(right) - 0.5 * right;
    light.normalize();

    constexpr int oversampling = 2;
    constexpr float missed = -1.0F;  // no light: the ray tracer does not keep alpha
    openvdb::tools::Film film(static_cast<std::size_t>(view.width) * oversampling,
                              static_cast<std::size_t>(view.height) * oversampling,
                              openvdb::tools::Film::RGBA(missed, missed, missed));
    const double frame = 2.0 * view_radius(view) * view.width / std::min(view.width, view.height);
    openvdb::tools::OrthographicCamera camera(film, openvdb::Vec3R(0.0), centre + 2.0 * from, frame, 1e-3, 10.0);
    camera.lookAt(centre, above);
    const PlaceShader shader(colour, range, light);
    const openvdb::tools::LevelSetRayIntersector<openvdb::FloatGrid> intersector(*grid);
    openvdb::tools::rayTrace(*grid, intersector, shader, camera);

    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            double sum[4]{};
            for (int s = 0; s < oversampling * oversampling; ++s) {
                const auto& p = film.pixel(static_cast<std::size_t>(x * oversampling + s % oversampling),
                                           static_cast<std::size_t>(y * oversampling + s / oversampling));
                if (p.r < 0) continue;
                sum[0] += p.r, sum[1] += p.g, sum[2] += p.b, sum[3] += 1.0;
            }
            auto* out = image.values.data() + 4 * (static_cast<std::size_t>(y) * view.width + x);
            for (int c = 0; c < 3; ++c) out[c] = sum[3] > 0 ? byte(sum[c] / sum[3]) : 0;
            out[3] = byte(sum[3] / (oversampling * oversampling));
        }
    }
    return image;
}

double slice_position(std::span<const LevelSet<3>> shapes, int across, const Rotation& turn) {
    constexpr int places = 64;
    const auto axis = static_cast<std::size_t>(across);
    std::array<double, places> area{};
    for (const LevelSet<3>& shape : shapes) {
        const double volume = std::pow(shape.grid.spacing(), 3);
        for (std::size_t i = 0; i < shape.values.size(); ++i) {
            if (shape.values[i] <= 0) continue;
            const Vector3 p = shape.grid.position(shape.grid.node(i));
            const double at = 0.5 + turned(turn, {p[0] - 0.5, p[1] - 0.5, p[2] - 0.5})[axis];
            // Shared between two places, as nodes of coarse grids are farther apart than places.
            const double place = std::clamp(at * places - 0.5, 0.0, places - 1.001);
            const auto below = static_cast<std::size_t>(place);
            area[below] += volume * (1.0 - (place - static_cast<double>(below)));
            area[below + 1] += volume * (place - static_cast<double>(below));
        }
    }
    std::array<double, places> smooth{};
    for (int i = 2; i < places - 2; ++i) {
        for (int d = -2; d <= 2; ++d) smooth[static_cast<std::size_t>(i)] += area[static_cast<std::size_t>(i + d)];
    }
    const double enough = 0.9 * *std::max_element(smooth.begin(), smooth.end());
    double best = 0.5, nearest = 1.0;
    for (int i = 0; i < places; ++i) {
        const double position = (i + 0.5) / places;
        if (smooth[static_cast<std::size_t>(i)] < enough || std::abs(position - 0.5) >= nearest) continue;
        best = position, nearest = std::abs(position - 0.5);
    }
    return nearest < 1.0 / places ? 0.5 : best;
}

PixelImage slice_picture(const LevelSet<3>& shape, int across, double position, int pixels,
                         const ScalarField<3>* colour, const ColourRange& range, int up_axis, double radius,
                         const Rotation& turn) {
    if (across < 0 || across > 2 || !(position >= 0.0 && position <= 1.0) || pixels < 16 || pixels > 4096 ||
        up_axis > 2 || up_axis == across || !(radius > 0.0)) {
        throw std::invalid_argument(
            "slice_picture: two different axes 0, 1 or 2, position in [0,1], 16 to 4096 pixels");
    }
    const int up = up_axis >= 0 ? up_axis : across == 2 ? 1 : 2, right = 3 - across - up;
    PixelImage image{pixels, pixels, 4, 255.0, {}};
    image.values.assign(4 * image.pixel_count(), 255);
    double stripe = 0.04;
    while (stripe > radius / 9.0) stripe /= 2.0;
    for (int y = 0; y < pixels; ++y) {
        for (int x = 0; x < pixels; ++x) {
            Vector3 p;
            p[across] = position - 0.5;
            p[right] = radius * (2.0 * (x + 0.5) / pixels - 1.0);
            p[up] = -radius * (2.0 * (y + 0.5) / pixels - 1.0);
            p = turned_back(turn, p);
            for (double& coordinate : p) coordinate += 0.5;
            const double u = value_at(shape, p);
            Colour c = u > 0 ? plain : Colour{0.93, 0.93, 0.93};
            if (u > 0 && colour != nullptr) c = coloured(share(value_at(*colour, p), range), range);
            // Two tones in turn: the level lines are where the tone changes.
            const bool odd = (static_cast<long>(std::floor(u / stripe)) & 1) != 0;
            double tone = odd ? (u > 0 ? 0.74 : 0.94) : 1.0;
            if (std::abs(u) < 2.4 * radius / pixels) tone = 0.0;
            auto* out = image.values.data() + 4 * (static_cast<std::size_t>(y) * pixels + x);
            for (int i = 0; i < 3; ++i) out[i] = byte(tone * c[i]);
        }
    }
    return image;
}

int up_axis_by_custom(const std::vector<std::string>& files) {
    std::size_t y_up = 0;
    for (const std::string& file : files) {
        const std::string ending = lower_case(file.substr(file.rfind('.') + 1));  // npos + 1 is 0
        if (ending == "obj" || ending == "off") ++y_up;
    }
    return 2 * y_up > files.size() ? 1 : 2;
}

void CommonView::add(const LevelSet<3>& shape, const Rotation& turn) {
    const auto a = static_cast<std::size_t>((up_axis_ + 1) % 3), b = static_cast<std::size_t>((up_axis_ + 2) % 3);
    double count = 0.0, mean[2]{}, square[3]{};
    for (std::size_t i = 0; i < shape.values.size(); ++i) {
        if (shape.values[i] <= 0) continue;
        const Vector3 p = shape.grid.position(shape.grid.node(i));
        const auto placed = turned(turn, {p[0] - 0.5, p[1] - 0.5, p[2] - 0.5});
        const double x = placed[a], y = placed[b];
        count += 1.0, mean[0] += x, mean[1] += y;
        square[0] += x * x, square[1] += y * y, square[2] += x * y;
    }
    if (count == 0.0) return;
    for (double& m : mean) m /= count;
    moments_[0] += square[0] / count - mean[0] * mean[0];
    moments_[1] += square[1] / count - mean[1] * mean[1];
    moments_[2] += square[2] / count - mean[0] * mean[1];
}

std::optional<double> CommonView::longest() const {
    const double difference = moments_[0] - moments_[1], sum = moments_[0] + moments_[1];
    if (std::hypot(difference, 2.0 * moments_[2]) <= 0.1 * sum) return std::nullopt;
    return 0.5 * std::atan2(2.0 * moments_[2], difference) * 180.0 / std::numbers::pi;
}

View CommonView::view() const {
    View view;
    view.up_axis = up_axis_;
    if (const auto direction = longest()) {  // else any side is as good
        // In steps, so that one solid more does not turn, and draw anew, all pictures by a share of a degree.
        view.azimuth = 5.0 * std::round((*direction + 90.0 - 25.0) / 5.0);
    }
    return view;
}

int CommonView::slice_axis() const {
    return (up_axis_ + (moments_[0] < moments_[1] ? 1 : 2)) % 3;
}

double view_radius(const View& view) {
    return 1.06 * largest_extent_radius / view.zoom;
}

ColourRange colour_range(const LevelSet<3>& shape, const ScalarField<3>& field) {
    ColourRange range{0.0, 0.0, {}};
    for (std::size_t i = 0; i < field.values.size(); ++i) {
        const Vector3 x = field.grid.position(field.grid.node(i));
        if (value_at(shape, x) > 0) range.high = std::max(range.high, field.values[i]);
    }
    return range;
}

}  // namespace morphodesic::datasets
