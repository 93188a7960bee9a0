// classify QUERY... --templates DIR|STUDY
#include "pipeline/commands/classify.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iostream>
#include <map>
#include <mutex>
#include <numbers>
#include <set>

#include "analysis/k_medoids.h"
#include "pipeline/classify_page.h"
#include "pipeline/classify_queries.h"
#include "pipeline/classify_results.h"
#include "pipeline/classify_screening.h"
#include "pipeline/classify_templates.h"
#include "pipeline/collection.h"
#include "pipeline/commands/summary.h"
#include "pipeline/progress.h"
#include "pipeline/stop_signals.h"
#include "pipeline/study_folder.h"
#include "pipeline/whole_tasks.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

bool stopped() {
    return StopSignals::caught() != 0;
}

template <int Dim>
double turn_degrees(const RigidMotion<Dim>& motion) {
    double trace = 0.0;
    for (std::size_t a = 0; a < Dim; ++a) trace += motion.rotation[a * Dim + a];
    const double cosine = std::clamp(Dim == 2 ? trace / 2 : (trace - 1) / 2, -1.0, 1.0);
    return std::acos(cosine) * 180 / std::numbers::pi;
}

/// Why no query is rejected as of no template's class, if none is though that was asked for; else empty.
std::string remark_on_rejection(const analysis::Calibration& calibration) {
    const double rate = calibration.options.false_rejection;
    if (!(rate > 0.0) || std::isfinite(calibration.novelty_limit)) return "";
    const double needed = std::ceil(1.0 / rate - 1.0 - 1e-9), there = static_cast<double>(calibration.members);
    char text[240];
    std::snprintf(text, sizeof text,
                  there < needed ? "No query is rejected as of no template's class: for --false-rejection %g at least "
                                   "%.0f templates are needed whose classes have others, and %.0f are there."
                                 : "No query is rejected as of no template's class: from the distances between the "
                                   "templates no limit for --false-rejection %g can be learned.",
                  rate, needed, there);
    return text;
}

template <int Dim>
class Classifier {
public:
    Classifier(const ClassifyCommandOptions& options, Progress& progress)
        : options_(options), progress_(progress), set_(load_templates<Dim>(options.templates, options.settings)) {
        for (const std::string& problem : set_.problems) run.failures.push_back({"", "", problem});
        run.remarks = set_.remarks;
        for (const auto& shape : set_.shapes) classes_.push_back(shape->label);
        run.templates = options.templates.string();
        run.options = options.classify;
        run.geodesic = options.settings.geodesic;
        run.preset = options.settings.preset;
        run.normalize = set_.placement.mode;
        run.mask = options.mask;
        ranking_.neighbours = static_cast<std::size_t>(options.classify.neighbours);
        ranking_.false_rejection = options.classify.false_rejection;
        ranking_.least_confidence = options.classify.least_confidence;
    }

    /// Whether mirror images count as the same shape: as asked for, or if templates are clearly more like the mirror
    /// image of a member of their class than like any member.
    void learn_about_mirror_images() {
        mirror_ = options_.classify.mirror == "yes";
        if (options_.classify.mirror != "auto") return;
        const std::size_t n = set_.shapes.size();
        std::vector<char> mirrored(n, 0), judged(n, 0);
        count(n, [&](std::size_t i) {
            if (classes_[i].empty()) return;
            try {
                const PartialMatcher<Dim> matcher(set_.shapes[i], options_.classify, set_.placement.mode,
                                                  options_.settings.geodesic.align, false, true);
                double plain = std::numeric_limits<double>::infinity(), turned = plain;
                for (std::size_t j = 0; j < n; ++j) {
                    if (j == i || classes_[j] != classes_[i]) continue;
                    for (const auto& guess : matcher.guesses(*set_.shapes[j])) {
                        double& least = guess.start.mirrored ? turned : plain;
                        least = std::min(least, guess.score);
                    }
                }
                judged[i] = std::isfinite(plain) ? 1 : 0;
                mirrored[i] = turned < 0.75 * plain ? 1 : 0;
            } catch (const std::exception&) {
                judged[i] = 0;  // said where the template is classified
            }
        });
        const auto found = std::count(mirrored.begin(), mirrored.end(), 1);
        mirror_ = found > 0 && 20 * found >= std::count(judged.begin(), judged.end(), 1);
        if (mirror_) {
            run.remarks.push_back(
                std::to_string(found) + " of " + std::to_string(n) +
                " templates are much more like the mirror image of a member of their class than like "
                "any member: mirror images count as the same shape (--mirror-images no: they do not).");
        }
    }

