#pragma once

#include "reports/figure_parts.h"
#include "reports/figures.h"

namespace morphodesic::reports {

// Figures of the shapes at places: maps and graphs. Private to the figures.

/// @param e  one of the study's embeddings
[[nodiscard]] Figure embedding_figure(const FigureStudy& s, const Embedding& e);
/// The neighbour graph (else the spanning tree) on the map.
[[nodiscard]] Figure graph_figure(const FigureStudy& s, const Embedding& flat);
/// Small studies: labelled graph and matrix with pictures side by side, as Fig. 9 of [WBRS09]; A4 across.
[[nodiscard]] Figure page_figure(const FigureStudy& s, const Embedding& flat);

}  // namespace morphodesic::reports
