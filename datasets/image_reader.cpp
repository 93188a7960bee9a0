#include "datasets/image_reader.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "datasets/foreground.h"
#include "datasets/image_pixels.h"
#include "datasets/import.h"
#include "datasets/outline_geometry.h"
#include "datasets/read_error.h"

namespace morphodesic::datasets {

namespace {

PixelImage without_alpha(const PixelImage& image) {
    PixelImage result{image.width, image.height, image.colours(), image.max_value, {}};
    result.values.reserve(image.pixel_count() * static_cast<std::size_t>(result.channels));
    for (std::size_t p = 0; p < image.pixel_count(); ++p) {
        result.values.insert(result.values.end(), image.at(p), image.at(p) + result.channels);
    }
    return result;
}

/// The mask beside an image: white = hidden.
Coverage read_mask(const ShapeSource& source, const PixelImage& image, const ImportOptions& options,
                   std::vector<std::string>& notes) {
    const PixelImage mask = read_pixels(source.mask_path, options.max_megapixels, notes);
    if (mask.width != image.width || mask.height != image.height) {
        char text[160];
        std::snprintf(text, sizeof text, "the mask has %d x %d pixels, its image %d x %d", mask.width, mask.height,
                      image.width, image.height);
        throw ReadError(source.mask_path, text, "draw the mask on a copy of the image (white = hidden)");
    }
    Coverage hidden{mask.width, mask.height, std::vector<float>(mask.pixel_count())};
    for (std::size_t p = 0; p < mask.pixel_count(); ++p) {
        double value = 0.0;
        for (int k = 0; k < mask.colours(); ++k) value += mask.at(p)[k] / (mask.colours() * mask.max_value);
        if (mask.has_alpha()) value *= mask.at(p)[mask.channels - 1] / mask.max_value;
        hidden.values[p] = static_cast<float>(value);
    }
    // Masks that programs write as numbers are 0 and 1, of 255 or 65535.
    const auto [low, high] = std::minmax_element(hidden.values.begin(), hidden.values.end());
    const float darkest = *low, brightest = *high;
    const bool two = std::all_of(hidden.values.begin(), hidden.values.end(),
                                 [&](float v) { return v == darkest || v == brightest; });
    if (two && darkest == 0.0F && brightest > 0.0F && brightest <= 0.5F) {
        for (float& v : hidden.values) v = v > 0.0F ? 1.0F : 0.0F;
        notes.emplace_back("The mask has two tones, black and a dark one: the dark one is what is hidden.");
    }
    return hidden;
}

/// Some programs write a fourth channel with nothing in it.
bool has_empty_alpha(const PixelImage& image) {
    if (!image.has_alpha()) return false;
    const auto alpha = [&](std::size_t p) { return image.at(p)[image.channels - 1]; };
    for (std::size_t p = 0; p < image.pixel_count(); ++p) {
        if (alpha(p) != alpha(0)) return false;
    }
    return alpha(0) < 0.5 * image.max_value;
}

/// What is known to be hidden within the image: by the mask beside it and by the occluder's colour. Empty if nothing is:
/// a shape with a mask is taken as one that is partly hidden.
Coverage hidden_within(const ShapeSource& source, const PixelImage& image, const ImportOptions& options,
                       std::vector<std::string>& notes) {
    Coverage hidden;
    if (!source.mask_path.empty()) hidden = read_mask(source, image, options, notes);
    if (!options.occluder.empty()) {
        const Coverage occluder = occluder_pixels(image, options.occluder);
        if (hidden.values.empty()) hidden = {image.width, image.height, std::vector<float>(image.pixel_count(), 0.0F)};
        for (std::size_t p = 0; p < hidden.values.size(); ++p)
            hidden.values[p] = std::max(hidden.values[p], occluder.values[p]);
    }
    if (!hidden.values.empty() && *std::max_element(hidden.values.begin(), hidden.values.end()) <= 0.5F) {
        notes.emplace_back("Nothing is hidden by the mask or the occluder's colour.");
        return {};
    }
    return hidden;
}

/// Beyond the sides of the image that cut the object off the picture tells nothing.
void hide_beyond_border(const Coverage& object, HiddenPixels& hidden, std::vector<std::string>& notes) {
    for (int x = 0; x < object.width; ++x) {
        hidden.top = hidden.top || object.at(x, 0) >= 0.5F;
        hidden.bottom = hidden.bottom || object.at(x, object.height - 1) >= 0.5F;
    }
    for (int y = 0; y < object.height; ++y) {
        hidden.left = hidden.left || object.at(0, y) >= 0.5F;
        hidden.right = hidden.right || object.at(object.width - 1, y) >= 0.5F;
    }
    if (!hidden.left && !hidden.right && !hidden.bottom && !hidden.top) return;
    notes.emplace_back("Cut off by the border: what is beyond it counts as hidden.");
    if (hidden.pixels.values.empty()) {
        hidden.pixels = {object.width, object.height, std::vector<float>(object.values.size(), 0.0F)};
    }
}

}  // namespace

RawShape<2> read_shape_2d(const ShapeSource& source, const ImportOptions& options) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
    std::vector<std::string> notes;
    Coverage coverage;
    HiddenPixels hidden;
    {
        PixelImage image = read_pixels(source.path, options.max_megapixels, notes);
        if (has_empty_alpha(image)) {
            image = without_alpha(image);
            notes.emplace_back("Its alpha channel is the same everywhere and is left out.");
        }
        hidden.pixels = hidden_within(source, image, options, notes);
        // Transparency cannot tell both the object and what hides it.
        const bool by_colour = options.occluder == "alpha" && options.foreground == "auto";
        coverage = object_coverage(by_colour ? without_alpha(image) : image, options.foreground, hidden.pixels,
                                   source.path, notes);
    }
    if (options.border == "hides") hide_beyond_border(coverage, hidden, notes);

    Outline outline = outline_of(coverage);
    const double whole = moments(outline).area;
    const SpeckRemoval removal = remove_specks(outline, options.speck_fraction);
    if (outline.loops.empty() || removal.removed_area > 0.25 * whole) {
        throw ReadError(source.path, "there is no clear object, much of the picture is specks",
                        "use a silhouette: one shape in one tone on a plain background");
    }
    if (removal.specks + removal.pinholes > 0) {
        char text[160];
        std::snprintf(text, sizeof text, "Removed %d specks and %d pinholes, each below %g %% of the shape.",
                      removal.specks, removal.pinholes, 100.0 * options.speck_fraction);
        notes.emplace_back(text);
    }
    RawShape<2> raw = raw_shape_of(source, std::move(outline), std::move(hidden));
    if (raw.volume < 30.0) {
        char text[120];
        std::snprintf(text, sizeof text, "The shape has an area of only %.3g pixels; its outline is rough.",
                      raw.volume);
        notes.emplace_back(text);
    }
    raw.frame_low = {0.0, 0.0};
    raw.frame_high = {double(coverage.width), double(coverage.height)};
    raw.notes = std::move(notes);
    return raw;
}

template <>
RawShape<2> read_shape<2>(const ShapeSource& source, const ImportOptions& options) {
    return read_shape_2d(source, options);
}

}  // namespace morphodesic::datasets
