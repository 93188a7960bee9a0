#include "pipeline/figures/animation.h"

#include <oneapi/tbb/parallel_for.h>
#include <webp/encode.h>
#include <webp/mux.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "geodesic/solver/path_interpolation.h"
#include "pipeline/figures/canvas.h"
#include "pipeline/figures/path_rows.h"

namespace morphodesic::pipeline {

std::string encode_animation(const std::vector<RgbaImage>& frames, int milliseconds) {
    if (frames.empty()) throw std::runtime_error("an animation needs at least one frame");
    WebPAnimEncoderOptions options;
    WebPConfig config;
    if (!WebPAnimEncoderOptionsInit(&options) || !WebPConfigInit(&config)) {
        throw std::runtime_error("the installed libwebp does not fit this program");
    }
    config.lossless = 1;
    config.quality = 40;  // effort
    const std::unique_ptr<WebPAnimEncoder, void (*)(WebPAnimEncoder*)> encoder(
        WebPAnimEncoderNew(frames.front().width, frames.front().height, &options), WebPAnimEncoderDelete);
    int time = 0;
    for (const RgbaImage& frame : frames) {
        WebPPicture picture;
        bool good = WebPPictureInit(&picture) != 0;
        picture.use_argb = 1;
        picture.width = frame.width;
        picture.height = frame.height;
        good = good && WebPPictureImportRGBA(&picture, frame.pixels.data(), 4 * frame.width) &&
               WebPAnimEncoderAdd(encoder.get(), &picture, time, &config);
        WebPPictureFree(&picture);
        if (!good) throw std::runtime_error("a frame of an animation could not be encoded");
        time += milliseconds;
    }
    WebPData data;
    WebPDataInit(&data);
    if (!WebPAnimEncoderAdd(encoder.get(), nullptr, time, nullptr) || !WebPAnimEncoderAssemble(encoder.get(), &data)) {
        throw std::runtime_error("an animation could not be put together");
    }
    std::string bytes(reinterpret_cast<const char*>(data.bytes), data.size);
    WebPDataClear(&data);
    return bytes;
}

std::string path_animation(const GeodesicResult<2>& path, int pixels, int frames) {
    const auto rates = dissipation_rates(path);
    const double high = upper_end(rates, path.shapes);
    const auto steps = static_cast<double>(path.deformations.size());
    const Panel panel{0, 0, static_cast<double>(pixels), static_cast<double>(pixels), {0.5, 0.5}, 0.8};
    std::vector<RgbaImage> images;
    for (int i = 0; i < frames; ++i) {
        const double t = static_cast<double>(i) / std::max(frames - 1, 1);
        const LevelSet<2> u = shape_at(path, t);
        const double scaled = std::min(t * steps, steps - 1e-9);
        const auto step = static_cast<std::size_t>(scaled);
        const double share = scaled - static_cast<double>(step);
        RgbaImage image(pixels, pixels);
        oneapi::tbb::parallel_for(0, pixels, [&](int row) {
            for (int column = 0; column < pixels; ++column) {
                const Point<2> x = panel.back(column + 0.5, row + 0.5);
                const double coverage = std::clamp(0.5 + sample(u, x) * panel.scale(), 0.0, 1.0);
                Colour c{255, 255, 255};
                if (coverage > 0) {
                    // The material at x has the rate of the place it had at the beginning of the step.
                    const Point<2> from = inverse_at(path.deformations[step], x, share);
                    const Colour inside = dissipation_colour(sample(rates[step], from) / high);
                    for (std::size_t a = 0; a < 3; ++a) {
                        c[a] = static_cast<unsigned char>(std::lround(255 + coverage * (inside[a] - 255.0)));
                    }
                }
                image.set(column, row, {c[0], c[1], c[2], 255});
            }
        });
        images.push_back(std::move(image));
    }
    for (int i = frames - 2; i > 0; --i) images.push_back(images[static_cast<std::size_t>(i)]);
    return encode_animation(images, 60);
}

}  // namespace morphodesic::pipeline
