#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H
#include FT_TRUETYPE_TABLES_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <stdexcept>

#include "datasets/random_source.h"
#include "datasets/read_error.h"
#include "datasets/synthetic.h"

namespace morphodesic::datasets {

namespace fs = std::filesystem;

namespace {

/// The code points of a UTF-8 text, each with its bytes.
std::vector<std::pair<char32_t, std::string>> code_points(const std::string& text) {
    std::vector<std::pair<char32_t, std::string>> result;
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i]);
        const std::size_t length = lead < 0x80 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
        char32_t code = length == 1 ? lead : lead & (0x7fU >> length);
        if (i + length > text.size() || (lead >= 0x80 && lead < 0xc2))
            throw std::invalid_argument("the characters are not UTF-8 text");
        for (std::size_t k = 1; k < length; ++k) code = code << 6 | (static_cast<unsigned char>(text[i + k]) & 0x3fU);
        result.emplace_back(code, text.substr(i, length));
        i += length;
    }
    return result;
}

/// A character as the beginning of a file name and as a label.
std::string class_name(char32_t code, const std::string& bytes) {
    if (code >= 0x80 || (code >= '0' && code <= '9') || (code >= 'A' && code <= 'Z') || (code >= 'a' && code <= 'z'))
        return bytes;
    char text[16];
    std::snprintf(text, sizeof text, "U+%04X", static_cast<unsigned>(code));
    return text;
}

class Library {
public:
    Library() {
        if (FT_Init_FreeType(&library_) != 0) throw std::runtime_error("FreeType cannot be started");
    }
    ~Library() { FT_Done_FreeType(library_); }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;
    [[nodiscard]] FT_Library get() const { return library_; }

private:
    FT_Library library_ = nullptr;
};

class Font {
public:
    /// Loads a font; usable() is false if it is none, or not one of outlines.
    Font(const Library& library, const fs::path& file) : file_(file) {
        if (FT_New_Face(library.get(), file.c_str(), 0, &face_) != 0) face_ = nullptr;
        if (face_ != nullptr && (!FT_IS_SCALABLE(face_) || FT_Select_Charmap(face_, FT_ENCODING_UNICODE) != 0)) close();
        if (face_ == nullptr) return;
        FT_Set_Pixel_Sizes(face_, 0, 1000);
        // One height of capitals for all fonts.
        cap_height_ = load('H') ? box_height() : 0.0;
        if (!(cap_height_ > 0.0)) close();
    }
    ~Font() { close(); }
    Font(const Font&) = delete;
    Font& operator=(const Font&) = delete;

    [[nodiscard]] bool usable() const { return face_ != nullptr; }
    [[nodiscard]] bool has(char32_t code) { return usable() && load(code) && face_->glyph->outline.n_contours > 0; }

    /// Strokes so thin that a coarse grid would lose them.
    [[nodiscard]] bool hairline() const {
        const auto* table = static_cast<const TT_OS2*>(FT_Get_Sfnt_Table(face_, FT_SFNT_OS2));
        return table != nullptr && table->usWeightClass < 300;
    }

