#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "datasets/image_pixels.h"
#include "datasets/outline.h"

namespace morphodesic::datasets {

using Colour = std::array<float, 3>;  ///< red, green, blue in [0,1]

/// Colour of a pixel; transparent pixels are laid over a grey tone.
Colour colour_over(const PixelImage& image, std::size_t pixel, float tone);

/// Root mean square over the three channels.
float colour_distance(const Colour& a, const Colour& b);

/// Pixels at a depth below the border of an image (0: the outermost), those that are hidden left out (unless all are).
std::vector<std::size_t> ring_pixels(const PixelImage& image, int depth, const Coverage& hidden);

/// Depth at which the picture within a frame begins; 0 if there is no frame. A frame is a uniform line or band along
/// all four sides, not wider than 4 % of the image, with another uniform colour within, and something else in there.
int frame_depth(const PixelImage& image, const Coverage& hidden);

/// What the background looks like at every pixel, as told by a ring of pixels.
class Background {
public:
    Background(const PixelImage& image, int depth, const Coverage& hidden);

    /// False: one colour, the most common one of the ring. True: light falls unevenly, the colour is a quadratic
    /// function.
    [[nodiscard]] bool uneven() const { return uneven_; }
    [[nodiscard]] Colour at(std::size_t pixel) const;

private:
    using Terms = std::array<double, 6>;
    [[nodiscard]] Terms terms(std::size_t pixel) const;
    void fit_uneven(const PixelImage& image, const std::vector<std::size_t>& ring);

    int width_, height_;
    bool uneven_ = false;
    Colour constant_{};
    std::array<Terms, 3> coefficients_{};
};

}  // namespace morphodesic::datasets
