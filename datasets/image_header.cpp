#include "datasets/image_header.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>

#include "datasets/read_error.h"

namespace morphodesic::datasets {

namespace {

using namespace std::string_view_literals;

struct OutOfBytes {};

std::uint64_t number(std::string_view bytes, std::size_t at, int count, bool big_endian) {
    if (at > bytes.size() || bytes.size() - at < static_cast<std::size_t>(count)) throw OutOfBytes();
    std::uint64_t result = 0;
    for (int i = 0; i < count; ++i) {
        const auto byte = static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
        result |= static_cast<std::uint64_t>(byte) << (8 * (big_endian ? count - 1 - i : i));
    }
    return result;
}

ImageHeader png(std::string_view bytes) {
    return {ImageFormat::png, double(number(bytes, 16, 4, true)), double(number(bytes, 20, 4, true))};
}

ImageHeader jpeg(std::string_view bytes) {
    for (std::size_t at = 2;;) {
        while (number(bytes, at, 1, true) != 0xff) ++at;
        while (number(bytes, at, 1, true) == 0xff) ++at;
        const std::uint64_t marker = number(bytes, at++, 1, true);
        if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) {  // start of frame
            return {ImageFormat::jpeg, double(number(bytes, at + 5, 2, true)), double(number(bytes, at + 3, 2, true))};
        }
        if (marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8)) continue;  // markers without a segment
        at += static_cast<std::size_t>(number(bytes, at, 2, true));
    }
}

ImageHeader bmp(std::string_view bytes) {
    if (number(bytes, 14, 4, false) == 12) {  // OS/2
        return {ImageFormat::bmp, double(number(bytes, 18, 2, false)), double(number(bytes, 20, 2, false))};
    }
    const auto width = static_cast<std::int32_t>(number(bytes, 18, 4, false));
    const auto height = static_cast<std::int32_t>(number(bytes, 22, 4, false));
    return {ImageFormat::bmp, std::abs(double(width)), std::abs(double(height))};  // a negative height: top row first
}

ImageHeader tiff(std::string_view bytes) {
    const bool big_endian = bytes[0] == 'M';
    const bool big_tiff = number(bytes, 2, 2, big_endian) == 43;
    const auto directory = number(bytes, big_tiff ? 8 : 4, big_tiff ? 8 : 4, big_endian);
    const auto entries = number(bytes, directory, big_tiff ? 8 : 2, big_endian);
    const std::size_t entry_size = big_tiff ? 20 : 12;
    ImageHeader header{ImageFormat::tiff, 0.0, 0.0};
    for (std::uint64_t i = 0; i < entries && i < 65536; ++i) {
        const std::size_t at = directory + (big_tiff ? 8 : 2) + i * entry_size;
        const auto tag = number(bytes, at, 2, big_endian), type = number(bytes, at + 2, 2, big_endian);
        const int size = type == 3 ? 2 : type == 16 ? 8 : 4;
        const auto value = [&] { return double(number(bytes, at + (big_tiff ? 12 : 8), size, big_endian)); };
        if (tag == 256 && header.width == 0.0) header.width = value();  // the first one counts
        if (tag == 257 && header.height == 0.0) header.height = value();
    }
    const std::size_t next = directory + (big_tiff ? 8 : 2) + entries * entry_size, size = big_tiff ? 8 : 4;
    if (entries < 65536 && next <= bytes.size() - size) {
        header.several = number(bytes, next, static_cast<int>(size), big_endian) != 0;
    }
    return header;
}

ImageHeader pnm(std::string_view bytes) {
    std::size_t at = 2;
    const auto next = [&] {
        for (;; ++at) {
            const auto c = static_cast<char>(number(bytes, at, 1, true));
            if (c == '#') {
                while (number(bytes, at, 1, true) != '\n') ++at;
            } else if (c != ' ' && c != '\t' && c != '\n' && c != '\r') {
                break;
            }
        }
        double result = 0.0;
        for (; at < bytes.size() && bytes[at] >= '0' && bytes[at] <= '9'; ++at)
            result = 10.0 * result + (bytes[at] - '0');
        return result;
    };
    const double width = next();
    return {ImageFormat::pnm, width, next()};
}

