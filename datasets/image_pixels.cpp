#include "datasets/image_pixels.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string_view>

#include "datasets/gif_reader.h"
#include "datasets/image_header.h"
#include "datasets/muted_errors.h"
#include "datasets/read_error.h"
#include "datasets/tiff_check.h"

namespace morphodesic::datasets {

namespace {

constexpr const char* again = "copy or export it again";

std::string file_bytes(const std::filesystem::path& file, double max_megapixels) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw ReadError(file, "the file cannot be opened", "check that it exists and that you may read it");
    std::error_code error;
    const auto size = std::filesystem::file_size(file, error);
    // No format needs more than this for an image within the limit; what is longer is not an image.
    const double limit = std::min(1e7 + 20.0 * 1e6 * max_megapixels, 2.1e9);
    if (!error && double(size) > limit) {
        throw ReadError(file, "the file is too large for an image within the limit of pixels",
                        "scale it down, or raise --max-megapixels");
    }
    std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (in.bad()) throw ReadError(file, "reading stopped with an error", "check the disk it lies on");
    return bytes;
}

std::uint32_t big_endian(std::string_view bytes, std::size_t at) {
    std::uint32_t result = 0;
    for (std::size_t i = 0; i < 4; ++i) result = result << 8 | static_cast<unsigned char>(bytes[at + i]);
    return result;
}

/// The orientation (1 to 8) that Exif data tell of the picture they come with; 1, as it lies, if they do not.
int exif_orientation(std::string_view exif) {
    using namespace std::string_view_literals;
    if (exif.starts_with("Exif\0\0"sv)) exif.remove_prefix(6);
    const bool big = exif.starts_with("MM"sv);
    const auto number = [&](std::size_t at, std::size_t count) {
        std::size_t result = 0;
        for (std::size_t i = 0; i < count && at + count <= exif.size(); ++i) {
            result |= std::size_t{static_cast<unsigned char>(exif[at + i])} << 8 * (big ? count - 1 - i : i);
        }
        return result;
    };
    const std::size_t directory = number(4, 4), entries = number(directory, 2);
    for (std::size_t i = 0; i < entries; ++i) {
        const std::size_t at = directory + 2 + 12 * i;
        if (number(at, 2) != 0x0112) continue;
        const std::size_t orientation = number(at + 8, 2);
        return orientation >= 1 && orientation <= 8 ? static_cast<int>(orientation) : 1;
    }
    return 1;
}

/// The picture as it is to be looked at.
cv::Mat turned(const cv::Mat& mat, int orientation) {
    cv::Mat result = mat;
    if (orientation >= 5) result = mat.t();
    constexpr int none = 2, both = -1, up_down = 0, left_right = 1;
    constexpr int flips[] = {none, none, left_right, both, up_down, none, left_right, both, up_down};
    if (flips[orientation] == none) return result;
    cv::Mat flipped;
    cv::flip(result, flipped, flips[orientation]);
    return flipped;
}

/// The chunks of a PNG that make up its pixels, after a check that all are there and undamaged. libpng would print its
/// complaints (also harmless ones about colour profiles) to stderr, and texts and profiles may be bombs of their own.
/// @param orientation  receives that of its Exif data, if it has any
/// @param notes        receives a sentence if it is an animation
std::string pixel_chunks(const std::filesystem::path& file, std::string_view bytes, int& orientation,
                         std::vector<std::string>& notes) {
    std::string result(bytes.substr(0, 8));
    for (std::size_t at = 8;;) {
        if (bytes.size() - at < 12) throw ReadError(file, "the PNG is cut off", again);
        const std::size_t length = big_endian(bytes, at);
        if (bytes.size() - at - 12 < length) throw ReadError(file, "the PNG is cut off", again);
        const std::string_view kind = bytes.substr(at + 4, 4), chunk = bytes.substr(at, length + 12);
        const bool critical = (kind[0] & 0x20) == 0;
        if (critical || kind == "tRNS") {
            const auto* checked = reinterpret_cast<const Bytef*>(bytes.data() + at + 4);
            if (crc32_z(0, checked, length + 4) != big_endian(bytes, at + 8 + length)) {
                throw ReadError(file, "the PNG is damaged (check sum of a chunk)", again);
            }
            result += chunk;
        }
        if (kind == "eXIf") orientation = exif_orientation(bytes.substr(at + 8, length));
        if (kind == "acTL") notes.emplace_back("The file is an animation: only its first picture is used.");
        if (kind == "IEND") return result;
        at += length + 12;
    }
}

/// libjpeg fills what is missing with grey and goes on; a shape must not be read in part.
void require_complete_jpeg(const std::filesystem::path& file, std::string_view bytes) {
    bool scan = false;
    for (std::size_t at = 2; at + 1 < bytes.size();) {
        const auto a = static_cast<unsigned char>(bytes[at]), b = static_cast<unsigned char>(bytes[at + 1]);
        if (a != 0xff || b == 0xff || b == 0x00 || b == 0x01 || (b >= 0xd0 && b <= 0xd8)) {
            ++at;
        } else if (b == 0xd9) {
            if (scan) return;
            break;
        } else {
            if (b == 0xda) scan = true;
            if (at + 3 >= bytes.size()) break;
            at += 2 + static_cast<std::size_t>(static_cast<unsigned char>(bytes[at + 2]) << 8 |
                                               static_cast<unsigned char>(bytes[at + 3]));
        }
    }
    throw ReadError(file, "the JPEG is cut off", again);
}

/// Numbers as text, all of them, with an end behind the last: without it OpenCV reads on, fails and prints that to
/// stderr.
void complete_text_pnm(const std::filesystem::path& file, std::string& bytes, const ImageHeader& header) {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto is_space = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
    std::size_t at = 2;
    const auto skip_number = [&](int most_digits) {
        for (bool comment = false; at < bytes.size() && (comment || !is_digit(bytes[at])); ++at) {
            const char c = bytes[at];
            if (comment) {
                comment = c != '\n' && c != '\r';
            } else if (c == '#') {
                comment = true;
            } else if (!is_space(c)) {
                throw ReadError(file, "the image is damaged, there is a character among its numbers", again);
            }
        }
        if (at == bytes.size()) throw ReadError(file, "the image is cut off", again);
        int digits = 0;
        for (; at < bytes.size() && is_digit(bytes[at]) && digits < most_digits; ++at) ++digits;
        if (most_digits > 1 && at < bytes.size() && is_digit(bytes[at])) {
            throw ReadError(file, "the image is damaged, one of its numbers is too large", again);
        }
    };
    const bool bits = bytes[1] == '1';  // need no space between them
    for (int field = 0; field < (bits ? 2 : 3); ++field) skip_number(9);
    const double count = header.width * header.height * (bytes[1] == '3' ? 3.0 : 1.0);
    for (double k = 0.0; k < count; ++k) skip_number(bits ? 1 : 9);
    if (!is_space(bytes.back())) bytes += '\n';
}

PixelImage pixels_of(const std::filesystem::path& file, const cv::Mat& decoded) {
    cv::Mat mat = decoded;
    PixelImage image;
    image.width = mat.cols;
    image.height = mat.rows;
    image.channels = mat.channels();
    if (image.channels < 1 || image.channels > 4) {
        throw ReadError(file, "the image has " + std::to_string(image.channels) + " channels",
                        "save it in grey or colour");
    }
    if (mat.depth() == CV_16U) {
        // White is the largest number of so many bits: cameras of 10, 12 and 14 write theirs into files of 16.
        double largest = 0.0;
        cv::minMaxLoc(mat.reshape(1), nullptr, &largest);
        for (const double white : {65535.0, 16383.0, 4095.0, 1023.0}) {
            if (largest <= white) image.max_value = white;
        }
    } else if (mat.depth() != CV_8U) {  // signed or floating point: its own range becomes black to white
        double low = 0.0, high = 0.0;
        cv::Mat flat = mat.reshape(1);
        if (mat.depth() == CV_32F || mat.depth() == CV_64F) flat.setTo(0.0, flat != flat);  // NaN
        cv::minMaxLoc(flat, &low, &high);
        if (!std::isfinite(low) || !std::isfinite(high))
            throw ReadError(file, "the image has infinite values", "export it with 8 or 16 bits");
        const double factor = high > low ? 65535.0 / (high - low) : 0.0;
        cv::Mat converted;
        mat.convertTo(converted, CV_16U, factor, -low * factor);
        mat = converted;
        image.max_value = 65535.0;
    }
    image.values.resize(image.pixel_count() * static_cast<std::size_t>(image.channels));
    const auto row_values = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
    for (int row = 0; row < image.height; ++row) {
        std::uint16_t* to = image.values.data() + static_cast<std::size_t>(row) * row_values;
        if (mat.depth() == CV_16U) {
            std::copy_n(mat.ptr<std::uint16_t>(row), row_values, to);
        } else {
            std::copy_n(mat.ptr<std::uint8_t>(row), row_values, to);
        }
        if (image.channels >= 3) {  // OpenCV keeps blue first
            for (int column = 0; column < image.width; ++column)
                std::swap(to[column * image.channels], to[column * image.channels + 2]);
        }
    }
    return image;
}

}  // namespace

