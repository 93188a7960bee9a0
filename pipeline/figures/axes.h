#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "reports/svg.h"

namespace morphodesic::pipeline {

/// Points (x, y) of one curve.
using Series = std::vector<std::pair<double, double>>;

/// The curve as a line with a dot at each point.
void plot(reports::Svg& svg, const reports::Scale& x, const reports::Scale& y, const Series& series,
          const std::string& colour);

/// Axes with powers of two along x: `name` is the label of 2^e.
void draw_log2_axes(reports::Svg& svg, const reports::Scale& x, const reports::Scale& y, const std::string& x_title,
                    const std::string& y_title, const std::function<std::string(int)>& name);

/// Least and largest y of several curves, with a margin of a tenth.
[[nodiscard]] std::pair<double, double> range_of(const std::vector<Series>& all);

}  // namespace morphodesic::pipeline
