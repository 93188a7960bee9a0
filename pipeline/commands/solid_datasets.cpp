#include "pipeline/commands/solid_datasets.h"

#include <CLI/CLI.hpp>

#include "pipeline/commands/summary.h"

namespace morphodesic::pipeline {
namespace {

namespace fs = std::filesystem;

struct SolidKind {
    const char* name;
    const char* help;
    std::function<std::vector<datasets::GeneratedSolid>(const SolidDatasetOptions&)> generate;
    int count;
};

std::vector<SolidKind> solid_kinds() {
    return {
        {"feet", "left feet (3D) that differ in length, width, arch, instep and toes, and one outlier",
         [](const SolidDatasetOptions& o) { return datasets::feet(o.feet); }, 8},
        {"quadrupeds", "cats and lions (3D) in poses",
         [](const SolidDatasetOptions& o) { return datasets::quadrupeds(o.feet); }, 8},
    };
}

int write(const SolidDatasetOptions& options, const SolidKind& kind) {
    const auto problems = options.feet.problems();
    if (!problems.empty()) throw std::invalid_argument(problems.front());
    const fs::path folder = options.out.empty() ? fs::path(kind.name) : options.out;
    std::vector<datasets::GeneratedSolid> solids = kind.generate(options);
    for (std::size_t i = 0, count = solids.size(); options.damaged && i < count; ++i) {
        datasets::GeneratedSolid scan = solids[i];
        scan.name += "-scan";
        datasets::DamageOptions damage;
        damage.seed = options.feet.seed + i;
        scan.mesh = datasets::damaged(scan.mesh, damage);
        solids.push_back(std::move(scan));
    }
    datasets::write_collection(folder, solids);
    Summary summary;
    summary.data = {{"folder", folder.string()}, {"shapes", solids.size()}};
    summary.lines.push_back(std::to_string(solids.size()) + " solids in " + folder.string());
    summary.lines.push_back("Study them with: morphodesic run " + folder.string() + " --preset fast");
    return summary.print(options.common);
}

}  // namespace

void add_solid_kinds(CLI::App& datasets_command, SolidDatasetOptions& options,
                     const std::function<void(std::function<int()>)>& choose) {
    for (const SolidKind& kind : solid_kinds()) {
        CLI::App* sub = datasets_command.add_subcommand(kind.name, kind.help);
        const std::string name = kind.name;
        sub->footer("Examples:\n  morphodesic datasets " + name + "\n  morphodesic datasets " + name + " --out my-" +
                    name + " --count 12 --variation 0.5 --seed 7\n  morphodesic run " + name + " --preset fast");
        sub->add_option("--out", options.out, "folder of the collection; default: " + name)->option_text("FOLDER");
        auto* count = sub->add_option("--count", options.feet.count, "number of solids")->check(CLI::Range(1, 10000));
        count->default_str(std::to_string(kind.count));
        sub->add_option("--variation", options.feet.variation, "how varied, from 0 to 1")
            ->check(CLI::Range(0.0, 1.0))
            ->capture_default_str();
        sub->add_option("--seed", options.feet.seed, "another seed, another collection")->capture_default_str();
        if (name == "feet") {
            sub->add_flag("--equal-volume", options.feet.equal_volume, "scale all to the volume of the mean foot");
        }
        sub->add_flag("--damaged", options.damaged,
                      "also a bad scan of each: holes, noise, flipped patches, fewer triangles (NAME-scan.ply)");
        sub->add_flag("--json", options.common.json, "print the summary as one JSON object on standard output");
        sub->add_flag("--quiet", options.common.quiet, "no summary in words");
        sub->callback([choose, &options, kind, count] {
            choose([&options, kind, given = count->count() > 0] {
                if (!given) options.feet.count = kind.count;
                return write(options, kind);
            });
        });
    }
}

}  // namespace morphodesic::pipeline
