#include "pipeline/commands/datasets.h"

#include <CLI/CLI.hpp>

#include "pipeline/commands/summary.h"

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
    datasets::write_collection(folder, drawings, options.side);
    Summary summary;
    summary.data = {{"folder", folder.string()}, {"shapes", drawings.size()}};
    summary.lines.push_back(std::to_string(drawings.size()) + " shapes in " + folder.string());
    summary.lines.push_back("Study them with: morphodesic run " + folder.string());
    return summary.print(options.common);
}

}  // namespace

void add_dataset_kinds(CLI::App& datasets_command, DatasetOptions& options,
                       const std::function<void(std::function<int()>)>& choose) {
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
