#pragma once

#include <string>

#include "reports/report_model.h"

namespace morphodesic::tests {

struct SyntheticStudy {
    int shapes = 12;
    int classes = 3;
    int paths = 6;        ///< filmstrips, of the shortest distances
    int frame_size = 96;  ///< pixels
    int frames = 9;
    bool labelled = true;
    int queries = 0;  ///< further shapes in the maps, each beside the shape of its number
    int dimension = 2;
    unsigned seed = 1;
};

/// A study as the pipeline would fill it: star-shaped blobs of a few classes with three or more lobes, distances of
/// their planted parameters with noise, trees, maps and tables computed from these distances, pictures drawn by Cairo.
reports::ReportModel synthetic_model(const SyntheticStudy& study = {});

/// PNG of a blob r(t) = radius (1 + depth cos(lobes t + phase)), grey, or coloured by a made-up dissipation.
std::string blob_png(int pixels, double radius, double depth, double lobes, double phase, bool coloured);

}  // namespace morphodesic::tests
