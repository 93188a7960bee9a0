#pragma once

#include "pipeline/figures/figure.h"

namespace morphodesic::pipeline {

/// An HTML page that shows the figures beside it (name.png), with captions, checks, tables and times.
[[nodiscard]] std::string gallery_page(const std::vector<Figure>& figures, bool quick);

/// The same as Markdown: pictures (name.svg beside it), captions, checks and the numbers, four digits each.
/// @param command  what it is made with
[[nodiscard]] std::string gallery_markdown(const std::vector<Figure>& figures, const std::string& command);

}  // namespace morphodesic::pipeline