    /// Family and style without spaces and separators.
    [[nodiscard]] std::string name() const {
        const std::string full = std::string(face_->family_name != nullptr ? face_->family_name : "font") +
                                 (face_->style_name != nullptr ? face_->style_name : "");
        std::string result;
        for (const char c : full) {
            if ((c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z')) result += c;
        }
        return result;
    }

    /// The outline in units of the height of capitals, its strokes made wider by `embolden` of that height.
    std::vector<Loop> outline(char32_t code, double embolden) {
        if (!has(code)) throw ReadError(file_, "the font lacks a character", "choose another font");
        FT_Outline* const glyph = &face_->glyph->outline;
        // Corners of some outlines become spikes of any length: their strokes stay as they are.
        const long wider = std::lround(embolden * cap_height_), room = 4 * std::abs(wider) + 1;
        FT_BBox plain, made;
        FT_Outline_Get_CBox(glyph, &plain);
        FT_Outline_Embolden(glyph, wider);
        FT_Outline_Get_CBox(glyph, &made);
        const bool has_spikes = made.xMin < plain.xMin - room || made.xMax > plain.xMax + room ||
                                made.yMin < plain.yMin - room || made.yMax > plain.yMax + room;
        if (has_spikes) load(code);
        Decomposition decomposition{{}, 1.0 / cap_height_};
        FT_Outline_Funcs functions{};
        functions.move_to = [](const FT_Vector* to, void* user) {
            auto* d = static_cast<Decomposition*>(user);
            d->loops.emplace_back();
            d->add(d->point(to));
            return 0;
        };
        functions.line_to = [](const FT_Vector* to, void* user) {
            auto* d = static_cast<Decomposition*>(user);
            d->add(d->point(to));
            return 0;
        };
        functions.conic_to = [](const FT_Vector* control, const FT_Vector* to, void* user) {
            auto* d = static_cast<Decomposition*>(user);
            const Point<2> a = d->loops.back().back(), b = d->point(control), c = d->point(to);
            d->curve(a, {a[0] + 2.0 / 3.0 * (b[0] - a[0]), a[1] + 2.0 / 3.0 * (b[1] - a[1])},
                     {c[0] + 2.0 / 3.0 * (b[0] - c[0]), c[1] + 2.0 / 3.0 * (b[1] - c[1])}, c);
            return 0;
        };
        functions.cubic_to = [](const FT_Vector* first, const FT_Vector* second, const FT_Vector* to, void* user) {
            auto* d = static_cast<Decomposition*>(user);
            d->curve(d->loops.back().back(), d->point(first), d->point(second), d->point(to));
            return 0;
        };
        if (FT_Outline_Decompose(glyph, &functions, &decomposition) != 0) {
            throw ReadError(file_, "an outline of the font is damaged", "choose another font");
        }
        std::erase_if(decomposition.loops, [](const Loop& loop) { return loop.size() < 3; });
        return std::move(decomposition.loops);
    }

private:
    struct Decomposition {
        std::vector<Loop> loops;
        double scale;
        [[nodiscard]] Point<2> point(const FT_Vector* v) const { return {scale * double(v->x), scale * double(v->y)}; }
        void add(const Point<2>& p) { loops.back().push_back(p); }
        void curve(const Point<2>& a, const Point<2>& b, const Point<2>& c, const Point<2>& d) {
            constexpr int pieces = 12;
            for (int i = 1; i <= pieces; ++i) {
                const double t = double(i) / pieces, s = 1.0 - t;
                Point<2> p{};
                for (std::size_t k = 0; k < 2; ++k)
                    p[k] = s * s * s * a[k] + 3 * s * s * t * b[k] + 3 * s * t * t * c[k] + t * t * t * d[k];
                add(p);
            }
        }
    };

    bool load(char32_t code) {
        const FT_UInt glyph = FT_Get_Char_Index(face_, code);
        return glyph != 0 && FT_Load_Glyph(face_, glyph, FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP) == 0 &&
               face_->glyph->format == FT_GLYPH_FORMAT_OUTLINE;
    }
    [[nodiscard]] double box_height() const {
        FT_BBox bounds;
        FT_Outline_Get_CBox(&face_->glyph->outline, &bounds);
        return double(bounds.yMax - bounds.yMin);
    }
    void close() {
        if (face_ != nullptr) FT_Done_Face(face_);
        face_ = nullptr;
    }

    fs::path file_;
    FT_Face face_ = nullptr;
    double cap_height_ = 0.0;
};

/// Turns, slants, resizes; then the middle of the bounding box goes to the middle of the picture.
void place_letter(std::vector<Loop>& loops, double angle, double slant, double size) {
    const double c = std::cos(angle), s = std::sin(angle);
    Point<2> low{1e9, 1e9}, high{-1e9, -1e9};
    for (Loop& loop : loops) {
        for (Point<2>& p : loop) {
            const double x = size * (p[0] + slant * p[1]), y = size * p[1];
            p = {c * x - s * y, s * x + c * y};
            for (std::size_t a = 0; a < 2; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
        }
    }
    for (Loop& loop : loops) {
        for (Point<2>& p : loop) {
            for (std::size_t a = 0; a < 2; ++a) p[a] += 0.5 - 0.5 * (low[a] + high[a]);
        }
    }
}

/// One smaller size for all if the largest would leave the picture.
void fit(std::vector<Drawing>& drawings) {
    double reach = 0.0;
    const auto each_point = [&](auto&& visit) {
        for (Drawing& drawing : drawings) {
            for (Loop& loop : drawing.polygons) {
                for (Point<2>& p : loop) visit(p);
            }
        }
    };
    each_point([&](const Point<2>& p) { reach = std::max({reach, std::abs(p[0] - 0.5), std::abs(p[1] - 0.5)}); });
    if (reach <= 0.46) return;
    each_point([&](Point<2>& p) { p = {0.5 + (p[0] - 0.5) * 0.46 / reach, 0.5 + (p[1] - 0.5) * 0.46 / reach}; });
}

}  // namespace

std::vector<fs::path> installed_fonts(const std::string& characters) {
    std::vector<fs::path> files;
    std::vector<fs::path> folders = {"/usr/share/fonts", "/usr/local/share/fonts"};
    if (const char* home = std::getenv("HOME")) {
        folders.push_back(fs::path(home) / ".fonts");
        folders.push_back(fs::path(home) / ".local/share/fonts");
    }
    for (const fs::path& folder : folders) {
        std::error_code error;
        for (fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, error), end;
             !error && it != end; it.increment(error)) {
            const std::string ending = it->path().extension().string();
            if (ending == ".ttf" || ending == ".otf" || ending == ".pfb") files.push_back(it->path());
        }
    }
    std::sort(files.begin(), files.end());
    auto codes = code_points(characters);
    // Fonts of symbols pretend to have plain letters; only fonts for text know these.
    codes.emplace_back(U'\u00e9', "");
    codes.emplace_back(U'\u00df', "");
    const Library library;
    std::erase_if(files, [&](const fs::path& file) {
        Font font(library, file);
        return !font.usable() || font.hairline() ||
               !std::all_of(codes.begin(), codes.end(), [&](const auto& code) { return font.has(code.first); });
    });
    return files;
}

std::vector<Drawing> letters(const LettersOptions& options) {
    for (const std::string& problem : options.problems()) throw std::invalid_argument(problem);
    const auto codes = code_points(options.characters);
    if (codes.empty()) throw std::invalid_argument("name at least one character");
    std::vector<fs::path> files = options.fonts.empty() ? installed_fonts(options.characters) : options.fonts;
    if (files.empty()) {
        throw ReadError("/usr/share/fonts", "no installed font has the characters " + options.characters,
                        "install some fonts (apt-get install fonts-dejavu-core) or name font files with --font");
    }
    const Library library;
    std::vector<std::unique_ptr<Font>> fonts;
    for (const fs::path& file : files) {
        if (!fs::exists(file)) throw ReadError(file, "there is no such file", "name a font file with --font");
        fonts.push_back(std::make_unique<Font>(library, file));
        if (!fonts.back()->usable())
            throw ReadError(file, "this is not a font with outlines", "name a TrueType, OpenType or Type 1 font");
        for (const auto& [code, bytes] : codes) {
            if (!fonts.back()->has(code)) {
                throw ReadError(file, "the font has no character " + bytes, "choose other characters or another font");
            }
        }
    }
    RandomSource random(options.seed);
    std::map<std::string, int> used;
    std::vector<Drawing> result;
    for (int i = 0; i < options.count; ++i) {
        const auto n = static_cast<std::size_t>(i);
        const auto& [code, bytes] = codes[n % codes.size()];
        // Few rounds over many fonts: take fonts from the whole list, not the first few of one family.
        const std::size_t round = n / codes.size(),
                          rounds = (static_cast<std::size_t>(options.count) + codes.size() - 1) / codes.size();
        Font& font = *fonts[rounds < fonts.size() ? round * fonts.size() / rounds : round % fonts.size()];
        const auto jitter = [&](double range) { return options.variation * random.uniform(-range, range); };
        const double angle = jitter(0.2), slant = jitter(0.15), embolden = jitter(0.025),
                     size = 0.5 * (1.0 + jitter(0.1));
        Drawing& drawing = result.emplace_back();
        drawing.label = class_name(code, bytes);
        const std::string stem = drawing.label + "-" + font.name();
        char number[16];
        std::snprintf(number, sizeof number, "%03d", ++used[stem]);
        drawing.name = stem + number;
        drawing.parameters = {{"font", font.name()}};
        for (const auto& [name, value] : {std::make_pair("turn_radians", angle), std::make_pair("slant", slant),
                                          std::make_pair("wider_strokes", embolden), std::make_pair("size", size)}) {
            char text[40];
            std::snprintf(text, sizeof text, "%.6g", value);
            drawing.parameters.emplace_back(name, text);
        }
        drawing.polygons = font.outline(code, embolden);
        place_letter(drawing.polygons, angle, slant, size);
    }
    fit(result);
    return result;
}

}  // namespace morphodesic::datasets
