#pragma once

#include "pipeline/figures/figure.h"

namespace morphodesic::pipeline {

/// An HTML page that shows the figures beside it (name.png), with captions, checks, tables and times.
[[nodiscard]] std::string gallery_page(const std::vector<Figure>& figures, bool quick);

}  // namespace morphodesic::pipeline
