#include "pipeline/common_scale.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <set>

#include "datasets/normalize.h"
#include "pipeline/digest.h"
#include "pipeline/run_settings.h"

namespace morphodesic::pipeline {
namespace {

double number_from(const std::string& text) {
    double x = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), x);
    return x;
}

/// What a frozen scale belongs to: the options that decide what is read. Limits only decide whether.
/// @param dimension  0: as older programs wrote it, which had one scale for images and solids
std::string fact_of(datasets::ImportOptions options, int dimension) {
    const datasets::ImportOptions defaults;
    options.max_megabytes = defaults.max_megabytes;
    options.max_megapixels = defaults.max_megapixels;
    return "common_scale of " + digest(canonical_text(options)) +
           (dimension == 0 ? "" : " in " + std::to_string(dimension) + "D");
}

std::string origin_fact(const std::string& fact) {
    return "origin of " + fact;
}

bool smaller(const SizedFile& a, const SizedFile& b) {
    return a.size < b.size;
}

/// The digests of all files that were there, each with a blank behind it; then the name of the largest, which fixed the
/// scale.
std::string origin_of(const std::vector<SizedFile>& files) {
    std::string text;
    for (const SizedFile& file : files) text += file.digest + " ";
    return text + "\n" + std::max_element(files.begin(), files.end(), smaller)->name;
}

/// The name of the file that fixed the scale, with a word on what became of it.
std::string lost_file(const std::string& origin, const std::vector<SizedFile>& files) {
    const std::size_t end = origin.find('\n');
    if (end == std::string::npos) return "a file that is no longer among the shapes";
    const std::string name = origin.substr(end + 1);
    const bool another = std::any_of(files.begin(), files.end(), [&](const SizedFile& f) { return f.name == name; });
    return name + (another ? ", which is another shape now" : ", which is no longer among the shapes");
}

bool any_was_there(const std::string& origin, const std::vector<SizedFile>& files, const ResultStore& store) {
    std::set<std::string> before;  // of a study that does not know its origin: the files of the last run
    if (origin.empty()) {
        for (const StoredShape& shape : store.shapes()) before.insert(shape.file_digest);
    }
    return std::any_of(files.begin(), files.end(), [&](const SizedFile& file) {
        return origin.empty() ? before.contains(file.digest) : origin.find(file.digest + " ") != std::string::npos;
    });
}

std::string pairs_of(std::size_t shapes) {
    const std::size_t pairs = shapes * (shapes - 1) / 2;
    return " All shapes are placed anew: up to " + std::to_string(pairs) + (pairs == 1 ? " pair" : " pairs") +
           " to compute. Results of the old scale stay in the store and come back with ";
}

}  // namespace

std::string exact_text(double x) {
    char buffer[32];
    return {buffer, std::to_chars(buffer, buffer + sizeof buffer, x).ptr};
}

CommonScale choose_common_scale(const std::vector<SizedFile>& files, const datasets::ImportOptions& options,
                                int dimension, const ResultStore& store) {
    CommonScale chosen;
    if (files.empty()) return chosen;
    std::vector<double> sizes;
    for (const SizedFile& file : files) sizes.push_back(file.size);
    const double needed = datasets::common_scale(sizes);
    chosen.fact = fact_of(options, dimension);
    const auto anew = [&](std::string remark) {
        chosen.scale = needed;
        chosen.origin = origin_of(files);
        chosen.remark = std::move(remark);
        return chosen;
    };
    auto frozen = store.fact(chosen.fact), origin = store.fact(origin_fact(chosen.fact));
    if (!frozen && store.fact("dimension") == std::to_string(dimension)) {
        const std::string former = fact_of(options, 0);
        frozen = store.fact(former);
        origin = store.fact(origin_fact(former));
        // Studies of still older programs have one scale only.
        if (!frozen && store.fact("common_scale_key") == canonical_text(options)) frozen = store.fact("common_scale");
    }
    if (!frozen) return anew("");
    chosen.scale = number_from(*frozen);
    chosen.origin = origin.value_or("");
    constexpr double rounding = 1e-12;
    if (chosen.scale > needed * (1 + rounding)) {
        return anew("A new shape, " + std::max_element(files.begin(), files.end(), smaller)->name +
                    ", is larger than all before and does not fit at the scale of this study." +
                    pairs_of(files.size()) + "the files of before.");
    }
    if (chosen.scale >= needed * (1 - rounding)) return chosen;
    // Only a file that is gone can have been larger than all that are there.
    constexpr double much_smaller = 1.5;
    char factor[32];
    std::snprintf(factor, sizeof factor, "%.3g", needed / chosen.scale);
    const std::string fixed_by = "The scale of this study was fixed by " + lost_file(chosen.origin, files);
    const bool strangers = !any_was_there(chosen.origin, files, store);
    if (strangers || needed > much_smaller * chosen.scale) {
        return anew(fixed_by + (strangers ? ", and none of the shapes was there then" : "") +
                    "; a scale that fits the shapes takes its place, " + factor + " times as large." +
                    pairs_of(files.size()) + "that file.");
    }
    chosen.remark = fixed_by +
                    "; it is kept, so that nothing is computed anew. A new study (--out) would place the "
                    "shapes " +
                    factor + " times as large.";
    return chosen;
}

void keep_common_scale(const CommonScale& scale, ResultStore& store) {
    if (scale.scale == 0.0) return;
    const auto keep = [&](const std::string& fact, const std::string& value) {
        if (store.fact(fact) != value) store.set_fact(fact, value);
    };
    // What an older program kept belongs to the dimension that the study had so far.
    const std::string former = scale.fact.substr(0, scale.fact.rfind(" in "));
    const auto had = store.fact("dimension"), old = store.fact(former);
    const std::string taken_over = former + " in " + had.value_or("") + "D";
    if (had && old && !store.fact(taken_over)) {
        keep(origin_fact(taken_over), store.fact(origin_fact(former)).value_or(""));
        keep(taken_over, *old);
    }
    // The origin first: a scale without it would be taken for one of an older program.
    if (!scale.origin.empty()) keep(origin_fact(scale.fact), scale.origin);
    for (const std::string& fact : {std::string("common_scale"), scale.fact}) keep(fact, exact_text(scale.scale));
}

}  // namespace morphodesic::pipeline
