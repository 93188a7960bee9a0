#include "pipeline/progress.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <utility>

namespace morphodesic::pipeline {
namespace {

constexpr double terminal_interval = 0.2, log_interval = 30.0, least_predicted = 2.0;  // seconds

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void write_to_stderr(const std::string& text) {
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
}

}  // namespace

std::string duration_text(double seconds) {
    char text[64];
    if (seconds < 10) {
        std::snprintf(text, sizeof text, "%.1f s", seconds);
    } else if (seconds < 59.5) {
        std::snprintf(text, sizeof text, "%.0f s", seconds);
    } else if (seconds < 3570) {
        const long whole = std::lround(seconds);
        std::snprintf(text, sizeof text, "%ld min %ld s", whole / 60, whole % 60);
    } else {
        const long minutes = std::lround(seconds / 60);
        std::snprintf(text, sizeof text, "%ld h %ld min", minutes / 60, minutes % 60);
    }
    return text;
}

Progress::Style Progress::style_of_stderr(bool quiet) {
    if (quiet) return Style::silent;
    return ::isatty(STDERR_FILENO) ? Style::terminal : Style::lines;
}

Progress::Progress(Style style) : Progress(style, write_to_stderr, steady_seconds) {}

Progress::Progress(Style style, Write write, Clock clock)
    : style_(style), write_(std::move(write)), clock_(std::move(clock)) {}

void Progress::message(const std::string& text) {
    if (style_ == Style::silent) return;
    const std::scoped_lock lock(mutex_);
    clear_line();
    write_(text + "\n");
}

void Progress::begin_pairs(long total, long stored, long missing, long pilots) {
    const std::scoped_lock lock(mutex_);
    missing_ = missing;
    pilots_ = pilots;
    done_ = failed_ = 0;
    begin_ = shown_ = clock_();
    if (style_ == Style::silent) return;
    clear_line();
    write_(std::to_string(total) + " pairs, " + std::to_string(stored) + " of them in the store, " +
           std::to_string(missing) + " to compute\n");
}

void Progress::pair_done(bool has_distance) {
    const std::scoped_lock lock(mutex_);
    ++done_;
    if (!has_distance) ++failed_;
    if (style_ == Style::silent) return;
    const double now = clock_();
    if (done_ == pilots_ && done_ < missing_) {
        const double predicted = (now - begin_) / static_cast<double>(done_) * static_cast<double>(missing_ - done_);
        if (predicted < least_predicted) return;
        clear_line();
        write_("about " + duration_text(predicted) + " to go, judged by the first " + std::to_string(done_) +
               " pairs, drawn at random\n");
        shown_ = now;
    }
    const double interval = style_ == Style::terminal ? terminal_interval : log_interval;
    if (now - shown_ < interval) return;
    shown_ = now;
    show_count();
}

void Progress::end_pairs() {
    const std::scoped_lock lock(mutex_);
    if (style_ == Style::silent) return;
    clear_line();
    if (done_ > 0) {
        const double seconds = clock_() - begin_;
        char rate[64] = "";
        if (seconds > 0)
            std::snprintf(rate, sizeof rate, ", %.3g pairs a second", static_cast<double>(done_) / seconds);
        write_(std::to_string(done_) + " pairs computed in " + duration_text(seconds) + rate + "\n");
    }
}

double Progress::seconds_since_begin() const {
    const std::scoped_lock lock(mutex_);
    return clock_() - begin_;
}

void Progress::show_count() {
    const double rate = static_cast<double>(done_) / std::max(clock_() - begin_, 1e-9);
    char text[160];
    const std::string left = duration_text(static_cast<double>(missing_ - done_) / rate);
    const int size =
        std::snprintf(text, sizeof text, "%ld of %ld pairs (%.0f %%), %.3g a second, %s left", done_, missing_,
                      100.0 * static_cast<double>(done_) / static_cast<double>(missing_), rate, left.c_str());
    std::string line(text, static_cast<std::size_t>(size));
    if (failed_ > 0) line += ", " + std::to_string(failed_) + " without a distance";
    if (style_ == Style::terminal) {
        write_("\r\033[K" + line);
        line_open_ = true;
    } else {
        write_(line + "\n");
    }
}

void Progress::clear_line() {
    if (line_open_) write_("\r\033[K");
    line_open_ = false;
}

}  // namespace morphodesic::pipeline
