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
#include "pipeline/path_pictures.h"
#include "pipeline/solid_paths.h"

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

namespace {

/// Frames at equal times, frame(t, shape at t, its rate) -> picture, there and back.
template <int Dim, class Frame>
std::string animated(const GeodesicResult<Dim>& path, int frames, const Frame& frame) {
    const auto rates = dissipation_of_steps(path);
    const double high = upper_end<Dim>(rates, path.shapes);
    std::vector<RgbaImage> images;
    for (int i = 0; i < frames; ++i) {
        const double t = static_cast<double>(i) / std::max(frames - 1, 1);
        const LevelSet<Dim> u = shape_at(path, t);
        images.push_back(frame(u, carried_rate(path, rates, t, u), high));
    }
    for (int i = frames - 2; i > 0; --i) images.push_back(images[static_cast<std::size_t>(i)]);
    return encode_animation(images, 60);
}

RgbaImage on_white(RgbaImage image) {
    for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
        const double alpha = image.pixels[i + 3] / 255.0;
        for (std::size_t c = 0; c < 3; ++c) {
            image.pixels[i + c] = static_cast<unsigned char>(std::lround(255 + alpha * (image.pixels[i + c] - 255.0)));
        }
        image.pixels[i + 3] = 255;
    }
    return image;
}

}  // namespace

std::string path_animation(const GeodesicResult<2>& path, int pixels, int frames) {
    const Panel panel{0, 0, static_cast<double>(pixels), static_cast<double>(pixels), {0.5, 0.5}, 0.8};
    return animated(path, frames, [&](const LevelSet<2>& u, const ScalarField<2>& rate, double high) {
        RgbaImage image(pixels, pixels);
        oneapi::tbb::parallel_for(0, pixels, [&](int row) {
            for (int column = 0; column < pixels; ++column) {
                const Point<2> x = panel.back(column + 0.5, row + 0.5);
                const double coverage = std::clamp(0.5 + sample(u, x) * panel.scale(), 0.0, 1.0);
                const Colour c = dissipation_colour(sample(rate, x) / high);
                image.set(column, row, {c[0], c[1], c[2], static_cast<unsigned char>(std::lround(255 * coverage))});
            }
        });
        return on_white(std::move(image));
    });
}

std::string path_animation(const GeodesicResult<3>& path, const datasets::View& camera, int frames) {
    return animated(path, frames, [&](const LevelSet<3>& u, const ScalarField<3>& rate, double high) {
        return on_white(shaded_picture(u, camera, &rate, high));
    });
}

}  // namespace morphodesic::pipeline