    /// Classifies the templates themselves, each against the others: the distances from which confidences and the
    /// reject option come.
    void learn_from_templates() {
        const int per_class = options_.classify.templates_per_class;
        if (!options_.classify.calibrate && !options_.leave_one_out && per_class == 0) return finish_templates();
        const std::size_t n = set_.shapes.size();
        progress_.message("classifying " + std::to_string(n) + " templates against each other");
        std::vector<std::vector<TemplateResult<Dim>>> rows(n);
        row_seconds_.assign(n, 0.0);
        ClassifyOptions classify = options_.classify;
        // Medoids and tables of hits need all distances alike.
        if (per_class > 0 || options_.leave_one_out) classify.screening = false;
        const double begin = steady_seconds();
        count(n, [&](std::size_t i) {
            const double at = steady_seconds();
            try {
                const PartialMatcher<Dim> matcher(set_.shapes[i], classify, set_.placement.mode,
                                                  options_.settings.geodesic.align, options_.mask == "auto", mirror_);
                rows[i] =
                    compare_with_templates<Dim>(matcher, set_.shapes, options_.settings.geodesic, classify, stopped, i);
                row_seconds_[i] = steady_seconds() - at;
            } catch (const std::exception& error) {
                const std::scoped_lock lock(mutex_);
                run.failures.push_back({set_.shapes[i]->name, "", set_.shapes[i]->name + ": " + error.what()});
            }
        });
        loo_seconds_ = steady_seconds() - begin;
        loo_rows_ = rows;
        std::vector<std::string> names;
        for (const auto& shape : set_.shapes) names.push_back(shape->name);
        distances_ = analysis::DistanceMatrix(names);
        struct Cell {
            double distance = analysis::missing;
            int quality = -1;
        };
        std::map<std::pair<std::size_t, std::size_t>, Cell> cells;
        for (std::size_t i = 0; i < n; ++i) {
            for (const auto& r : rows[i]) {
                if (std::isnan(r.distance)) continue;
                Cell& cell = cells[std::minmax(i, r.item)];
                const int quality = r.refined ? 2 : 1;
                if (quality > cell.quality) {
                    cell = {r.distance, quality};
                } else if (quality == cell.quality) {
                    cell.distance = 0.5 * (cell.distance + r.distance);
                }
            }
        }
        for (const auto& [pair, cell] : cells) distances_.set(pair.first, pair.second, cell.distance);
        if (per_class > 0) keep_medoids(static_cast<std::size_t>(per_class));
        if (options_.classify.calibrate) {
            run.calibration = analysis::calibrate(distances_, classes_, ranking_);
            if (std::string remark = remark_on_rejection(*run.calibration); !remark.empty()) {
                run.remarks.push_back(std::move(remark));
            }
        }
        finish_templates();
    }

    /// The templates' own results as queries.
    void leave_one_out() {
        run.retrieval = analysis::retrieval(distances_, classes_);
        run.seconds = loo_seconds_;
        for (std::size_t i = 0; i < set_.shapes.size(); ++i) {
            run.queries.push_back(result_of(*set_.shapes[i], loo_rows_[i]));
            run.queries.back().truth = set_.shapes[i]->label;
            run.queries.back().seconds = row_seconds_[i];
        }
    }

    void classify_queries(const QueryList& list) {
        const double begin = steady_seconds();
        progress_.message("classifying " + std::to_string(list.queries.size()) +
                          (list.queries.size() == 1 ? " query" : " queries"));
        run.queries.resize(list.queries.size());
        pictured_.resize(std::min(list.queries.size(), static_cast<std::size_t>(options_.pictures)));
        count(list.queries.size(), [&](std::size_t i) { run.queries[i] = classify_one(list.queries[i], i); });
        run.seconds = steady_seconds() - begin;
        for (const QueryResult& query : run.queries) {
            if (!query.problem.empty()) run.failures.push_back({query.name, "", query.problem});
        }
    }

    /// The page, with pictures and filmstrips of the first queries.
    [[nodiscard]] reports::ClassificationPage page() const {
        reports::ClassificationPage page = classification_page(run, options_.command);
        for (std::size_t i = 0; i < pictured_.size(); ++i) {
            const Pictured& pictured = pictured_[i];
            if (!pictured.query) continue;
            page.queries[i].picture = query_picture<Dim>(pictured.query->level_set, pictured.query->mask, 240);
            page.queries[i].strips.resize(pictured.starts.size());
            for_each_whole(pictured.starts.size(), [&](std::size_t s) {
                const auto& [item, start] = pictured.starts[s];
                page.queries[i].strips[s] = filmstrip<Dim>(pictured.query, *set_.shapes[item], start, run);
            });
        }
        return page;
    }

