#include "datasets/tiff_check.h"

#include <tiffio.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "datasets/read_error.h"

namespace morphodesic::datasets {
namespace {

/// The file in memory, as libtiff asks for it.
struct Memory {
    std::string_view bytes;
    toff_t at = 0;
};

tmsize_t read_bytes(thandle_t handle, void* to, tmsize_t count) {
    Memory& memory = *static_cast<Memory*>(handle);
    const toff_t size = memory.bytes.size(), left = memory.at < size ? size - memory.at : 0;
    const auto taken = std::min(static_cast<toff_t>(std::max<tmsize_t>(count, 0)), left);
    std::memcpy(to, memory.bytes.data() + std::min(memory.at, size), static_cast<std::size_t>(taken));
    memory.at += taken;
    return static_cast<tmsize_t>(taken);
}

tmsize_t write_nothing(thandle_t, void*, tmsize_t) {
    return 0;
}

toff_t seek(thandle_t handle, toff_t offset, int whence) {
    Memory& memory = *static_cast<Memory*>(handle);
    memory.at = offset + (whence == SEEK_CUR ? memory.at : whence == SEEK_END ? memory.bytes.size() : 0);
    return memory.at;
}

int close_nothing(thandle_t) {
    return 0;
}

toff_t size_of(thandle_t handle) {
    return static_cast<Memory*>(handle)->bytes.size();
}

/// What libtiff complains of is said by whoever finds a strip missing.
int be_silent(TIFF*, void*, const char*, const char*, va_list) {
    return 1;
}

struct Closer {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
    void operator()(TIFFOpenOptions* options) const { TIFFOpenOptionsFree(options); }
};

/// Whether every strip or tile can be unpacked to its full length.
bool all_parts_unpack(TIFF* tiff, double most_bytes) {
    const bool tiled = TIFFIsTiled(tiff) != 0;
    const tmsize_t size = tiled ? TIFFTileSize(tiff) : TIFFStripSize(tiff);
    if (size <= 0 || static_cast<double>(size) > most_bytes) return false;
    std::vector<unsigned char> part(static_cast<std::size_t>(size));
    const std::uint32_t parts = tiled ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
    for (std::uint32_t k = 0; k < parts; ++k) {
        const tmsize_t unpacked =
            tiled ? TIFFReadEncodedTile(tiff, k, part.data(), size) : TIFFReadEncodedStrip(tiff, k, part.data(), size);
        if (unpacked <= 0) return false;
    }
    return true;
}

}  // namespace

void require_sound_tiff(const std::filesystem::path& file, std::string_view bytes, double width, double height) {
    const std::unique_ptr<TIFFOpenOptions, Closer> options(TIFFOpenOptionsAlloc());
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), be_silent, nullptr);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), be_silent, nullptr);
    Memory memory{bytes};
    const std::unique_ptr<TIFF, Closer> tiff(TIFFClientOpenExt(
        "", "rm", &memory, read_bytes, write_nothing, seek, close_nothing, size_of, nullptr, nullptr, options.get()));
    const char* again = "copy or export it again";
    if (!tiff) throw ReadError(file, "the TIFF is cut off or damaged", again);
    std::uint32_t columns = 0, rows = 0;
    std::uint16_t planes = PLANARCONFIG_CONTIG, bits = 1, samples = 1, packing = COMPRESSION_NONE;
    TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &columns);
    TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &rows);
    TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_PLANARCONFIG, &planes);
    TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_BITSPERSAMPLE, &bits);
    TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, &samples);
    TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_COMPRESSION, &packing);
    if (columns != width || rows != height) throw ReadError(file, "the TIFF gives its size twice", again);
    if (planes == PLANARCONFIG_SEPARATE && samples > 1 && bits > 8) {
        throw ReadError(file, "its colours lie in separate planes of more than 8 bits",
                        "save it with interleaved (contiguous) colours, or as PNG");
    }
    if (TIFFIsCODECConfigured(packing) == 0) return;  // then the decoder refuses it
    // A strip is no longer than the picture, a tile not much.
    const double most_bytes = 1e7 + 2.0 * width * height * samples * std::max<double>(bits, 8.0) / 8.0;
    if (!all_parts_unpack(tiff.get(), most_bytes)) {
        throw ReadError(file, "the TIFF is cut off or damaged (a part of its pixels cannot be unpacked)", again);
    }
}

}  // namespace morphodesic::datasets
