#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

namespace morphodesic::pipeline {

/// Tells the user how far a run is: on a terminal one line that is rewritten, in a log a plain line now and then.
/// May be called from several threads.
class Progress {
public:
    enum class Style { silent, lines, terminal };
    using Write = std::function<void(const std::string& text)>;
    using Clock = std::function<double()>;  ///< seconds that only grow

    /// What fits the standard error stream of this process.
    [[nodiscard]] static Style style_of_stderr(bool quiet);

    explicit Progress(Style style);
    /// For tests: any sink and any clock.
    Progress(Style style, Write write, Clock clock);

    /// A line of its own, e.g. a warning; also shown between the lines of a running count unless silent.
    void message(const std::string& text);

    /// Before the first pair: how many there are, how many are in the store already, how many are pilots.
    void begin_pairs(long total, long stored, long missing, long pilots);
    /// After each pair.
    void pair_done(bool has_distance);
    void end_pairs();

    [[nodiscard]] double seconds_since_begin() const;

private:
    void show_count();
    void clear_line();

    Style style_;
    Write write_;
    Clock clock_;
    mutable std::mutex mutex_;
    long missing_ = 0, done_ = 0, failed_ = 0, pilots_ = 0;
    double begin_ = 0.0, shown_ = 0.0;
    bool line_open_ = false;
};

/// 4200 -> "1 h 10 min", 75 -> "1 min 15 s", 2.34 -> "2.3 s".
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace morphodesic::pipeline