    ClassificationRun run;

private:
    template <class Body>
    void count(std::size_t n, const Body& body) {
        std::atomic<std::size_t> done{0};
        std::atomic<double> shown{steady_seconds()};
        for_each_whole(n, [&](std::size_t i) {
            if (stopped()) return;
            body(i);
            const std::size_t finished = ++done;
            double before = shown.load();
            if (steady_seconds() - before > 10.0 && shown.compare_exchange_strong(before, steady_seconds())) {
                progress_.message("  " + std::to_string(finished) + " of " + std::to_string(n));
            }
        });
    }

    /// What the pictures of a query need.
    struct Pictured {
        std::shared_ptr<const ComparedShape<Dim>> query;
        std::vector<std::pair<std::size_t, PartialStart<Dim>>> starts;  ///< to the nearest templates
    };

    void remember(Pictured& pictured, std::shared_ptr<const ComparedShape<Dim>> query,
                  const std::vector<TemplateResult<Dim>>& rows) const {
        pictured.query = std::move(query);
        std::vector<const TemplateResult<Dim>*> order;
        for (const auto& row : rows) {
            if (!std::isnan(row.distance) && row.measured.level > 0) order.push_back(&row);
        }
        std::stable_sort(order.begin(), order.end(),
                         [](const auto* a, const auto* b) { return a->distance < b->distance; });
        for (const auto* row : order) {
            if (pictured.starts.size() == static_cast<std::size_t>(options_.filmstrips)) break;
            pictured.starts.emplace_back(row->item, row->start);
        }
    }

    void keep_medoids(std::size_t per_class) {
        std::set<std::size_t> kept;
        for (const auto& known : analysis::class_counts(classes_)) {
            std::vector<std::size_t> members;
            for (std::size_t i = 0; i < classes_.size(); ++i) {
                if (classes_[i] == known.name) members.push_back(i);
            }
            if (members.size() <= per_class) {
                kept.insert(members.begin(), members.end());
                continue;
            }
            for (const std::size_t m : analysis::k_medoids(distances_.subset(members), per_class).medoids) {
                kept.insert(members[m]);
            }
        }
        const std::vector<std::size_t> items(kept.begin(), kept.end());
        std::vector<std::shared_ptr<const ComparedShape<Dim>>> shapes;
        std::vector<std::string> classes;
        for (const std::size_t i : items) {
            shapes.push_back(set_.shapes[i]);
            classes.push_back(classes_[i]);
        }
        run.remarks.push_back(std::to_string(items.size()) + " medoids stand for " +
                              std::to_string(set_.shapes.size()) + " templates.");
        distances_ = distances_.subset(items);
        set_.shapes = std::move(shapes);
        classes_ = std::move(classes);
    }

    void finish_templates() {
        run.template_count = set_.shapes.size();
        for (const auto& known : analysis::class_counts(classes_)) run.classes.push_back(known.name);
    }

    QueryResult classify_one(const Query& one, std::size_t index) {
        const datasets::ShapeSource& source = one.source;
        QueryResult result;
        const double begin = steady_seconds();
        try {
            if (source.dimension != Dim) {
                throw datasets::ReadError(source.path, "the templates are of another dimension",
                                          "compare images with images and 3D shapes with 3D shapes");
            }
            const bool ignore = options_.mask == "none";
            auto query = std::make_shared<ComparedShape<Dim>>(load_query<Dim>(source, set_, reading(), ignore));
            const PartialMatcher<Dim> matcher(query, options_.classify, set_.placement.mode,
                                              options_.settings.geodesic.align, options_.mask == "auto", mirror_);
            const auto rows = compare_with_templates<Dim>(matcher, set_.shapes, options_.settings.geodesic,
                                                          options_.classify, stopped);
            result = result_of(*query, rows);
            if (index < pictured_.size()) remember(pictured_[index], query, rows);
        } catch (const std::bad_alloc&) {
            result.problem = source.path.string() + ": not enough memory; choose a lower --level";
        } catch (const datasets::ReadError& error) {
            result.problem = error.what();
        } catch (const std::invalid_argument& error) {
            result.problem = source.path.string() + ": " + error.what();
        }
        result.name = one.name;
        result.truth = source.label;
        result.seconds = steady_seconds() - begin;
        return result;
    }

    /// How queries are read: as the templates, but with their own occluder and border.
    datasets::ImportOptions reading() const {
        datasets::ImportOptions reading = set_.import;
        reading.occluder = options_.settings.import.occluder;
        reading.border = options_.settings.import.border;
        if (Dim == 3) reading.border = "hides";  // beyond the holes of a scan nothing is known
        return reading;
    }

