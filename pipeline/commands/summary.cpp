#include "pipeline/commands/summary.h"

#include <tbb/info.h>

#include <cctype>
#include <iostream>
#include <map>

#include "pipeline/process_limits.h"
#include "pipeline/standard_streams.h"
#include "pipeline/stop_signals.h"

namespace morphodesic::pipeline {

void Summary::add_remark(const std::string& remark) {
    lines.push_back(remark);
    data["remarks"].push_back(remark);
}

void Summary::add_shortfall(const std::string& sentence) {
    add_remark(sentence);
    shortfalls_.push_back(sentence);
    if (exit_code == all_done) exit_code = some_failed;
}

void Summary::add_notes(const std::vector<StoredShape>& shapes) {
    constexpr std::size_t shown = 20, named = 3;
    auto list = nlohmann::ordered_json::array();
    std::vector<std::vector<const StoredShape*>> groups;
    std::map<std::vector<std::string>, std::size_t> group_of;
    for (const StoredShape& shape : shapes) {
        if (shape.notes.empty()) continue;
        list.push_back({{"file", shape.name}, {"notes", shape.notes}});
        const auto [known, fresh] = group_of.try_emplace(shape.notes, groups.size());
        if (fresh) groups.emplace_back();
        groups[known->second].push_back(&shape);
    }
    data["notes"] = std::move(list);
    for (std::size_t g = 0; g < groups.size() && g < shown; ++g) {
        std::string line;
        for (std::size_t i = 0; i < std::min(groups[g].size(), named); ++i) {
            line += (i == 0 ? "" : ", ") + groups[g][i]->name;
        }
        if (groups[g].size() > named) line += " and " + std::to_string(groups[g].size() - named) + " more";
        line += ":";
        for (const std::string& note : groups[g].front()->notes) line += " " + note;
        lines.push_back(std::move(line));
    }
    if (groups.size() > shown) {
        lines.push_back("and " + std::to_string(groups.size() - shown) +
                        " more lines on what was done to files; --json gives all");
    }
}

void Summary::add_missing_pairs(const StudyData& study, const std::filesystem::path& folder) {
    const long missing = study.pairs_missing - static_cast<long>(study.damaged.size());
    if (missing <= 0) return;
    add_shortfall(std::to_string(missing) +
                  (missing == 1 ? " pair is not computed yet; do it" : " pairs are not computed yet; do it") +
                  " with: morphodesic geodesics " + folder.string());
}

void Summary::add_failures(std::vector<StudyFailure> failures) {
    constexpr std::size_t shown = 20;
    failures.insert(failures.end(), cut_off.begin(), cut_off.end());
    auto list = nlohmann::ordered_json::array();
    std::size_t files = 0, pairs = 0;
    for (const StudyFailure& failure : failures) {
        if (!failure.b.empty()) ++pairs;
        if (failure.b.empty() && !failure.cut_off) ++files;
        list.push_back({{"a", failure.a}, {"b", failure.b}, {"reason", failure.reason}});
    }
    data["failures"] = std::move(list);
    if (failures.empty()) return;
    if (exit_code == all_done) exit_code = some_failed;
    std::string head;
    const auto say = [&](const char* what, std::size_t count, const std::string& noun) {
        if (count == 0) return;
        head += (head.empty() ? "" : "; ") + std::string(what) + std::to_string(count) + " " + noun;
        if (count > 1) head += "s";
    };
    say("left out: ", files, "file");
    say("without a trustworthy distance: ", pairs, "pair");
    say("cut off from the others: ", cut_off.size(), "shape");
    head[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(head[0])));
    lines.push_back(head);
    for (std::size_t i = 0; i < failures.size() && i < shown; ++i) {
        const StudyFailure& failure = failures[i];
        lines.push_back(failure.b.empty() ? "  " + failure.reason
                                          : "  " + failure.a + " - " + failure.b + ": " + failure.reason);
    }
    if (failures.size() > shown) lines.push_back("  and " + std::to_string(failures.size() - shown) + " more");
}

int Summary::print(const CommonOptions& options) {
    if (options.json) {
        data["exit_code"] = exit_code;
        std::cout << data.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
    } else if (!options.quiet) {
        for (const std::string& line : lines) std::cout << printable(line) << "\n";
        std::cout << std::flush;
    }
    if ((options.json || options.quiet) && exit_code != all_done) {
        // Problems are said on the error stream also where the summary is not for people.
        for (const std::string& shortfall : shortfalls_) std::cerr << "morphodesic: " << shortfall << "\n";
        for (const auto& failure : data.value("failures", nlohmann::ordered_json::array())) {
            const auto a = failure["a"].get<std::string>(), b = failure["b"].get<std::string>();
            std::cerr << "morphodesic: " << (b.empty() ? "" : a + " - " + b + ": ")
                      << failure["reason"].get<std::string>() << "\n";
        }
    }
    return exit_code;
}

int stopped_by_signal(const std::string& state, const std::string& again) {
    std::cerr << "morphodesic: stopped" << state << ". To go on, give the same command again"
              << (again.empty() ? "" : ": " + again) << "\n";
    return 128 + StopSignals::caught();
}

std::string shell_word(const std::string& word) {
    if (!word.empty() &&
        word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=./,+:@") ==
            std::string::npos) {
        return word;
    }
    std::string result = "'";
    for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

int thread_count(const CommonOptions& options) {
    const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
    constexpr int of_libraries = 9;  // measured: what drawing the figures starts on top
    expect_threads(threads + of_libraries);
    return threads;
}

}  // namespace morphodesic::pipeline
