#include "pipeline/classify_page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geodesic/grid/q1_element.h"
#include "pipeline/path_files.h"
#include "pipeline/path_pictures.h"
#include "pipeline/png.h"
#include "pipeline/run_settings.h"
#include "reports/text.h"

namespace morphodesic::pipeline {
namespace {

constexpr int strip_pixels = 120;

std::string text_of(double value, const char* format = "%.4g") {
    if (std::isnan(value)) return "unknown";
    char text[48];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string share_text(double share) {
    return std::isnan(share) ? "unknown" : reports::share_text(share);
}

reports::Picture encoded(const RgbaImage& image) {
    return {encode_png(image), image.width, image.height, {}};
}

/// chi at the place that a pixel of a 2D picture shows.
double chi_at(const ScalarField<2>& mask, int column, int row, int pixels) {
    const double pixel = 2 * picture_radius / pixels;
    return q1::value(
        mask.grid, mask.values.data(),
        Point<2>{0.5 - picture_radius + (column + 0.5) * pixel, 0.5 + picture_radius - (row + 0.5) * pixel});
}

/// Hatches what is hidden. Solids are seen from outside, where a region of space cannot be shown on the surface.
void hatch(RgbaImage& image, const ScalarField<2>& mask) {
    if (mask.values.empty()) return;
    for (int row = 0; row < image.height; ++row) {
        for (int column = 0; column < image.width; ++column) {
            if (chi_at(mask, column, row, image.width) >= 0.5) continue;
            const bool line = (column + row) % 8 < 2;
            image.set(column, row,
                      line ? std::array<unsigned char, 4>{110, 120, 135, 255}
                           : std::array<unsigned char, 4>{205, 210, 218, 255});
        }
    }
}
void hatch(RgbaImage&, const ScalarField<3>&) {}

void tint_hidden(RgbaImage& image, const ScalarField<2>& mask) {
    for (int row = 0; row < image.height; ++row) {
        for (int column = 0; column < image.width; ++column) {
            const std::size_t at = 4 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                                        static_cast<std::size_t>(column));
            if (image.pixels[at + 3] == 0 || chi_at(mask, column, row, image.width) >= 0.5) continue;
            image.set(column, row, {217, 119, 36, image.pixels[at + 3]});
        }
    }
}
void tint_hidden(RgbaImage&, const ScalarField<3>&) {}

}  // namespace

template <int Dim>
reports::Picture query_picture(const LevelSet<Dim>& visible, const ScalarField<Dim>& mask, int pixels) {
    RgbaImage image = shape_picture(visible, pixels);
    hatch(image, mask);
    return encoded(image);
}

template <int Dim>
reports::Filmstrip filmstrip(std::shared_ptr<const ComparedShape<Dim>> query, const ComparedShape<Dim>& whole,
                             const PartialStart<Dim>& start, const ClassificationRun& run) {
    ClassifyOptions options = run.options;
    options.correction = "filled";
    const PartialMatcher<Dim> matcher(query, options, run.normalize, run.geodesic.align, false, start.mirrored);
    GeodesicOptions geodesic = run.geodesic;
    geodesic.time_steps = std::max(4, geodesic.time_steps);
    GeodesicResult<Dim> path;
    const PartialDistance distance = matcher.measure(whole, start, geodesic, {}, &path);
    reports::Filmstrip strip;
    strip.title = whole.label + ": " + whole.name;
    if (!distance.problem.empty() || path.shapes.empty()) {
        strip.title += " (no path: " + distance.problem + ")";
        return strip;
    }
    const PathPictures pictures = path_pictures(path, strip_pixels);
    strip.colour_bar = colour_bar_of(pictures);
    const int level = whole.level_set.grid.level();
    strip.frames.push_back(
        query_picture<Dim>(carried(matcher.level_set(start), start.motion, level), start.mask, strip_pixels));
    for (std::size_t k = 1; k < pictures.frames.size(); ++k) strip.frames.push_back(encoded(pictures.frames[k]));
    if (!start.mask.values.empty() && start.hidden_share > 0.0) {
        RgbaImage inferred = shape_picture(path.shapes[1], strip_pixels);
        tint_hidden(inferred, start.mask);
        strip.inferred = encoded(inferred);
    }
    return strip;
}

reports::ClassificationPage classification_page(const ClassificationRun& run, const std::string& command) {
    reports::ClassificationPage page;
    page.title = run.queries.size() == 1 ? run.queries.front().name : std::to_string(run.queries.size()) + " queries";
    page.headline = "compared with " + std::to_string(run.template_count) + " templates of " +
                    std::to_string(run.classes.size()) + " classes: " + run.templates;
    page.command = command;
    page.remarks = run.remarks;
    for (const StudyFailure& failure : run.failures) page.remarks.push_back(failure.reason);
    page.tiles.emplace_back(std::to_string(run.queries.size()), "queries");
    if (run.labelled > 0) {
        page.tiles.emplace_back(share_text(static_cast<double>(run.right) / static_cast<double>(run.labelled)),
                                "right, of " + std::to_string(run.labelled) + " with a known class");
    }
    if (run.labelled_failed > 0) {
        page.tiles.emplace_back(std::to_string(run.labelled_failed),
                                "more with a known class could not be classified: right are " +
                                    std::to_string(run.right) + " of all " +
                                    std::to_string(run.labelled + run.labelled_failed));
    }
    if (run.foreign > 0) {
        page.tiles.emplace_back(std::to_string(run.foreign_rejected) + " of " + std::to_string(run.foreign),
                                "of no template's class were rejected");
    }
    if (run.calibration) page.tiles.emplace_back(share_text(run.calibration->accuracy), "right among the templates");
    if (run.seconds > 0) {
        page.tiles.emplace_back(text_of(static_cast<double>(run.queries.size()) / run.seconds, "%.3g"),
                                "queries a second");
    }
    page.classes = run.classes;
    if (run.confusion) {
        page.classes = run.confusion->classes;
        for (std::size_t i = 0; i < page.classes.size(); ++i) {
            std::vector<int> row;
            for (std::size_t j = 0; j <= page.classes.size(); ++j)
                row.push_back(static_cast<int>((*run.confusion)(i, j)));
            page.confusion.push_back(std::move(row));
        }
    }
    const analysis::Reliability* reliability = run.reliability   ? &*run.reliability
                                               : run.calibration ? &run.calibration->reliability
                                                                 : nullptr;
    if (reliability) {
        for (const auto& bin : reliability->bins) {
            if (bin.count > 0)
                page.reliability.push_back({bin.mean_confidence, bin.accuracy, static_cast<int>(bin.count)});
        }
    }
    if (run.retrieval) page.hits_at_rank = run.retrieval->hits_at_rank;
    for (const QueryResult& q : run.queries) {
        reports::ClassifiedQuery query;
        query.name = q.name;
        query.truth = q.truth;
        if (!q.problem.empty()) {
            query.verdict = q.problem;
            query.right = false;
            page.queries.push_back(std::move(query));
            continue;
        }
        const bool accepted = q.answer.rejection == analysis::Rejection::accepted;
        query.verdict = accepted ? "This is: " + q.answer.label
                                 : std::string("None of these: ") + analysis::to_string(q.answer.rejection) +
                                       (q.answer.label.empty() ? "" : "; nearest is " + q.answer.label);
        const bool known = std::find(run.classes.begin(), run.classes.end(), q.truth) != run.classes.end();
        query.right = q.truth.empty() || (known ? q.truth == q.answer.label : !accepted);
        if (!q.truth.empty()) query.facts.emplace_back("truth", q.truth);
        query.facts.emplace_back("confidence", share_text(q.answer.confidence));
        query.facts.emplace_back("margin", text_of(q.answer.margin, "%.3g"));
        query.facts.emplace_back("error bars of the two best classes", q.answer.separated ? "apart" : "overlap");
        query.facts.emplace_back("mask", q.mask);
        query.notes = q.notes;
        for (const TemplateRow& t : q.templates) {
            query.rows.push_back({t.name, t.label, t.distance, t.error, t.hidden_share, t.refined});
        }
        page.queries.push_back(std::move(query));
    }
    const auto add = [&](const char* name, const auto& value, const char*) {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>) {
            page.settings.emplace_back(name, value);
        } else if constexpr (std::is_same_v<std::decay_t<decltype(value)>, bool>) {
            page.settings.emplace_back(name, value ? "yes" : "no");
        } else {
            page.settings.emplace_back(name, text_of(static_cast<double>(value), "%.6g"));
        }
    };
    page.settings.emplace_back("normalize", run.normalize);
    page.settings.emplace_back("mask", run.mask);
    ClassifyOptions::for_each_field(run.options, add);
    GeodesicOptions::for_each_field(run.geodesic, add);
    return page;
}

template reports::Picture query_picture<2>(const LevelSet<2>&, const ScalarField<2>&, int);
template reports::Picture query_picture<3>(const LevelSet<3>&, const ScalarField<3>&, int);
template reports::Filmstrip filmstrip<2>(std::shared_ptr<const ComparedShape<2>>, const ComparedShape<2>&,
                                         const PartialStart<2>&, const ClassificationRun&);
template reports::Filmstrip filmstrip<3>(std::shared_ptr<const ComparedShape<3>>, const ComparedShape<3>&,
                                         const PartialStart<3>&, const ClassificationRun&);

}  // namespace morphodesic::pipeline
