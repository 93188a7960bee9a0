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

HiddenPixels read_hidden(const ShapeSource& source, const Coverage& object, const ImportOptions& options,
                         std::vector<std::string>& notes) {
    const PixelImage mask = read_pixels(source.mask_path, options.max_megapixels, notes);
    if (mask.width != object.width || mask.height != object.height) {
        char text[160];
        std::snprintf(text, sizeof text, "the mask has %d x %d pixels, its image %d x %d", mask.width, mask.height,
                      object.width, object.height);
        throw ReadError(source.mask_path, text, "draw the mask on a copy of the image (white = hidden)");
    }
    HiddenPixels hidden{mask.width, mask.height, std::vector<float>(mask.pixel_count())};
    double brightest = 0.0;
    for (std::size_t p = 0; p < mask.pixel_count(); ++p) {
        double value = 0.0;
        for (int k = 0; k < mask.colours(); ++k) value += mask.at(p)[k] / (mask.colours() * mask.max_value);
        if (mask.has_alpha()) value *= mask.at(p)[mask.channels - 1] / mask.max_value;
        hidden.values[p] = static_cast<float>(value);
        brightest = std::max(brightest, value);
    }
    if (brightest == 0.0) notes.emplace_back("The mask is black everywhere: nothing is hidden.");
    return hidden;
}

}  // namespace

RawShape<2> read_shape_2d(const ShapeSource& source, const ImportOptions& options) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
    std::vector<std::string> notes;
    Coverage coverage;
    {
        const PixelImage image = read_pixels(source.path, options.max_megapixels, notes);
        coverage = object_coverage(image, options.foreground, source.path, notes);
    }
    HiddenPixels hidden;
    if (!source.mask_path.empty()) hidden = read_hidden(source, coverage, options, notes);

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
        std::snprintf(text, sizeof text, "The shape has only %.0f pixels; its outline is rough.", raw.volume);
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
