#include <cairo.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <regex>
#include <set>

#include "reports/figures.h"
#include "reports/svg.h"
#include "tests/reports/evil_names.h"
#include "tests/reports/synthetic_model.h"

namespace morphodesic::reports {
namespace {

struct Image {
    int width = 0, height = 0;
    std::set<std::uint32_t> colours;
};

Image decode(std::string png) {
    cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(
        [](void* closure, unsigned char* out, unsigned length) {
            auto* rest = static_cast<std::string*>(closure);
            if (rest->size() < length) return CAIRO_STATUS_READ_ERROR;
            std::memcpy(out, rest->data(), length);
            rest->erase(0, length);
            return CAIRO_STATUS_SUCCESS;
        },
        &png);
    Image image{cairo_image_surface_get_width(surface), cairo_image_surface_get_height(surface), {}};
    const unsigned char* data = cairo_image_surface_get_data(surface);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            std::uint32_t pixel = 0;
            std::memcpy(&pixel, data + y * cairo_image_surface_get_stride(surface) + 4 * x, 4);
            image.colours.insert(pixel & 0xFFFFFFU);
        }
    }
    cairo_surface_destroy(surface);
    return image;
}

TEST(Figures, EveryFigureIsMadeAndDrawn) {
    const auto made = figures(tests::synthetic_model({.shapes = 8, .classes = 2, .paths = 1}));
    std::vector<std::string> names;
    for (const auto& f : made) {
        names.push_back(f.name);
        const Image image = decode(svg_to_png(f.svg, 300));
        EXPECT_EQ(image.width, 300) << f.name;
        EXPECT_GT(image.height, 50) << f.name;
        EXPECT_GT(image.colours.size(), 20U) << f.name << " is empty";
        const std::string pdf = svg_to_pdf(f.svg);
        EXPECT_EQ(pdf.substr(0, 5), "%PDF-") << f.name;
        EXPECT_NE(pdf.rfind("%%EOF"), std::string::npos) << f.name;
    }
    EXPECT_THAT(names, testing::ElementsAre("heat_map", "dendrogram_average", "embedding_2d", "shepard_2d",
                                            "embedding_3d", "shepard_3d", "graph", "page", "precision_recall",
                                            "volume_dendrogram", "compare", "path_0_1"));
}

TEST(Figures, HeatMapShowsTheColoursOfItsDistances) {
    auto model = tests::synthetic_model({.shapes = 3, .classes = 1, .paths = 0, .labelled = false});
    model.distances = {0.5, 1.0, unknown};
    const auto made = figures(model);
    const Image image = decode(svg_to_png(made.at(0).svg));
    const auto has = [&](const std::string& colour) {
        return image.colours.count(static_cast<std::uint32_t>(std::stoul(colour.substr(1), nullptr, 16))) > 0;
    };
    EXPECT_TRUE(has(viridis(0)));
    EXPECT_TRUE(has(viridis(0.5)));
    EXPECT_TRUE(has(viridis(1)));
    EXPECT_TRUE(has("#9aa1ab"));  // missing
    EXPECT_FALSE(has(viridis(0.25)));
}

TEST(Figures, MapsShowPlacedQueries) {
    auto model = tests::synthetic_model({.shapes = 8, .classes = 2, .paths = 0, .queries = 2});
    model.placed[1].name = tests::evil_names[0];
    model.placed[1].positions[0].clear();  // it has a place in space only
    for (const auto& f : figures(model)) {
        const bool plane = f.name == "embedding_2d", space = f.name == "embedding_3d";
        EXPECT_EQ(f.svg.find("query-1.png") != std::string::npos, plane || space) << f.name;
        EXPECT_EQ(f.svg.find("onerror=alert(1)") != std::string::npos, space) << f.name;
        EXPECT_EQ(f.svg.find("<img"), std::string::npos) << f.name;
    }
}

TEST(Figures, LegendsOfManyClassesAreInsideThePicture) {
    auto model = tests::synthetic_model({.shapes = 40, .classes = 13, .paths = 0});
    std::set<std::string> labels;
    for (auto& shape : model.shapes) {
        shape.label = "a kind with a name: " + shape.label;
        labels.insert(shape.label);
    }
    ASSERT_EQ(labels.size(), 13U);
    for (const Figure& figure : figures(model)) {
        if (figure.name.starts_with("shepard") || figure.name == "compare" || figure.name == "precision_recall")
            continue;
        std::smatch size;
        ASSERT_TRUE(std::regex_search(figure.svg, size, std::regex("viewBox=\"0 0 ([0-9.]+) ([0-9.]+)\"")));
        std::set<std::string> inside;
        const std::regex entry("<text x=\"([0-9.]+)\" y=\"([0-9.]+)\"[^>]*>([^<]*)</text>");
        for (std::sregex_iterator it(figure.svg.begin(), figure.svg.end(), entry), end; it != end; ++it) {
            const double right = std::stod((*it)[1]) + 5.0 * static_cast<double>((*it)[3].length());
            if (std::stod((*it)[2]) < std::stod(size[2]) && right < std::stod(size[1])) inside.insert((*it)[3]);
        }
        for (const std::string& label : labels) EXPECT_TRUE(inside.contains(label)) << figure.name << ": " << label;
    }
}

TEST(Figures, NothingIsDrawnOfRankingsWithoutQueries) {
    auto model = tests::synthetic_model({.shapes = 8, .classes = 2, .paths = 0});
    const auto has_curve = [&] {
        const auto made = figures(model);
        return std::any_of(made.begin(), made.end(), [](const Figure& f) { return f.name == "precision_recall"; });
    };
    EXPECT_TRUE(has_curve());
    for (auto& ranking : model.classes) {  // as where every class has one member
        for (auto& point : ranking.precision_recall) point.precision = unknown;
    }
    EXPECT_FALSE(has_curve());
}

TEST(Figures, LargeStudiesStaySmall) {
    const auto made = figures(tests::synthetic_model({.shapes = 300, .classes = 10, .paths = 0}));
    for (const auto& f : made) EXPECT_LT(f.svg.size(), 4'000'000U) << f.name;
    EXPECT_GT(decode(svg_to_png(made.at(0).svg, 500)).colours.size(), 100U);
}

TEST(Figures, NamesAreText) {
    auto model =
        tests::synthetic_model({.shapes = static_cast<int>(tests::evil_names.size()), .classes = 3, .paths = 1});
    for (std::size_t i = 0; i < model.shapes.size(); ++i)
        model.shapes[i].name = model.shapes[i].label = tests::evil_names[i];
    for (const auto& f : figures(model)) {
        EXPECT_EQ(f.svg.find("<img"), std::string::npos) << f.name;
        EXPECT_EQ(f.svg.find("<script"), std::string::npos) << f.name;
        EXPECT_NO_THROW((void)svg_to_png(f.svg, 200)) << f.name;  // well-formed
    }
}

TEST(Figures, UnreadableSvgIsAnError) {
    EXPECT_THROW((void)svg_to_png("<svg"), std::runtime_error);
}

TEST(Figures, TicksAreRoundAndInside) {
    EXPECT_THAT(ticks(0, 1, 5), testing::ElementsAre(0, testing::DoubleNear(0.2, 1e-12),
                                                     testing::DoubleNear(0.4, 1e-12), testing::DoubleNear(0.6, 1e-12),
                                                     testing::DoubleNear(0.8, 1e-12), testing::DoubleNear(1, 1e-12)));
    for (const double v : ticks(0.013, 0.094, 5)) EXPECT_TRUE(v >= 0.0129 && v <= 0.0941);
}

}  // namespace
}  // namespace morphodesic::reports
