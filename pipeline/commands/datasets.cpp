#include "pipeline/commands/datasets.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "pipeline/commands/summary.h"
#include "pipeline/study_folder.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;
using Generator = std::function<std::vector<datasets::Drawing>(const DatasetOptions&)>;

struct Kind {
    const char* name;
    const char* help;
    Generator generate;
    int count;
};

std::vector<Kind> kinds() {
    using datasets::CollectionOptions;
    return {
        {"letters", "letters from installed fonts, each character a class",
         [](const DatasetOptions& o) {
             datasets::LettersOptions letters = o.letters;
             static_cast<CollectionOptions&>(letters) = o.collection;
             return datasets::letters(letters);
         },
         24},
        {"bars", "bars of one length and width, from straight to rolled up",
         [](const DatasetOptions& o) { return datasets::bars(o.collection); }, 24},
        {"dumbbells", "two disks joined by a bar, from even to lopsided",
         [](const DatasetOptions& o) { return datasets::dumbbells(o.collection); }, 24},
        {"disks", "disks of several sizes, whose distances are known in closed form",
         [](const DatasetOptions& o) { return datasets::disks(o.collection); }, 24},
        {"matchstick", "matchstick men: persons in poses",
         [](const DatasetOptions& o) { return datasets::matchstick(o.collection); }, 30},
    };
}

int write(const DatasetOptions& options, const std::string& kind, const Generator& generate) {
    const auto problems = options.collection.problems();
    if (!problems.empty()) throw std::invalid_argument(problems.front());
    const fs::path folder = options.out.empty() ? fs::path(kind) : options.out;
    const std::vector<datasets::Drawing> drawings = generate(options);
    Summary summary;
    summary.data = {{"folder", folder.string()}, {"shapes", drawings.size()}};
    summary.lines.push_back(std::to_string(drawings.size()) + " shapes in " + folder.string());
    if (options.hide_limbs) {
        datasets::write_hidden_limbs(drawings, folder, options.side, options.collection.seed);
        summary.lines.push_back("Classify them with: morphodesic classify " + folder.string() +
                                " --templates FOLDER of whole ones, made by: morphodesic datasets matchstick");
        return summary.print(options.common);
    }
    datasets::write_collection(folder, drawings, options.side);
    summary.lines.push_back("Study them with: morphodesic run " + folder.string());
    return summary.print(options.common);
}

int write_queries(const DatasetOptions& options) {
    datasets::ScanResult scan = datasets::scan_folder(options.source, {options.reading.labels});
    std::vector<StudyFailure> failures;
    for (const auto& problem : scan.problems) failures.push_back({"", "", problem.message()});
    if (scan.sources.empty()) throw std::invalid_argument(options.source.string() + ": no shapes to occlude");
    const fs::path folder =
        options.out.empty() ? fs::path(with_last_name(options.source).string() + ".occluded") : options.out;
    const datasets::OcclusionSummary written =
        datasets::write_occluded(scan.sources, folder, options.occlusion, options.reading.import);
    for (const auto& problem : written.problems) failures.push_back({"", "", problem.message()});
    Summary summary;
    summary.data = {{"folder", folder.string()}, {"queries", written.queries}};
    if (written.queries == 0) {
        summary.exit_code = bad_usage;
        summary.lines.emplace_back("No shape could be used.");
    } else {
        // Solids are open where a part was taken away: that is all the mask they need.
        const bool masks = std::any_of(scan.sources.begin(), scan.sources.end(),
                                       [](const datasets::ShapeSource& source) { return source.dimension == 2; });
        summary.lines.push_back(std::to_string(written.queries) + (written.queries == 1 ? " query" : " queries") +
                                (!masks                 ? ", open where a part is hidden,"
                                 : written.queries == 1 ? " with mask"
                                                        : " with masks") +
                                " and truth.csv in " + folder.string());
        if (written.repeated > 0) {
            summary.add_remark(
                std::to_string(written.repeated) + (written.repeated == 1 ? " query is" : " queries are") +
                " left out: they would be others over again, as fewer parts can be hidden than --per-shape asks for.");
        }
        summary.lines.push_back("Classify them with: morphodesic classify " + folder.string() + " --templates " +
                                options.source.string());
    }
    summary.add_failures(failures);
    return summary.print(options.common);
}