    QueryResult result_of(const ComparedShape<Dim>& query, const std::vector<TemplateResult<Dim>>& rows) const {
        QueryResult result;
        result.name = query.name;
        result.notes = query.notes;
        std::vector<double> distances(set_.shapes.size(), analysis::missing);
        std::vector<double> errors(set_.shapes.size(), analysis::missing);
        std::vector<const TemplateResult<Dim>*> order;
        for (const auto& row : rows) {
            distances[row.item] = row.distance;
            errors[row.item] = row.error;
            if (!std::isnan(row.distance)) order.push_back(&row);
        }
        result.answer =
            analysis::classify(distances, classes_, ranking_, run.calibration ? &*run.calibration : nullptr, errors);
        std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
            if (a->distance != b->distance) return a->distance < b->distance;
            return a->refined && !b->refined;
        });
        for (const auto* row : order) {
            const auto& shape = *set_.shapes[row->item];
            result.templates.push_back({shape.name, shape.label, row->distance, row->error, row->refined,
                                        row->measured.level, row->measured.time_steps,
                                        turn_degrees(row->start.motion.motion), row->start.motion.scale,
                                        to_string(row->start.hypothesis), row->start.hidden_share});
        }
        result.mask = !query.mask.values.empty() ? "known" : "none";
        if (!order.empty() && order.front()->start.hypothesis != Hypothesis::complete &&
            order.front()->start.hypothesis != Hypothesis::known) {
            result.mask = "estimated";
            result.notes.push_back(std::string("No mask was known; it was estimated that ") +
                                   to_string(order.front()->start.hypothesis) + ".");
        }
        return result;
    }

    const ClassifyCommandOptions& options_;
    Progress& progress_;
    TemplateSet<Dim> set_;
    std::vector<std::string> classes_;
    analysis::ClassifyOptions ranking_;
    analysis::DistanceMatrix distances_;
    std::vector<std::vector<TemplateResult<Dim>>> loo_rows_;
    double loo_seconds_ = 0.0;
    std::vector<double> row_seconds_;  ///< of the templates as queries
    bool mirror_ = false;
    std::vector<Pictured> pictured_;
    std::mutex mutex_;
};

fs::path results_folder(const ClassifyCommandOptions& options) {
    if (!options.out.empty()) return options.out;
    const fs::path first = with_last_name(options.queries.empty() ? options.templates : options.queries.front());
    const bool has_ending = !fs::is_directory(first) || first.extension() == ".study";
    return first.parent_path() / ((has_ending ? first.stem() : first.filename()).string() + ".classified");
}

std::string percent(double share) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f %%", 100 * share);
    return text;
}

void say(const ClassificationRun& run, Summary& summary) {
    constexpr std::size_t shown = 40;
    std::size_t said = 0;
    for (const QueryResult& q : run.queries) {
        if (!q.problem.empty() || run.retrieval) continue;
        if (++said > shown) continue;
        const auto& a = q.answer;
        std::string line = q.name + ": ";
        if (a.rejection == analysis::Rejection::accepted) {
            line += a.label;
        } else {
            line += "none of these (" + std::string(analysis::to_string(a.rejection)) +
                    (a.label.empty() ? "" : "; nearest is " + a.label) + ")";
        }
        if (!std::isnan(a.confidence)) line += ", confidence " + percent(a.confidence);
        if (!q.templates.empty()) {
            char text[200];
            std::snprintf(text, sizeof text, ", distance %.4g to ", q.templates.front().distance);
            line += text + q.templates.front().name;
        }
        if (!q.truth.empty()) line += a.label == q.truth ? " (right)" : " (truth: " + q.truth + ")";
        summary.lines.push_back(line);
        for (const std::string& note : q.notes) {
            if (note.find("estimated") != std::string::npos) summary.lines.push_back("    " + note);
        }
    }
    if (said > shown) summary.lines.push_back("and " + std::to_string(said - shown) + " more");
    char text[240];
    if (run.labelled > 0) {
        std::snprintf(text, sizeof text, "right: %ld of %ld (%s); accepted %ld, of these right %ld", run.right,
                      run.labelled, percent(static_cast<double>(run.right) / static_cast<double>(run.labelled)).c_str(),
                      run.accepted, run.accepted_right);
        summary.lines.emplace_back(text);
    }
    if (run.labelled_failed > 0) {
        std::snprintf(text, sizeof text, "%ld more of a known class could not be classified: right are %ld of all %ld",
                      run.labelled_failed, run.right, run.labelled + run.labelled_failed);
        summary.lines.emplace_back(text);
    }
    if (run.foreign > 0) {
        std::snprintf(text, sizeof text, "of no template's class: %ld, rejected %ld", run.foreign,
                      run.foreign_rejected);
        summary.lines.emplace_back(text);
    }
    if (run.calibration) {
        summary.lines.push_back("templates among each other: " + std::to_string(run.calibration->right) + " of " +
                                std::to_string(run.calibration->queries) + " right");
    }
    if (run.retrieval) {
        std::string line = "hits at rank 1 to 10 (of " + std::to_string(run.retrieval->queries) + "):";
        for (const double hits : run.retrieval->hits_at_rank) {
            std::snprintf(text, sizeof text, " %.4g", hits);
            line += text;
        }
        summary.lines.push_back(line);
    }
    const auto classified =
        std::count_if(run.queries.begin(), run.queries.end(), [](const QueryResult& q) { return q.problem.empty(); });
    if (classified == 0) {
        summary.lines.emplace_back("No query could be used.");
        return;
    }
    std::snprintf(text, sizeof text, "%td %s in %s, %.3g a second", classified, classified == 1 ? "query" : "queries",
                  duration_text(run.seconds).c_str(), static_cast<double>(classified) / std::max(run.seconds, 1e-9));
    summary.lines.emplace_back(text);
}

