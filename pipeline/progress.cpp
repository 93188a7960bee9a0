#include "pipeline/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "pipeline/standard_streams.h"

namespace morphodesic::pipeline {
namespace {

constexpr double terminal_interval = 0.2, log_interval = 30.0, least_predicted = 2.0;  // seconds

void write_to_stderr(const std::string& text) {
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
}

}  // namespace

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void TimeEstimate::begin(double now, long missing, int at_once) {
    *this = TimeEstimate();
    missing_ = missing;
    at_once_ = std::max(at_once, 1);
    marks_.push_back({now, 0.0});
}

void TimeEstimate::pair_done(double now, double seconds) {
    ++done_;
    sum_ += seconds;
    squares_ += seconds * seconds;
    constexpr double first_mark = 16;
    const auto done = static_cast<double>(done_);
    if (done >= std::max(first_mark, 2 * marks_.back().done)) marks_.push_back({now, done});
}

double TimeEstimate::seconds_left(double now) const {
    if (done_ == 0) return std::numeric_limits<double>::quiet_NaN();
    const auto left = static_cast<double>(missing_ - done_);
    if (left <= 0) return 0.0;
    const auto done = static_cast<double>(done_);
    // Besides the one that begins now; these are under way.
    const double in_flight = std::min(static_cast<double>(at_once_), left) - 1;
    std::size_t from = 0;
    while (from + 1 < marks_.size() && marks_[from + 1].done <= done / 2) ++from;
    const double since = done - marks_[from].done + (from == 0 ? in_flight / 4 : 0.0);
    const double per_pair = (now - marks_[from].time) / since;
    // The last pairs leave cores idle: one of them is longer than the mean, the more so the more they differ.
    const double mean = sum_ / done;
    const double longer = mean > 0 ? squares_ / done / (mean * mean) : 1.0;
    const double tail = per_pair * in_flight * 0.5 * longer;
    return per_pair * (left - in_flight / 2) + tail;
}

bool TimeEstimate::trustworthy() const {
    constexpr long least = 12, per_core = 4;
    constexpr double largest_error = 0.1, warm = 3.0;  // seconds: the first pairs also load libraries and shapes
    if (done_ < std::max<long>(least, per_core * at_once_) || sum_ < warm * at_once_) return false;
    const auto done = static_cast<double>(done_);
    const double mean = sum_ / done, variance = std::max(0.0, squares_ / done - mean * mean);
    return std::sqrt(variance / done) <= largest_error * mean;
}

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
    write_(printable(text) + "\n");
}

void Progress::begin_pairs(long total, long stored, long missing, int at_once) {
    const std::scoped_lock lock(mutex_);
    missing_ = missing;
    done_ = failed_ = 0;
    predicted_ = false;
    begin_ = shown_ = clock_();
    estimate_.begin(begin_, missing, at_once);
    if (style_ == Style::silent) return;
    clear_line();
    write_(std::to_string(total) + " pairs, " + std::to_string(stored) + " of them in the store, " +
           std::to_string(missing) + " to compute\n");
}

void Progress::pair_done(bool has_distance, double seconds) {
    const std::scoped_lock lock(mutex_);
    ++done_;
    if (!has_distance) ++failed_;
    if (style_ == Style::silent) return;
    const double now = clock_();
    estimate_.pair_done(now, seconds);
    if (!predicted_ && done_ < missing_ && estimate_.trustworthy()) {
        predicted_ = true;
        const double predicted = estimate_.seconds_left(now);
        if (predicted >= least_predicted) {
            clear_line();
            write_("about " + duration_text(predicted) + " to go, judged by the first " + std::to_string(done_) +
                   " pairs\n");
            shown_ = now;
        }
    }
    const double interval = style_ == Style::terminal ? terminal_interval : log_interval;
    if (now - shown_ < interval) return;
    shown_ = now;
    show_count(now);
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

void Progress::show_count(double now) {
    const double rate = static_cast<double>(done_) / std::max(now - begin_, 1e-9);
    char text[160];
    // What was said once is not taken back: few pairs more or less do not make the estimate much worse.
    const bool known = predicted_ || done_ >= missing_ / 4;
    const std::string left = known ? duration_text(estimate_.seconds_left(now)) + " left" : "too early to say how long";
    const int size =
        std::snprintf(text, sizeof text, "%ld of %ld pairs (%.0f %%), %.3g a second, %s", done_, missing_,
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