PixelImage read_pixels(const std::filesystem::path& file, double max_megapixels, std::vector<std::string>& notes) {
    static std::once_flag silenced;
    std::call_once(silenced, [] { cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT); });
    std::string bytes = file_bytes(file, max_megapixels);
    const ImageHeader header = read_image_header(file, bytes, max_megapixels);
    if (header.format == ImageFormat::gif) return read_gif(file, bytes, max_megapixels, notes);
    if (header.format == ImageFormat::webp && header.several)
        throw ReadError(file, "this WebP file is an animation", "save the frame that is meant as PNG");
    if (header.format == ImageFormat::tiff && header.several)
        notes.emplace_back("The file has several pages: only the first is used.");
    int orientation = 1;  // that of JPEG and TIFF is applied by OpenCV
    if (header.format == ImageFormat::png) bytes = pixel_chunks(file, bytes, orientation, notes);
    if (header.format == ImageFormat::jpeg) require_complete_jpeg(file, bytes);
    if (header.format == ImageFormat::tiff) require_sound_tiff(file, bytes, header.width, header.height);
    if (header.format == ImageFormat::pnm && bytes[1] <= '3') complete_text_pnm(file, bytes, header);
    cv::Mat decoded;
    try {
        // A JPEG may say that it is turned; the other formats may have alpha, which only "unchanged" keeps.
        const int mode =
            header.format == ImageFormat::jpeg ? cv::IMREAD_ANYCOLOR | cv::IMREAD_ANYDEPTH : cv::IMREAD_UNCHANGED;
        const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8U, bytes.data());
        const MutedErrors muted;  // it prints its exceptions, without the name of the file
        decoded = cv::imdecode(buffer, mode);
    } catch (const cv::Exception&) {
        decoded.release();
    }
    if (decoded.empty())
        throw ReadError(file, "the image is cut off or damaged, or of an unusual kind",
                        "open and save it again as PNG");
    bytes.clear();
    return pixels_of(file, turned(decoded, orientation));
}

void write_png(const std::filesystem::path& file, const PixelImage& image) {
    const int channels = image.channels == 2 ? 4 : image.channels;
    cv::Mat mat(image.height, image.width, CV_8UC(channels));
    for (int row = 0; row < image.height; ++row) {
        std::uint8_t* to = mat.ptr<std::uint8_t>(row);
        for (int column = 0; column < image.width; ++column, to += channels) {
            const std::uint16_t* from = image.at(static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                                                 static_cast<std::size_t>(column));
            for (int c = 0; c < channels; ++c) {
                const int source = image.channels == 2 ? (c == 3 ? 1 : 0) : (c < 3 && channels >= 3 ? 2 - c : c);
                to[c] = static_cast<std::uint8_t>(from[source]);
            }
        }
    }
    std::vector<std::uint8_t> bytes;
    cv::imencode(".png", mat, bytes);
    std::ofstream out(file, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw WriteError(file);
}

}  // namespace morphodesic::datasets