void add_occlude(CLI::App& datasets_command, DatasetOptions& options,
                 const std::function<void(std::function<int()>)>& choose) {
    CLI::App* sub = datasets_command.add_subcommand("occlude", "hide parts of shapes, to make queries for classify");
    sub->footer(
        "Examples:\n"
        "  morphodesic datasets occlude fish --fraction 0.3 --kind half-plane --seed 1 --out queries\n"
        "  morphodesic datasets occlude fish --kind limb --fraction 0.15 --per-shape 4\n"
        "  morphodesic datasets occlude feet --fraction 0.2 --direction 1,0,0           solids without their toes");
    sub->add_option("folder", options.source, "folder of the shapes")->required();
    sub->add_option("--out", options.out, "folder of the queries; default: FOLDER.occluded")->option_text("FOLDER");
    sub->add_option("--fraction", options.occlusion.fraction, "share of the shape's area to hide, above 0 and below 1")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    sub->add_option("--kind", options.occlusion.kind, "half-plane, disk, stripe or limb")
        ->check(CLI::IsMember({"half-plane", "disk", "stripe", "limb"}))
        ->capture_default_str();
    sub->add_option("--seed", options.occlusion.seed, "another seed, other queries")->capture_default_str();
    sub->add_option("--per-shape", options.occlusion.per_shape, "queries made from every shape")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    sub->add_option("--direction", options.occlusion.direction,
                    "half-plane: side on which the hidden part lies, x,y (y up) or x,y,z; default: random")
        ->delimiter(',')
        ->option_text("X,Y[,Z]");
    sub->add_flag("--largest-part", options.occlusion.largest_part, "hide all of what is left but its largest part");
    sub->add_option("--labels", options.reading.labels, "where labels come from: auto, csv, folder, name or none")
        ->capture_default_str();
    datasets::ImportOptions::for_each_field(options.reading.import,
                                            [&](const std::string& name, auto& field, const char* help) {
                                                sub->add_option("--" + name, field, help)->capture_default_str();
                                            });
    sub->add_flag("--json", options.common.json, "print the summary as one JSON object on standard output");
    sub->add_flag("--quiet", options.common.quiet, "no summary in words");
    sub->callback([choose, &options] {
        choose([&options] {
            for (const auto& problems : {options.occlusion.problems(), options.reading.import.problems()}) {
                if (!problems.empty()) throw std::invalid_argument(problems.front());
            }
            return write_queries(options);
        });
    });
}

}  // namespace

void add_dataset_kinds(CLI::App& datasets_command, DatasetOptions& options,
                       const std::function<void(std::function<int()>)>& choose) {
    add_occlude(datasets_command, options, choose);
    for (const Kind& kind : kinds()) {
        CLI::App* sub = datasets_command.add_subcommand(kind.name, kind.help);
        const std::string name = kind.name;
        sub->footer("Examples:\n  morphodesic datasets " + name + "\n  morphodesic datasets " + name + " --out my-" +
                    name + " --count 12 --variation 0.5 --seed 7" +
                    (name == "letters" ? "\n  morphodesic datasets letters --characters EFH --font "
                                         "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf"
                                       : ""));
        sub->add_option("--out", options.out, "folder of the collection; default: " + name)->option_text("FOLDER");
        auto* count =
            sub->add_option("--count", options.collection.count, "number of shapes")->check(CLI::Range(1, 100000));
        count->default_str(std::to_string(kind.count));
        sub->add_option("--variation", options.collection.variation, "how varied, from 0 to 1")
            ->check(CLI::Range(0.0, 1.0))
            ->capture_default_str();
        sub->add_option("--seed", options.collection.seed, "another seed, another collection")->capture_default_str();
        sub->add_option("--size", options.side, "width and height of the pictures in pixels")
            ->check(CLI::Range(8, 8192))
            ->capture_default_str();
        if (name == "letters") {
            sub->add_option("--characters", options.letters.characters, "every character is a class")
                ->capture_default_str();
            sub->add_option("--font", options.letters.fonts,
                            "font files; default: installed fonts that have the characters")
                ->option_text("FILE ...");
        }
        if (name == "matchstick") {
            sub->add_flag("--hide-limbs", options.hide_limbs,
                          "queries for classify: an arm and a leg are hidden (NAME.mask.png, truth.csv)");
        }
        sub->add_flag("--json", options.common.json, "print the summary as one JSON object on standard output");
        sub->add_flag("--quiet", options.common.quiet, "no summary in words");
        sub->callback([choose, &options, kind, count] {
            choose([&options, kind, given = count->count() > 0] {
                if (!given) options.collection.count = kind.count;
                return write(options, kind.name, kind.generate);
            });
        });
    }
}

}  // namespace morphodesic::pipeline