template <int Dim>
int execute(const ClassifyCommandOptions& options, const QueryList& list, Progress& progress) {
    Classifier<Dim> classifier(options, progress);
    ClassificationRun& run = classifier.run;
    run.failures.insert(run.failures.end(), list.failures.begin(), list.failures.end());
    run.remarks.insert(run.remarks.end(), list.remarks.begin(), list.remarks.end());
    classifier.learn_about_mirror_images();
    classifier.learn_from_templates();
    if (options.leave_one_out) {
        classifier.leave_one_out();
    } else {
        classifier.classify_queries(list);
    }
    if (stopped()) {
        return stopped_by_signal("; nothing was written");
    }
    run.evaluate();
    const StudyFolder folder(results_folder(options));
    folder.create();
    const StudyLock lock(folder);
    Summary summary;
    summary.data = to_json(run);
    for (const std::string& remark : run.remarks) summary.lines.push_back(remark);
    say(run, summary);
    summary.lines.push_back("results: " + folder.path().string());
    summary.data["results"] = folder.path().string();
    const bool any =
        std::any_of(run.queries.begin(), run.queries.end(), [](const QueryResult& q) { return q.problem.empty(); });
    if (!any) summary.exit_code = bad_usage;
    summary.add_failures(run.failures);
    folder.write_together(
        {{{"classification.csv", queries_csv(run)},
          {"ranking.csv", ranking_csv(run)},
          {"classification.html", reports::render_classification(classifier.page())},
          {"classification.json", summary.data.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"}},
         {}});
    return summary.print(options.common);
}

}  // namespace

int classify(const ClassifyCommandOptions& options) {
    const auto threads = static_cast<std::size_t>(thread_count(options.common));
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    if (options.queries.empty() && !options.leave_one_out) {
        throw std::invalid_argument("no query; name files or a folder, or --leave-one-out to test the templates");
    }
    if (!options.queries.empty() && options.leave_one_out) {
        throw std::invalid_argument(
            "--leave-one-out classifies the templates and takes no queries; give one or the other");
    }
    if (options.leave_one_out && options.classify.templates_per_class > 0) {
        throw std::invalid_argument(
            "--leave-one-out compares every template with all others, --templates-per-class keeps a few of them; give "
            "one or the other");
    }
    if (!fs::is_directory(options.templates)) {
        throw std::invalid_argument(options.templates.string() +
                                    (fs::exists(options.templates)
                                         ? ": is a file; --templates wants a folder of shapes or a study"
                                         : ": there is no such folder of templates"));
    }
    StudyFolder(results_folder(options)).refuse_if_foreign();  // before the work, not after it
    QueryList list;
    if (!options.leave_one_out) list = list_queries(options);
    Progress progress(Progress::style_of_stderr(options.common.quiet));
    if (!options.leave_one_out && list.queries.empty()) {
        for (const StudyFailure& failure : list.failures) std::cerr << "morphodesic: " << failure.reason << "\n";
        std::cerr << "morphodesic: there is no query that can be used\n";
        return bad_usage;
    }
    tbb::task_arena arena(static_cast<int>(threads));
    return arena.execute([&] {
        return with_dimension(template_dimension(options.templates, options.settings),
                              [&]<int Dim>() { return execute<Dim>(options, list, progress); });
    });
}

}  // namespace morphodesic::pipeline
