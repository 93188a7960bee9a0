#include <cairo-pdf.h>
#include <cairo.h>
#include <librsvg/rsvg.h>
#include <png.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>

#include "reports/figures.h"
#include "reports/svg.h"

namespace morphodesic::reports {
namespace {

struct Drawing {
    std::unique_ptr<RsvgHandle, decltype(&g_object_unref)> handle{nullptr, g_object_unref};
    double width = 0, height = 0;

    explicit Drawing(const std::string& svg) {
        GError* error = nullptr;
        GInputStream* stream =
            g_memory_input_stream_new_from_data(svg.data(), static_cast<gssize>(svg.size()), nullptr);
        // Figures with many pictures are larger than libxml2 takes from strangers; this text is our own.
        handle.reset(rsvg_handle_new_from_stream_sync(stream, nullptr, RSVG_HANDLE_FLAG_UNLIMITED, nullptr, &error));
        g_object_unref(stream);
        if (!handle) fail(error, "the figure is not an SVG document");
        if (!rsvg_handle_get_intrinsic_size_in_pixels(handle.get(), &width, &height) || width < 1 || height < 1) {
            throw std::runtime_error("the figure has no size");
        }
    }
    void draw(cairo_t* cr, double w, double h) const {
        GError* error = nullptr;
        const RsvgRectangle box = {0, 0, w, h};
        if (!rsvg_handle_render_document(handle.get(), cr, &box, &error)) fail(error, "the figure cannot be drawn");
    }
    [[noreturn]] static void fail(GError* error, std::string what) {
        if (error != nullptr) what += std::string(": ") + error->message;
        g_clear_error(&error);
        throw std::runtime_error(what);
    }
};

cairo_status_t append(void* closure, const unsigned char* part, unsigned length) {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(part), length);
    return CAIRO_STATUS_SUCCESS;
}

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

void check(cairo_status_t status) {
    if (status != CAIRO_STATUS_SUCCESS) {
        throw std::runtime_error(std::string("the figure cannot be drawn: ") + cairo_status_to_string(status));
    }
}

/// An opaque surface as PNG. Figures have few colours and long runs of them: without filters and with little effort the
/// files are 1 % larger than those that cairo writes, and a study of four disks takes half the processor time.
std::string png_of(cairo_surface_t* surface) {
    cairo_surface_flush(surface);
    const int width = cairo_image_surface_get_width(surface), height = cairo_image_surface_get_height(surface);
    std::string bytes;
    const auto failed = [](png_structp, png_const_charp message) {
        throw std::runtime_error(std::string("the figure cannot be written as PNG: ") + message);
    };
    png_structp png =
        png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, failed, [](png_structp, png_const_charp) {});
    if (png == nullptr) throw std::bad_alloc();
    png_infop info = png_create_info_struct(png);
    try {
        png_set_write_fn(
            png, &bytes,
            [](png_structp to, png_bytep part, std::size_t length) {
                static_cast<std::string*>(png_get_io_ptr(to))->append(reinterpret_cast<const char*>(part), length);
            },
            nullptr);
        png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
                     PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
        png_set_compression_level(png, 4);
        png_write_info(png, info);
        // Cairo's pixels are words 0x00RRGGBB.
        if constexpr (std::endian::native == std::endian::little) {
            png_set_bgr(png);
            png_set_filler(png, 0, PNG_FILLER_AFTER);
        } else {
            png_set_filler(png, 0, PNG_FILLER_BEFORE);
        }
        const unsigned char* row = cairo_image_surface_get_data(surface);
        for (int y = 0; y < height; ++y, row += cairo_image_surface_get_stride(surface)) png_write_row(png, row);
        png_write_end(png, info);
    } catch (...) {
        png_destroy_write_struct(&png, &info);
        throw;
    }
    png_destroy_write_struct(&png, &info);
    return bytes;
}

}  // namespace

std::string svg_to_png(const std::string& svg, int width, double scale) {
    const Drawing drawing(svg);
    const double w = width > 0 ? width : scale * drawing.width, h = w * drawing.height / drawing.width;
    const Surface surface(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::ceil(w)), static_cast<int>(std::ceil(h))),
        cairo_surface_destroy);
    check(cairo_surface_status(surface.get()));
    const Context cr(cairo_create(surface.get()), cairo_destroy);
    cairo_set_source_rgb(cr.get(), 1, 1, 1);
    cairo_paint(cr.get());
    drawing.draw(cr.get(), w, h);
    check(cairo_status(cr.get()));
    return png_of(surface.get());
}

std::string svg_to_pdf(const std::string& svg) {
    const Drawing drawing(svg);
    const double w = 0.75 * drawing.width, h = 0.75 * drawing.height;  // pixels of 1/96 inch to points
    std::string bytes;
    {
        const Surface surface(cairo_pdf_surface_create_for_stream(append, &bytes, w, h), cairo_surface_destroy);
        const Context cr(cairo_create(surface.get()), cairo_destroy);
        drawing.draw(cr.get(), w, h);
        check(cairo_status(cr.get()));
        cairo_surface_finish(surface.get());
        check(cairo_surface_status(surface.get()));
    }
    return bytes;
}

std::string raster_png(int width, int height, const std::vector<std::string>& colours) {
    const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height), cairo_surface_destroy);
    check(cairo_surface_status(surface.get()));
    unsigned char* data = cairo_image_surface_get_data(surface.get());
    const int stride = cairo_image_surface_get_stride(surface.get());
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const std::string& colour =
                colours.at(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
            const auto rgb = static_cast<std::uint32_t>(std::stoul(colour.substr(1), nullptr, 16));
            std::memcpy(data + y * stride + 4 * x, &rgb, sizeof rgb);
        }
    }
    cairo_surface_mark_dirty(surface.get());
    return png_of(surface.get());
}

}  // namespace morphodesic::reports
