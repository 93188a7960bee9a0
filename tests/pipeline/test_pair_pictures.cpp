// Figures of one path and their animation, on a made-up path of growing disks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/figures/animation.h"
#include "pipeline/figures/canvas.h"
#include "pipeline/figures/pair_pictures.h"
#include "tests/support/path_problems.h"
#include "tests/support/temporary_folder.h"

namespace morphodesic::pipeline {
namespace {

template <int Dim>
GeodesicResult<Dim> growing_ball(int level) {
    GeodesicOptions options;
    options.level = level;
    options.time_steps = 2;
    options.align = "none";
    options.starts = 1;
    return compute_discrete_geodesic<Dim>(tests::ball<Dim>(level, 0.2), tests::ball<Dim>(level, 0.25), options);
}

TEST(PairPictures, TableHoldsSizeTopologyAndEnergyOfEveryStep) {
    const auto path = growing_ball<2>(5);
    const Figure figure = path_figure_of(path);
    ASSERT_EQ(figure.numbers.rows.size(), 3U);
    const auto column = [&](const std::string& name) {
        const auto& names = figure.numbers.columns;
        return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    };
    double length = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto& row = figure.numbers.rows[k];
        EXPECT_EQ(row[column("euler_number")], "1");
        if (k > 0) length += std::stod(row[column("step_length")]);
    }
    EXPECT_NEAR(length, path.path_length, 1e-12);
    EXPECT_NEAR(std::stod(figure.numbers.rows[0][column("area")]), std::numbers::pi * 0.04, 2e-3);
    EXPECT_NE(figure.svg.find("</svg>"), std::string::npos);
}

TEST(PairPictures, FilesAreWrittenInBothDimensions) {
    const tests::TemporaryFolder folder;
    for (const std::string& name : write_pair_pictures(folder.path(), growing_ball<2>(5))) {
        EXPECT_GT(std::filesystem::file_size(folder / name), 50U) << name;
    }
    const auto names = write_pair_pictures(folder.path(), growing_ball<3>(4));
    EXPECT_EQ(names.size(), 4U);
    for (const std::string& name : names) EXPECT_GT(std::filesystem::file_size(folder / name), 50U) << name;
    EXPECT_EQ(tests::file_content(folder / "path.png").substr(1, 3), "PNG");
}

TEST(Animation, IsAnAnimatedWebP) {
    std::vector<RgbaImage> frames(3, RgbaImage(16, 16));
    for (std::size_t i = 0; i < 3; ++i) frames[i].set(3 + static_cast<int>(i), 5, {255, 0, 0, 255});
    const std::string bytes = encode_animation(frames, 40);
    EXPECT_EQ(bytes.substr(0, 4), "RIFF");
    EXPECT_EQ(bytes.substr(8, 4), "WEBP");
    EXPECT_NE(bytes.find("ANIM"), std::string::npos);
    std::size_t count = 0;
    for (std::size_t at = bytes.find("ANMF"); at != std::string::npos; at = bytes.find("ANMF", at + 4)) ++count;
    EXPECT_EQ(count, 3U);
    EXPECT_THROW(encode_animation({}, 40), std::runtime_error);
}

TEST(LineIntegralConvolution, IsSmoothAlongTheFieldAndRoughAcross) {
    VectorField<2> field{DyadicGrid<2>(4)};
    std::fill(field.components[0].begin(), field.components[0].end(), 1.0);  // to the right
    const LevelSet<2> everywhere(DyadicGrid<2>(4), 1.0);
    constexpr int n = 200;
    const auto grey = line_integral_convolution(field, everywhere, Panel{0, 0, n, n, {0.5, 0.5}, 0.8}, n);
    double along = 0, across = 0;
    for (int row = 40; row < 160; row += 4) {
        for (int column = 40; column < 160; column += 4) {
            const auto at = [&](int r, int c) { return grey[static_cast<std::size_t>(r * n + c)]; };
            along += std::abs(at(row, column + 2) - at(row, column));
            across += std::abs(at(row + 2, column) - at(row, column));
        }
    }
    EXPECT_GT(across, 2 * along);
}

}  // namespace
}  // namespace morphodesic::pipeline
