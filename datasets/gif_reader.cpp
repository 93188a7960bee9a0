#include "datasets/gif_reader.h"

#include <gif_lib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "datasets/read_error.h"

namespace morphodesic::datasets {

namespace {

struct Source {
    std::string_view bytes;
    std::size_t at = 0;
};

int read_bytes(GifFileType* gif, GifByteType* to, int count) {
    auto* source = static_cast<Source*>(gif->UserData);
    const std::size_t n = std::min(static_cast<std::size_t>(count), source->bytes.size() - source->at);
    std::memcpy(to, source->bytes.data() + source->at, n);
    source->at += n;
    return static_cast<int>(n);
}

struct Close {
    void operator()(GifFileType* gif) const {
        int ignored = 0;
        DGifCloseFile(gif, &ignored);
    }
};

[[noreturn]] void damaged(const std::filesystem::path& file, int code) {
    const char* text = GifErrorString(code);
    throw ReadError(file, std::string("the GIF is damaged (") + (text != nullptr ? text : "unknown reason") + ")",
                    "copy or export it again");
}

}  // namespace

PixelImage read_gif(const std::filesystem::path& file, std::string_view bytes, double max_megapixels,
                    std::vector<std::string>& notes) {
    Source source{bytes};
    int code = 0;
    const std::unique_ptr<GifFileType, Close> gif(DGifOpen(&source, read_bytes, &code));
    if (!gif) damaged(file, code);

    PixelImage image;
    image.width = gif->SWidth;
    image.height = gif->SHeight;
    image.channels = 4;
    int transparent = NO_TRANSPARENT_COLOR;
    bool have_frame = false;
    for (GifRecordType record = UNDEFINED_RECORD_TYPE; record != TERMINATE_RECORD_TYPE;) {
        // Some writers forget the end mark; what counts is that the first frame is complete.
        if (DGifGetRecordType(gif.get(), &record) == GIF_ERROR) {
            if (have_frame) break;
            damaged(file, gif->Error);
        }
        if (record == EXTENSION_RECORD_TYPE) {
            int kind = 0;
            GifByteType* block = nullptr;
            if (DGifGetExtension(gif.get(), &kind, &block) == GIF_ERROR) damaged(file, gif->Error);
            while (block != nullptr) {
                GraphicsControlBlock control;
                if (!have_frame && kind == GRAPHICS_EXT_FUNC_CODE && block[0] == 4 &&
                    DGifExtensionToGCB(block[0], block + 1, &control) == GIF_OK) {
                    transparent = control.TransparentColor;
                }
                if (DGifGetExtensionNext(gif.get(), &block) == GIF_ERROR) damaged(file, gif->Error);
            }
        } else if (record == IMAGE_DESC_RECORD_TYPE) {
            if (have_frame) {
                notes.emplace_back("An animation: only its first frame is used.");
                break;
            }
            if (DGifGetImageDesc(gif.get()) == GIF_ERROR) damaged(file, gif->Error);
            const GifImageDesc& frame = gif->Image;
            const ColorMapObject* colours = frame.ColorMap != nullptr ? frame.ColorMap : gif->SColorMap;
            if (colours == nullptr) throw ReadError(file, "the GIF has no colours", "copy or export it again");
            if (double(frame.Width) * frame.Height > 1e6 * max_megapixels) {
                throw ReadError(file, "a frame has more pixels than the limit",
                                "scale it down, or raise --max-megapixels");
            }
            if (frame.Width < 1 || frame.Height < 1)
                throw ReadError(file, "the GIF is damaged (no pixels)", "export it again");
            image.values.assign(4 * image.pixel_count(), 0);
            std::vector<GifPixelType> line(static_cast<std::size_t>(frame.Width));
            constexpr std::array<int, 4> pass_start = {0, 4, 2, 1}, pass_step = {8, 8, 4, 2};
            for (int pass = 0; pass < (frame.Interlace ? 4 : 1); ++pass) {
                const auto p = static_cast<std::size_t>(pass);
                for (int row = frame.Interlace ? pass_start[p] : 0; row < frame.Height;
                     row += frame.Interlace ? pass_step[p] : 1) {
                    if (DGifGetLine(gif.get(), line.data(), frame.Width) == GIF_ERROR) damaged(file, gif->Error);
                    for (int column = 0; column < frame.Width; ++column) {
                        const int x = frame.Left + column, y = frame.Top + row,
                                  index = line[static_cast<std::size_t>(column)];
                        if (x < 0 || y < 0 || x >= image.width || y >= image.height || index == transparent) continue;
                        if (index >= colours->ColorCount)
                            throw ReadError(file, "the GIF uses a colour it does not define", "export it again");
                        const GifColorType& c = colours->Colors[index];
                        std::uint16_t* to = image.values.data() +
                                            4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                                 static_cast<std::size_t>(x));
                        to[0] = c.Red, to[1] = c.Green, to[2] = c.Blue, to[3] = 255;
                    }
                }
            }
            have_frame = true;
        }
    }
    if (!have_frame) throw ReadError(file, "the GIF holds no image", "copy or export it again");
    return image;
}

}  // namespace morphodesic::datasets
