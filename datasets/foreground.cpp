#include "datasets/foreground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "datasets/background.h"
#include "datasets/read_error.h"

namespace morphodesic::datasets {

namespace {

constexpr const char* try_foreground = "if there is a shape in it, say which with --foreground dark, light or alpha";

constexpr const char* try_mask =
    "let the mask (white = hidden) leave a part of the shape and of the background visible, or take it away";

/// Values of one number per pixel, split into two classes.
struct Split {
    double threshold = 0.0;
    double low = 0.0, high = 0.0;  ///< medians of the classes
    double share_near_high = 0.0;  ///< share of the high class that is close to its median
    bool found = false;            ///< false if all values are (almost) equal
};

/// Otsu's threshold on a histogram over the range of the values; the middle of the gap if the maximum is a plateau.
Split otsu(const std::vector<float>& values, double smallest_contrast) {
    constexpr std::size_t bins = 1024;
    const auto [low_it, high_it] = std::minmax_element(values.begin(), values.end());
    const double low = *low_it, high = *high_it;
    Split split;
    if (high - low < smallest_contrast) return split;
    std::array<double, bins> count{};
    const double to_bin = (bins - 1) / (high - low);
    for (const float v : values) count[static_cast<std::size_t>((v - low) * to_bin + 0.5)] += 1.0;
    double sum = 0.0;
    for (std::size_t b = 0; b < bins; ++b) sum += double(b) * count[b];
    const double n = double(values.size());
    double below = 0.0, sum_below = 0.0, best = -1.0, first = 0.0, last = 0.0;
    for (std::size_t b = 0; b + 1 < bins; ++b) {
        below += count[b];
        sum_below += double(b) * count[b];
        if (below == 0.0 || below == n) continue;
        const double gap = sum_below / below - (sum - sum_below) / (n - below);
        const double between = below * (n - below) * gap * gap;
        if (between > best * (1.0 + 1e-12)) {
            best = between;
            first = double(b);
        }
        if (between >= best * (1.0 - 1e-12)) last = double(b);
    }
    const double threshold_bin = 0.5 * (first + last) + 0.5;
    const auto median = [&](std::size_t from, std::size_t to) {
        double all = 0.0, so_far = 0.0;
        for (std::size_t b = from; b < to; ++b) all += count[b];
        for (std::size_t b = from; b < to; ++b) {
            so_far += count[b];
            if (so_far >= 0.5 * all) return low + double(b) / to_bin;
        }
        return low + double(to) / to_bin;
    };
    const auto cut = static_cast<std::size_t>(std::ceil(threshold_bin));
    split.threshold = low + threshold_bin / to_bin;
    split.low = median(0, cut);
    split.high = median(cut, bins);
    double near = 0.0, above = 0.0;
    for (std::size_t b = cut; b < bins; ++b) {
        above += count[b];
        if (std::abs(low + double(b) / to_bin - split.high) < 0.25 * (split.high - split.low)) near += count[b];
    }
    split.share_near_high = above > 0.0 ? near / above : 0.0;
    split.found = true;
    return split;
}

class ForegroundFinder {
public:
    ForegroundFinder(const PixelImage& image, const Coverage& hidden, const std::filesystem::path& file,
                     std::vector<std::string>& notes)
        : image_(image), hidden_(hidden), file_(file), notes_(notes) {
        result_.width = image.width;
        result_.height = image.height;
        result_.values.resize(image.pixel_count());
    }

    Coverage find(const std::string& foreground) {
        if (foreground == "alpha" && !image_.has_alpha()) {
            throw ReadError(file_, "the image has no alpha channel",
                            "use another --foreground, or save it with transparency");
        }
        if (foreground == "alpha" || (foreground == "auto" && border_is_transparent())) {
            from_alpha();
        } else if (foreground == "auto") {
            from_border_colour();
        } else {
            from_brightness(foreground == "dark");
        }
        const auto object_pixels = [&] {
            return std::count_if(result_.values.begin(), result_.values.end(), [](float v) { return v >= 0.5F; });
        };
        const bool something = object_pixels() > 0;
        for (std::size_t p = 0; p < hidden_.values.size(); ++p) {
            if (hidden_.values[p] > 0.5F) result_.values[p] = 0.0F;
        }
        const auto inside = object_pixels();
        if (inside == 0 && something) {
            throw ReadError(file_, "the mask (or the occluder's colour) hides the whole shape", try_mask);
        }
        if (inside == 0) throw ReadError(file_, "the image is empty, no pixel belongs to a shape", try_foreground);
        if (static_cast<std::size_t>(inside) == result_.values.size()) {
            throw ReadError(file_, "the whole image is object, no outline can be seen", try_foreground);
        }
        return std::move(result_);
    }

private:
    bool border_is_transparent() {
        if (!image_.has_alpha()) return false;
        const auto transparent = [&](std::size_t p) {
            return image_.at(p)[image_.channels - 1] < 0.5 * image_.max_value;
        };
        const std::vector<std::size_t> border = ring_pixels(image_, 0, hidden_);
        return 2 * std::count_if(border.begin(), border.end(), transparent) >
               static_cast<std::ptrdiff_t>(border.size());
    }

    void from_alpha() {
        for (std::size_t p = 0; p < result_.values.size(); ++p) {
            result_.values[p] = rounded(image_.at(p)[image_.channels - 1] / image_.max_value);
        }
    }

