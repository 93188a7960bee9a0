#include "datasets/background.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

namespace morphodesic::datasets {

namespace {

using Cell = std::array<int, 3>;  // of the colour cube, 16 per axis

Cell cell_of(const Colour& c) {
    return {static_cast<int>(c[0] * 15.99F), static_cast<int>(c[1] * 15.99F), static_cast<int>(c[2] * 15.99F)};
}

struct CommonColour {
    Colour colour{};
    double share = 0.0;  ///< of the pixels that have (about) this colour
};

/// Mean colour of the most common cell of the colour cube, with the cells around it.
CommonColour most_common(const PixelImage& image, const std::vector<std::size_t>& pixels) {
    std::map<Cell, int> cells;
    for (const std::size_t p : pixels) ++cells[cell_of(colour_over(image, p, 1.0F))];
    const Cell most = std::max_element(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
                          return a.second < b.second;
                      })->first;
    std::array<double, 3> sum{};
    double n = 0.0;
    for (const std::size_t p : pixels) {
        const Colour c = colour_over(image, p, 1.0F);
        const Cell cell = cell_of(c);
        if (std::abs(cell[0] - most[0]) > 1 || std::abs(cell[1] - most[1]) > 1 || std::abs(cell[2] - most[2]) > 1)
            continue;
        for (std::size_t k = 0; k < 3; ++k) sum[k] += c[k];
        n += 1.0;
    }
    CommonColour result;
    for (std::size_t k = 0; k < 3; ++k) result.colour[k] = static_cast<float>(sum[k] / n);
    result.share = n / double(pixels.size());
    return result;
}

}  // namespace

Colour colour_over(const PixelImage& image, std::size_t pixel, float tone) {
    const std::uint16_t* v = image.at(pixel);
    const auto scale = static_cast<float>(1.0 / image.max_value);
    Colour c{};
    for (int k = 0; k < 3; ++k)
        c[static_cast<std::size_t>(k)] = scale * static_cast<float>(v[image.colours() == 3 ? k : 0]);
    if (image.has_alpha()) {
        const float alpha = scale * static_cast<float>(v[image.channels - 1]);
        for (float& x : c) x = alpha * x + (1.0F - alpha) * tone;
    }
    return c;
}

float colour_distance(const Colour& a, const Colour& b) {
    float squared = 0.0F;
    for (std::size_t k = 0; k < 3; ++k) squared += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(squared / 3.0F);
}

std::vector<std::size_t> ring_pixels(const PixelImage& image, int depth, const Coverage& hidden) {
    const int right = image.width - 1 - depth, bottom = image.height - 1 - depth;
    std::vector<std::size_t> all, seen;
    for (int y = depth; y <= bottom; ++y) {
        const int step = y == depth || y == bottom || right == depth ? 1 : right - depth;
        for (int x = depth; x <= right; x += step) {
            all.push_back(static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                          static_cast<std::size_t>(x));
        }
    }
    for (const std::size_t p : all) {
        if (hidden.values.empty() || hidden.values[p] <= 0.5F) seen.push_back(p);
    }
    return seen.empty() ? all : seen;
}

int frame_depth(const PixelImage& image, const Coverage& hidden) {
    constexpr float contrast = 0.2F;
    const int side = std::min(image.width, image.height);
    if (side < 16) return 0;
    const int deepest = std::max(3, side / 25);
    std::vector<CommonColour> rings;
    for (int d = 0; d <= deepest; ++d) rings.push_back(most_common(image, ring_pixels(image, d, hidden)));
    // The last pair of uniform rings that differ; between them lie rings of mixed colours if the frame is anti-aliased.
    int outer = -1, inner = -1;
    for (int d = 0, last = -1; d <= deepest; ++d) {
        const auto i = static_cast<std::size_t>(d);
        if (rings[i].share < 0.95) continue;
        if (last >= 0 && d - last <= 3 &&
            colour_distance(rings[static_cast<std::size_t>(last)].colour, rings[i].colour) > contrast) {
            outer = last, inner = d;
        }
        last = d;
    }
    if (outer < 0) return 0;
    // A shape that is a filled rectangle looks like that as well, but then there is nothing more inside.
    const Colour& within = rings[static_cast<std::size_t>(inner)].colour;
    double other = 0.0;
    for (int y = inner; y < image.height - inner; ++y) {
        for (int x = inner; x < image.width - inner; ++x) {
            const std::size_t p =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
            if (colour_distance(colour_over(image, p, 1.0F), within) > contrast) other += 1.0;
        }
    }
    return other > 0.005 * double(image.pixel_count()) ? inner : 0;
}

Background::Background(const PixelImage& image, int depth, const Coverage& hidden)
    : width_(image.width), height_(image.height) {
    const std::vector<std::size_t> ring = ring_pixels(image, depth, hidden);
    const CommonColour common = most_common(image, ring);
    constant_ = common.colour;
    if (common.share < 0.9 && ring.size() >= 40) fit_uneven(image, ring);
}

Background::Terms Background::terms(std::size_t pixel) const {
    const double x = 2.0 * double(pixel % static_cast<std::size_t>(width_)) / width_ - 1.0;
    const double y = 2.0 * double(pixel / static_cast<std::size_t>(width_)) / height_ - 1.0;
    return {1.0, x, y, x * x, x * y, y * y};
}

Colour Background::at(std::size_t pixel) const {
    if (!uneven_) return constant_;
    const Terms t = terms(pixel);
    Colour c{};
    for (std::size_t k = 0; k < 3; ++k) {
        double value = 0.0;
        for (std::size_t i = 0; i < 6; ++i) value += coefficients_[k][i] * t[i];
        c[k] = static_cast<float>(std::clamp(value, 0.0, 1.0));
    }
    return c;
}

/// Least squares, repeated without the pixels that do not fit (the object at the border). Given up if too many do not.
void Background::fit_uneven(const PixelImage& image, const std::vector<std::size_t>& ring) {
    using Matrix = Eigen::Matrix<double, 6, 6>;
    std::vector<std::size_t> used = ring;
    for (int round = 0; round < 6; ++round) {
        Matrix normal = Matrix::Zero();
        Eigen::Matrix<double, 6, 3> right = Eigen::Matrix<double, 6, 3>::Zero();
        for (const std::size_t p : used) {
            const Terms t = terms(p);
            const Eigen::Map<const Eigen::Matrix<double, 6, 1>> v(t.data());
            const Colour c = colour_over(image, p, 1.0F);
            normal += v * v.transpose();
            right += v * Eigen::RowVector3d(c[0], c[1], c[2]);
        }
        normal += 1e-6 * double(used.size()) * Matrix::Identity();
        const Eigen::Matrix<double, 6, 3> solution = normal.ldlt().solve(right);
        for (int k = 0; k < 3; ++k) {
            for (int i = 0; i < 6; ++i)
                coefficients_[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)] = solution(i, k);
        }
        uneven_ = true;  // so that at() gives the fit
        std::vector<float> off;
        for (const std::size_t p : ring) off.push_back(colour_distance(colour_over(image, p, 1.0F), at(p)));
        std::vector<float> sorted = off;
        std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
        const float limit = std::max(0.02F, 4.0F * sorted[sorted.size() / 2]);
        used.clear();
        for (std::size_t i = 0; i < ring.size(); ++i) {
            if (off[i] <= limit) used.push_back(ring[i]);
        }
        uneven_ = limit < 0.15F && double(used.size()) > 0.8 * double(ring.size());
        if (!uneven_) return;
    }
}

}  // namespace morphodesic::datasets