ImageHeader webp(std::string_view bytes) {
    const std::string_view chunk = bytes.substr(12, 4);
    if (chunk == "VP8X"sv) {
        return {ImageFormat::webp, 1.0 + double(number(bytes, 24, 3, false)), 1.0 + double(number(bytes, 27, 3, false)),
                (number(bytes, 20, 1, false) & 2) != 0};
    }
    if (chunk == "VP8L"sv) {
        const std::uint64_t bits = number(bytes, 21, 4, false);
        return {ImageFormat::webp, 1.0 + double(bits & 0x3fff), 1.0 + double((bits >> 14) & 0x3fff)};
    }
    return {ImageFormat::webp, double(number(bytes, 26, 2, false) & 0x3fff),
            double(number(bytes, 28, 2, false) & 0x3fff)};
}

ImageHeader gif(std::string_view bytes) {
    return {ImageFormat::gif, double(number(bytes, 6, 2, false)), double(number(bytes, 8, 2, false))};
}

/// Bytes that the uncompressed formats must have; 0 for those whose decoders notice that something is missing.
double least_size(std::string_view bytes, const ImageHeader& header) {
    const double pixels = header.width * header.height;
    if (header.format == ImageFormat::pnm) {
        switch (bytes[1]) {
            case '1':
                return pixels;
            case '2':
                return 2.0 * pixels;
            case '3':
                return 6.0 * pixels;
            case '4':
                return std::ceil(header.width / 8.0) * header.height;
            case '5':
                return pixels;
            default:
                return 3.0 * pixels;
        }
    }
    const bool old = header.format == ImageFormat::bmp && number(bytes, 14, 4, false) == 12;
    if (header.format == ImageFormat::bmp && (old || number(bytes, 30, 4, false) == 0)) {  // not run-length encoded
        const double bits = double(number(bytes, old ? 24 : 28, 2, false));
        return double(number(bytes, 10, 4, false)) + std::ceil(bits * header.width / 32.0) * 4.0 * header.height;
    }
    return 0.0;
}

std::optional<ImageHeader> header_of(std::string_view bytes) {
    const auto begins = [&](std::string_view magic) { return bytes.starts_with(magic); };
    if (begins("\x89PNG\r\n\x1a\n"sv)) return png(bytes);
    if (begins("\xff\xd8\xff"sv)) return jpeg(bytes);
    if (begins("BM"sv)) return bmp(bytes);
    if (begins("II*\0"sv) || begins("MM\0*"sv) || begins("II+\0"sv) || begins("MM\0+"sv)) return tiff(bytes);
    if (begins("RIFF"sv) && bytes.size() > 12 && bytes.substr(8, 4) == "WEBP"sv) return webp(bytes);
    if (begins("GIF87a"sv) || begins("GIF89a"sv)) return gif(bytes);
    if (bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6') return pnm(bytes);
    return std::nullopt;
}

}  // namespace

ImageHeader read_image_header(const std::filesystem::path& file, std::string_view bytes, double max_megapixels) {
    if (bytes.empty()) throw ReadError(file, "the file is empty", "copy or export it again");
    std::optional<ImageHeader> header;
    try {
        header = header_of(bytes);
    } catch (const OutOfBytes&) {
        throw ReadError(file, "the image ends within its header", "copy or export it again");
    }
    if (!header) {
        throw ReadError(file, "this is not an image of a known format",
                        "convert it to PNG, JPEG, BMP, TIFF, PNM, WebP or GIF");
    }
    if (!(header->width >= 1.0 && header->height >= 1.0)) {
        throw ReadError(file, "the image has no pixels by its header", "copy or export it again");
    }
    if (header->width * header->height > 1e6 * max_megapixels) {
        char text[120];
        std::snprintf(text, sizeof text, "the image has %.0f x %.0f pixels, more than the limit of %g million",
                      header->width, header->height, max_megapixels);
        throw ReadError(file, text, "scale it down, or raise --max-megapixels");
    }
    bool complete = false;
    try {
        complete = double(bytes.size()) >= least_size(bytes, *header);
    } catch (const OutOfBytes&) {
    }
    if (!complete) throw ReadError(file, "the image is cut off", "copy or export it again");
    return *header;
}

}  // namespace morphodesic::datasets