    void from_border_colour() {
        const int frame = frame_depth(image_, hidden_);
        if (frame > 0) {
            notes_.emplace_back("A frame around the picture was left out; --foreground dark or light keeps it.");
        }
        const Background background(image_, frame, hidden_);
        if (background.uneven()) notes_.emplace_back("The background is lit unevenly; that was evened out.");
        for (std::size_t p = 0; p < result_.values.size(); ++p) {
            result_.values[p] =
                in_frame(p, frame) ? 0.0F : colour_distance(colour_over(image_, p, 1.0F), background.at(p));
        }
        const Split split = checked_split();
        finish(0.0, split.share_near_high > 0.8 ? split.high : 2.0 * split.threshold);
        double object = 0.0;
        const std::vector<std::size_t> ring = ring_pixels(image_, frame, hidden_);
        for (const std::size_t p : ring) object += result_.values[p] >= 0.5F ? 1.0 : 0.0;
        if (object > 0.4 * double(ring.size())) {
            char text[160];
            std::snprintf(text, sizeof text,
                          "%.0f %% of the border belongs to the object; --foreground says which part is meant.",
                          100.0 * object / double(ring.size()));
            notes_.emplace_back(text);
        }
    }

    [[nodiscard]] bool in_frame(std::size_t pixel, int depth) const {
        const int x = static_cast<int>(pixel % static_cast<std::size_t>(image_.width));
        const int y = static_cast<int>(pixel / static_cast<std::size_t>(image_.width));
        return x < depth || y < depth || x >= image_.width - depth || y >= image_.height - depth;
    }

    void from_brightness(bool dark) {
        for (std::size_t p = 0; p < result_.values.size(); ++p) {
            const Colour c = colour_over(image_, p, dark ? 1.0F : 0.0F);
            const float brightness = 0.299F * c[0] + 0.587F * c[1] + 0.114F * c[2];
            result_.values[p] = dark ? 1.0F - brightness : brightness;
        }
        const Split split = checked_split();
        const bool two_tones = split.share_near_high > 0.8;
        finish(two_tones ? split.low : 0.0, two_tones ? split.high : 2.0 * split.threshold);
    }

    /// Label images hold 0 and 1 of 255 and look black: few values need no contrast, many do.
    Split checked_split() {
        std::vector<float> seen;
        for (std::size_t p = 0; p < hidden_.values.size(); ++p) {
            if (hidden_.values[p] <= 0.5F) seen.push_back(result_.values[p]);
        }
        const std::vector<float>& values = seen.empty() ? result_.values : seen;
        std::vector<float> sample;
        for (const float v : values) {
            if (std::find(sample.begin(), sample.end(), v) == sample.end()) sample.push_back(v);
            if (sample.size() > 4) break;
        }
        const Split split = otsu(values, sample.size() > 4 ? 0.02 : 1e-7);
        if (!split.found && values.size() < result_.values.size() && otsu(result_.values, 1e-7).found) {
            throw ReadError(file_, "what the mask (or the occluder's colour) leaves visible has only one colour",
                            try_mask);
        }
        if (!split.found) {
            throw ReadError(file_,
                            sample.size() <= 1 ? "the image has only one colour" : "the image has hardly any contrast",
                            try_foreground);
        }
        return split;
    }

    /// Makes `nothing` coverage 0 and `object` coverage 1.
    void finish(double nothing, double object) {
        const double factor = 1.0 / (object - nothing);
        for (float& v : result_.values) v = rounded((v - nothing) * factor);
    }

    /// To 16 bits, so that rounding in the way here (white on black or black on white) does not change the content
    /// digest.
    static float rounded(double share) {
        return static_cast<float>(std::round(std::clamp(share, 0.0, 1.0) * 65535.0) / 65535.0);
    }

    const PixelImage& image_;
    const Coverage& hidden_;
    const std::filesystem::path& file_;
    std::vector<std::string>& notes_;
    Coverage result_;
};

}  // namespace

Coverage object_coverage(const PixelImage& image, const std::string& foreground, const Coverage& hidden,
                         const std::filesystem::path& file, std::vector<std::string>& notes) {
    return ForegroundFinder(image, hidden, file, notes).find(foreground);
}

Coverage occluder_pixels(const PixelImage& image, const std::string& occluder) {
    Colour colour{};
    if (occluder != "alpha") {
        for (std::size_t k = 0; k < 3; ++k)
            colour[k] = static_cast<float>(std::stoi(occluder.substr(1 + 2 * k, 2), nullptr, 16)) / 255.0F;
    }
    std::vector<bool> found(image.pixel_count());
    for (std::size_t p = 0; p < found.size(); ++p) {
        if (occluder == "alpha") {
            found[p] = image.has_alpha() && image.at(p)[image.channels - 1] < 0.5 * image.max_value;
            continue;
        }
        found[p] = colour_distance(colour_over(image, p, 1.0F), colour) < 0.05F;
    }
    // A single pixel of this colour may be a mixture of object and background at an edge; occluders are wider.
    const auto at = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < image.width && y < image.height &&
               found[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)];
    };
    Coverage hidden{image.width, image.height, std::vector<float>(image.pixel_count(), 0.0F)};
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            if (!at(x, y) || !(at(x - 1, y) || at(x + 1, y)) || !(at(x, y - 1) || at(x, y + 1))) continue;
            for (int b = std::max(0, y - 1); b <= std::min(image.height - 1, y + 1); ++b) {
                for (int a = std::max(0, x - 1); a <= std::min(image.width - 1, x + 1); ++a) {
                    hidden.values[static_cast<std::size_t>(b) * static_cast<std::size_t>(image.width) +
                                  static_cast<std::size_t>(a)] = 1.0F;
                }
            }
        }
    }
    return hidden;
}

}  // namespace morphodesic::datasets
