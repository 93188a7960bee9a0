#include "pipeline/command_line.h"

#include <cmath>
#include <cstdlib>
#include <type_traits>

namespace morphodesic::pipeline {

namespace {
std::string preset_help() {
    std::string text = "Presets:\n";
    for (const Preset& preset : presets()) {
        text += "  " + std::string(preset.name) + std::string(10 - std::string(preset.name).size(), ' ') + preset.help +
                "\n";
    }
    return text;
}

/// Refuses what reads as a number but is none to compute with: NaN even passes every test for a range.
void refuse_infinite_numbers(CLI::App& app) {
    for (CLI::Option* option : app.get_options()) {
        if (option->get_type_name().rfind("FLOAT", 0) != 0) continue;
        option->check([](const std::string& text) {
            return std::isfinite(std::strtod(text.c_str(), nullptr)) ? std::string() : text + " is not a finite number";
        });
    }
    for (CLI::App* sub : app.get_subcommands(nullptr)) refuse_infinite_numbers(*sub);
}

/// Adds fields of a struct, by its for_each_field, to a group of options: flags for what is true or false.
auto adder(CLI::App& command, const char* group) {
    return [&command, group](const std::string& name, auto& field, const char* help) {
        if constexpr (std::is_same_v<std::decay_t<decltype(field)>, bool>) {
            command.add_flag("--" + name, field, help)->group(group);
        } else {
            command.add_option("--" + name, field, help)->capture_default_str()->group(group);
        }
    };
}
}  // namespace

CommandLine::CommandLine(const RunSettings& defaults) {
    study.settings = pair.settings = classify.settings = defaults;
    app.set_version_flag("--version", "morphodesic " MORPHODESIC_VERSION);
    app.require_subcommand(1);
    app.footer(
        "A first study:\n"
        "  morphodesic datasets letters --out letters      make a collection of pictures\n"
        "  morphodesic run letters                         study it; the report is letters.study/report.html\n"
        "  morphodesic geodesic a.png b.png --out path     one geodesic, with pictures\n"
        "Help on a command: morphodesic run --help\n"
        "\n"
        "Exit codes: 0 all done; 1 done, but some shapes or pairs failed and are listed; 2 bad usage or nothing "
        "usable;\n"
        "3 the environment failed (disk full, store damaged or locked); 128 + n stopped by signal n, give the same\n"
        "command again to go on.");
    const std::string at_file = " Options may also stand in a TOML file: level = 6, one per line (--config FILE).";
    add_study_command(
        "run", "study a folder of shapes: ingest, geodesics, analyze and report in one go.",
        preset_help() +
            "\nExamples:\n"
            "  morphodesic run letters                             report: letters.study/report.html\n"
            "  morphodesic run letters --preset fast               a first look\n"
            "  morphodesic run fish --labels none --foreground dark\n"
            "  morphodesic run fish --config fish.toml --out results/fish\n"
            "The same command again computes only what is missing: after Ctrl-C, after a crash, after new\n"
            "files came into the folder. Results of different settings never mix." +
            at_file,
        &pipeline::run, true, true);
    add_study_command("ingest", "read, clean and place the shapes of a folder, and store them in a study.",
                      "Examples:\n"
                      "  morphodesic ingest letters\n"
                      "  morphodesic ingest scans --out study --normalize each --json",
                      &pipeline::ingest, true, false);
    add_study_command(
        "geodesics", "compute the geodesics that a study is missing.",
        preset_help() +
            "\nWithout options the settings are those the study was made with; a preset replaces level, steps,\n"
            "tolerance, starts and rounds. How the files were read and placed stays.\n"
            "Examples:\n"
            "  morphodesic geodesics letters.study\n"
            "  morphodesic geodesics letters.study --preset fine --threads 4",
        &pipeline::geodesics, false, true);
    add_study_command("analyze", "distances, clusters and embedding of a study as CSV and NPY files.",
                      "Examples:\n"
                      "  morphodesic analyze letters.study\n"
                      "  morphodesic analyze letters.study --json\n"
                      "  morphodesic analyze distances.csv --labels labels.csv --linkage ward --clusters 4\n"
                      "  morphodesic analyze letters.study --place query.classified/ranking.csv",
                      &pipeline::analyze, false, false);
    add_study_command("report", "analyze, and write report.html and report.json of a study.",
                      "Examples:\n"
                      "  morphodesic report letters.study\n"
                      "  morphodesic report letters.study --paths all        draw the path of every pair\n"
                      "  morphodesic report letters.study --compare fine.study\n"
                      "  morphodesic report distances.csv --labels labels.csv",
                      &pipeline::report, false, false);
    add_study_command("verify", "compute a random sample of a study's pairs again and compare with the store.",
                      "Examples:\n"
                      "  morphodesic verify letters.study\n"
                      "  morphodesic verify letters.study --sample 100 --seed 7 --json",
                      &pipeline::verify, false, false);
    add_geodesic();
    add_classify();
    add_datasets();
    add_figures();
    add_shards();
    refuse_infinite_numbers(app);
}

CLI::App* CommandLine::command(const std::string& name, const std::string& help, const std::string& footer) {
    CLI::App* command = app.add_subcommand(name, help);
    command->footer(footer);
    command->option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    add_config(command);
    return command;
}

void CommandLine::add_config(CLI::App* command) {
    command
        ->add_option(
            "--config", config,
            "TOML file with options; those on the command line overrule it, and of several files the later one")
        ->option_text("FILE");
}

void CommandLine::add_common(CLI::App* command, CommonOptions& common, bool computes) {
    if (computes) {
        command
            ->add_option("--threads", common.threads,
                         "processor cores to use; 0: all. The results are the same for any")
            ->check(CLI::Range(0, 1024))
            ->capture_default_str();
    }
    command->add_flag("--json", common.json, "print the summary as one JSON object on standard output");
    command->add_flag("--quiet", common.quiet, "no progress and no summary in words; problems are still listed");
}

void CommandLine::add_settings(CLI::App* command, RunSettings& settings, bool with_import) {
    command->add_option("--preset", preset, "where the defaults come from: fast, standard or fine")
        ->check(CLI::IsMember({"fast", "standard", "fine"}));
    const auto add = adder(*command, "Geodesics");
    if (with_import) {
        RunSettings::for_each_field(settings, add);
        for (const char* name :
             {"--dimension", "--close-gaps", "--noise", "--mirror", "--isovalue", "--inside", "--max-megabytes",
              "--labels", "--foreground", "--speck-fraction", "--max-megapixels", "--normalize"}) {
            command->get_option(name)->group("Shapes");
        }
    } else {
        GeodesicOptions::for_each_field(settings.geodesic, add);
    }
}

void CommandLine::add_study_command(const std::string& name, const std::string& help, const std::string& footer,
                                    int (*function)(const StudyOptions&), bool from_files, bool computes) {
    CLI::App* sub = command(name, help, footer);
    if (from_files) {
        sub->add_option("folder", study.collection, "folder with the shapes; its folders are read too")->required();
        sub->add_option("--out", study.study, "study folder; default: FOLDER.study")->option_text("STUDY");
    } else {
        const bool takes_tables = name == "analyze" || name == "report";
        sub->add_option("study", study.study,
                        takes_tables ? "study folder, or a table of distances (CSV) from anywhere" : "study folder")
            ->required();
        if (takes_tables) add_findings(sub);
    }
    add_common(sub, study.common, true);
    if (from_files || computes) add_settings(sub, study.settings, from_files);
    if (from_files || computes) PairSelection::for_each_field(study.settings.pairs, adder(*sub, "Pairs"));
    if (computes) {
        sub->add_option("--memory", study.memory,
                        "memory the run may take, such as 4G or 800M: limits the pairs computed at once; default: 80 % "
                        "of what is available")
            ->option_text("SIZE");
    }
    if (computes) sub->add_flag("--retry-failed", study.retry_failed, "compute pairs again that failed before");
    if (name == "run" || name == "report") {
        sub->add_option("--paths", study.paths,
                        "paths that are drawn: how many (the most telling ones), nearest (every shape with its nearest "
                        "neighbour), all or none")
            ->capture_default_str();
    }
    if (name == "analyze" || name == "report" || name == "run") {
        const auto add = adder(*sub, "Analysis");
        analysis::AnalysisOptions::for_each_field(study.analysis,
                                                  [&](const std::string& field, auto& value, const char* text) {
                                                      if (sub->get_option_no_throw("--" + field) != nullptr)
                                                          return;  // means something else to `run`
                                                      add(field, value, text);
                                                  });
    }
    if (name == "verify") {
        sub->add_option("--sample", study.sample, "number of pairs")
            ->check(CLI::Range(1, 1'000'000'000))
            ->capture_default_str();
        sub->add_option("--seed", study.seed, "another seed, another sample")->capture_default_str();
    }
    sub->callback([this, function] { action = [this, function] { return function(study); }; });
}

void CommandLine::add_findings(CLI::App* command) {
    const char* group = "Sources";
    command->add_option("--labels", study.labels, "table file,label of the classes, in place of those of the study")
        ->check(CLI::ExistingFile)
        ->option_text("FILE")
        ->group(group);
    command
        ->add_option("--compare", study.compare,
                     "another study (or table) to set beside this one: correlation of distances, moved neighbours")
        ->check(CLI::ExistingPath)
        ->option_text("STUDY")
        ->group(group);
    command
        ->add_option("--place", study.place,
                     "distances of further shapes to these (a row each, or ranking.csv of classify): placed in the "
                     "maps, placed.csv")
        ->check(CLI::ExistingFile)
        ->option_text("FILE")
        ->group(group);
    command->add_option("--errors", study.errors, "for a table: the error bars, as a table of the same labels")
        ->check(CLI::ExistingFile)
        ->option_text("FILE")
        ->group(group);
    command
        ->add_flag("--asymmetric", study.asymmetric,
                   "for a table: the sides of the diagonal are both directions; the distance is their mean")
        ->group(group);
    command->add_option("--out", study.out, "for a table: folder of the results; default: beside it, NAME.analysis")
        ->option_text("FOLDER")
        ->group(group);
}

void CommandLine::add_geodesic() {
    CLI::App* sub =
        command("geodesic", "compute one geodesic between two shapes.",
                preset_help() +
                    "\nBoth shapes are placed at the same scale, so that size differences count.\n"
                    "Where gaps close on the way, few steps make a path too short. So it is computed from the fuller\n"
                    "of the two shapes, with fewer gaps and limbs, as in studies, whichever is named first (path_from\n"
                    "in the answer); pictures lead from a to b.\n"
                    "Examples:\n"
                    "  morphodesic geodesic cat.png dog.png\n"
                    "  morphodesic geodesic cat.png dog.png --preset fine --out path   pictures: path/*.png\n"
                    "  morphodesic geodesic cat.png dog.png --json | jq .path_length");
    sub->add_option("a", pair.a, "first shape: a file")->required();
    sub->add_option("b", pair.b, "second shape: a file")->required();
    sub->add_option("--out", pair.out, "folder for the pictures of the path and geodesic.json")->option_text("FOLDER");
    sub->add_option(
           "--scale", pair.scale,
           "lengths of the unit cube per pixel (per unit of a mesh), as the common-scale of a study; 0: the larger "
           "shape just fits. Only with --normalize common")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    sub->add_option(
           "--direction", pair.direction,
           "the end that the path is computed from: auto, that of a study (one that is partly hidden, else the "
           "fuller shape), or given: a")
        ->check(CLI::IsMember({"auto", "given"}))
        ->capture_default_str();
    add_common(sub, pair.common, true);
    add_settings(sub, pair.settings, true);
    sub->callback([this] { action = [this] { return pipeline::geodesic(pair); }; });
}

void CommandLine::add_classify() {
    CLI::App* sub = command(
        "classify", "say what partly hidden shapes are, by their geodesics to templates of known classes.",
        preset_help() +
            "\nWhere a query is unknown is told by a picture NAME.mask.png beside it (white = hidden), by --mask, by\n"
            "transparency or a colour (--occluder), by the border that cuts it off (--border hides) or by the holes of "
            "a\n"
            "scan. --mask auto estimates it. Templates are a folder of shapes or a study; defaults are those of the\n"
            "study, whose shapes are taken as they were read and placed, for a folder those of the preset fast.\n"
            "Examples:\n"
            "  morphodesic classify query.png --templates letters\n"
            "  morphodesic classify query.png --templates letters.study --occluder \"#808080\"\n"
            "  morphodesic classify scans --templates feet --json | jq .accuracy     scans/truth.csv: file,label\n"
            "  morphodesic classify photo.png --templates fish --mask auto --normalize each\n"
            "  morphodesic classify --templates fish --leave-one-out                 how good are the templates?");
    sub->add_option("queries", classify.queries, "files, or folders of which all shapes are queries")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    sub->add_option("--templates", classify.templates, "folder of shapes of known classes, or a study")
        ->required()
        ->option_text("DIR|STUDY");
    sub->add_option("--out", classify.out, "folder for the results; default: QUERY.classified")->option_text("FOLDER");
    sub->add_option("--mask", classify.mask,
                    "known (masks beside the queries, occluder, border), none (take the queries as they are), auto "
                    "(estimate what is not known) or a mask image for the one query")
        ->capture_default_str();
    sub->add_option(
           "--truth", classify.truth,
           "table file,label of the true classes; default: truth.csv in the folder of the queries, or beside a "
           "query that is named by itself")
        ->option_text("FILE");
    sub->add_flag("--leave-one-out", classify.leave_one_out, "classify every template by the others; without queries");
    sub->add_option("--pictures", classify.pictures, "queries whose paths are drawn on the page")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    sub->add_option("--filmstrips", classify.filmstrips, "paths that are drawn for a query")
        ->check(CLI::Range(0, 50))
        ->capture_default_str();
    add_common(sub, classify.common, true);
    add_settings(sub, classify.settings, true);
    const auto add = adder(*sub, "Classification");
    ClassifyOptions::for_each_field(classify.classify, [&](std::string name, auto& value, const char* text) {
        if (std::is_same_v<std::decay_t<decltype(value)>, bool>) name += ",!--no-" + name;
        if (name == "neighbours") name += ",--neighbors";
        add(name, value, text);
    });
    sub->callback([this] { action = [this] { return pipeline::classify(classify); }; });
}

void CommandLine::add_datasets() {
    CLI::App* sub = command("datasets", "make a collection of shapes from formulas or installed fonts.",
                            "Examples:\n"
                            "  morphodesic datasets letters --out letters\n"
                            "  morphodesic datasets feet --out feet                3D\n"
                            "  morphodesic datasets letters --help");
    sub->require_subcommand(1);
    add_dataset_kinds(*sub, dataset, [this](std::function<int()> generate) { action = std::move(generate); });
    add_solid_kinds(*sub, solids, [this](std::function<int()> generate) { action = std::move(generate); });
    for (CLI::App* kind : sub->get_subcommands(nullptr)) add_config(kind);
}

void CommandLine::add_figures() {
    CLI::App* sub = command("figures", "compute the figures of the paper, with the numbers behind them.",
                            "Figures:\n" + figures_help() +
                                "Examples:\n"
                                "  morphodesic figures --out figures          all; the page is figures/gallery.html\n"
                                "  morphodesic figures 2 3 --quick            two of them, on coarse grids");
    sub->add_option("figures", figures.keys, "which figures; default: all")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->option_text("KEY ...");
    sub->add_option("--out", figures.out,
                    "folder for pictures, tables and gallery.html (of the figures of this run); default: figures")
        ->option_text("FOLDER");
    sub->add_option("--markdown", figures.markdown,
                    "file for captions, checks and tables as Markdown, pictures beside it")
        ->option_text("FILE");
    sub->add_flag("--quick", figures.quick, "coarse grids and few steps: a minute instead of a quarter of an hour");
    add_common(sub, figures.common, true);
    sub->callback([this] { action = [this] { return pipeline::figures(figures); }; });
}

void CommandLine::add_shards() {
    const std::string steps =
        "Examples: a study on many processes or machines\n"
        "  morphodesic ingest fish                               take the shapes in\n"
        "  morphodesic plan fish.study --shards 16               writes fish.study/shards/plan.sqlite\n"
        "  morphodesic shard fish.study 3/16                     each of them, anywhere; again after a stop\n"
        "  morphodesic shard plan.sqlite 3/16 --out 3.jsonl      the same where only the plan was copied to\n"
        "  morphodesic merge fish.study                          in any order, as often as you like\n"
        "  morphodesic merge fish.study results/*.jsonl\n"
        "  morphodesic report fish.study\n"
        "With --format slurm or makeflow the plan comes with a script that runs all shards.";
    CLI::App* planning =
        command("plan", "divide the pairs that a study is missing among processes or machines.", steps);
    planning->add_option("study", shards.study, "study folder, with its shapes taken in")->required();
    planning->add_option("--shards", shards.shards, "how many parts")->required()->check(CLI::Range(1, 100000));
    planning
        ->add_option("--format", shards.format,
                     "list: only the plan; slurm: with an array script for sbatch; makeflow: with a workflow for "
                     "Makeflow (local, Work Queue, Slurm, HTCondor, Kubernetes)")
        ->check(CLI::IsMember({"list", "slurm", "makeflow"}))
        ->capture_default_str();
    CLI::App* working = command("shard", "compute one part of a planned study into one result file.", steps);
    working->add_option("study", shards.study, "study folder, or a copy of its plan (plan.sqlite)")->required();
    working->add_option("shard", shards.shard, "which part of how many, such as 3/16")->required()->option_text("I/N");
    working->add_option("--out", shards.out, "result file, only ever appended to; default: beside the plan")
        ->option_text("FILE");
    working->add_option("--memory", shards.memory, "memory it may take, such as 4G; default: 80 % of what is available")
        ->option_text("SIZE");
    CLI::App* joining = command("merge", "take the results of shards into their study.", steps);
    joining->add_option("study", shards.study, "study folder")->required();
    joining->add_option("files", shards.files, "result files; default: all beside the plan")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->option_text("FILE ...");
    for (CLI::App* sub : {working, joining}) {
        sub->add_flag(
            "--accept-failures", shards.accept_failures,
            "exit code 0 also if some pairs have no trustworthy distance: for engines that stop at any other");
    }
    add_common(planning, shards.common, false);
    add_common(working, shards.common, true);
    add_common(joining, shards.common, false);
    planning->callback([this] { action = [this] { return pipeline::plan(shards); }; });
    working->callback([this] { action = [this] { return pipeline::shard(shards); }; });
    joining->callback([this] { action = [this] { return pipeline::merge(shards); }; });
}

}  // namespace morphodesic::pipeline
