#pragma once

#include <span>

namespace morphodesic::kernels {

/// Long vectors, in parallel over chunks of fixed length: the bits do not depend on the number of threads.
[[nodiscard]] double dot(std::span<const double> a, std::span<const double> b);
[[nodiscard]] double dot(std::span<const double> a, std::span<const float> b);
/// y += factor * x
void add_scaled(std::span<double> y, double factor, std::span<const float> x);
/// out = x + factor * d
void step(std::span<double> out, std::span<const double> x, double factor, std::span<const double> d);
/// out = a - b, rounded to single precision
void difference(std::span<float> out, std::span<const double> a, std::span<const double> b);
void scale(std::span<double> y, double factor);

}  // namespace morphodesic::kernels
