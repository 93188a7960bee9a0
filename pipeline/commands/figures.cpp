#include "pipeline/commands/figures.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <fstream>
#include <iostream>
#include <sstream>

#include "pipeline/commands/summary.h"
#include "pipeline/figures/figure.h"
#include "pipeline/figures/gallery.h"
#include "pipeline/progress.h"
#include "pipeline/stop_signals.h"
#include "pipeline/store_error.h"
#include "pipeline/study_folder.h"
#include "reports/figures.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& bytes) {
    std::ofstream stream(file, std::ios::binary);
    stream << bytes;
    stream.close();
    if (!stream) throw StoreError(file, "cannot be written; is the disk full or the folder protected?");
}

std::vector<const FigureKind*> chosen(const std::vector<std::string>& keys) {
    std::vector<const FigureKind*> result;
    for (const FigureKind& kind : figure_kinds()) {
        if (keys.empty()) result.push_back(&kind);
    }
    for (const std::string& key : keys) {
        const FigureKind* found = nullptr;
        for (const FigureKind& kind : figure_kinds()) {
            if (kind.key == key) found = &kind;
        }
        if (found == nullptr)
            throw std::invalid_argument("there is no figure " + key + "; there are:\n" + figures_help());
        result.push_back(found);
    }
    return result;
}

}  // namespace

std::string figures_help() {
    std::string text;
    for (const FigureKind& kind : figure_kinds()) {
        text += "  " + kind.key + std::string(kind.key.size() < 14 ? 14 - kind.key.size() : 1, ' ') + kind.title + "\n";
    }
    return text;
}

int figures(const FiguresOptions& options) {
    const auto threads = static_cast<std::size_t>(thread_count(options.common));
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const auto kinds = chosen(options.keys);
    const StudyFolder folder(options.out);
    folder.create();
    const StudyLock lock(folder);
    std::error_code error;
    if (const auto parent = options.markdown.parent_path(); !parent.empty()) fs::create_directories(parent, error);
    if (error) throw StoreError(options.markdown, "cannot be created: " + error.message());

    Summary summary;
    summary.data["figures"] = nlohmann::ordered_json::array();
    std::vector<Figure> done;
    bool failed = false, missed = false;
    for (const FigureKind* kind : kinds) {
        if (StopSignals::caught() != 0) {
            return stopped_by_signal("; " + std::to_string(done.size()) + " figures are in " + options.out.string());
        }
        if (!options.common.quiet) std::cerr << "figure " << kind->key << ": " << kind->title << std::endl;
        const auto begin = steady_seconds();
        nlohmann::ordered_json entry{{"figure", kind->key}};
        try {
            Figure figure = kind->make(FigureOptions{options.quick});
            const fs::path stem = options.out / figure.name;
            write(stem.string() + ".svg", figure.svg);
            write(stem.string() + ".png", reports::svg_to_png(figure.svg, figure.png_width));
            write(stem.string() + ".csv", figure.numbers.csv());
            for (const FigureFile& file : figure.files) write(options.out / file.name, file.bytes);
            figure.seconds = steady_seconds() - begin;
            entry["name"] = figure.name;
            entry["seconds"] = figure.seconds;
            entry["checks"] = nlohmann::ordered_json::array();
            std::string line = figure.name + "  " + duration_text(figure.seconds);
            for (const FigureCheck& check : figure.checks) {
                missed = missed || !check.met;
                entry["checks"].push_back({{"what", check.what},
                                           {"value", check.value},
                                           {"wanted", check.wanted},
                                           {"why", check.reason},
                                           {"met", check.met}});
                line += "\n  " + std::string(check.met ? "ok   " : "MISS ") + check.what + ": " + check.value + " (" +
                        check.wanted + ")";
            }
            summary.lines.push_back(line);
            done.push_back(std::move(figure));
        } catch (const StoreError&) {
            throw;
        } catch (const std::exception& problem) {
            failed = true;
            entry["problem"] = problem.what();
            std::cerr << "morphodesic: figure " << kind->key << ": " << problem.what() << "\n";
        }
        summary.data["figures"].push_back(std::move(entry));
    }
    if (done.empty()) return bad_usage;
    write(options.out / "gallery.html", gallery_page(done, options.quick));
    if (!options.markdown.empty()) {
        std::string command = "morphodesic figures";
        for (const std::string& key : options.keys) command += " " + key;
        command += (options.quick ? " --quick" : "") + std::string(" --markdown ") + options.markdown.string();
        write(options.markdown, gallery_markdown(done, command));
        for (const Figure& figure : done) {
            write(fs::absolute(options.markdown).parent_path() / (figure.name + ".svg"), figure.svg);
        }
        summary.lines.push_back("Markdown  " + options.markdown.string());
    }
    summary.data["gallery"] = (options.out / "gallery.html").string();
    summary.lines.push_back("gallery  " + (options.out / "gallery.html").string());
    if (failed || missed) summary.exit_code = some_failed;
    return summary.print(options.common);
}

}  // namespace morphodesic::pipeline
