#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace morphodesic::pipeline {

/// Seconds since some moment in the past, whatever is done to the clock of the machine.
[[nodiscard]] double steady_seconds();

/// How long the pairs of a run still take, judged by those that are done. Their order is as good as random, so that
/// these are a fair sample. A quarter of the pairs in flight counts as done (the quick ones are done first), and the
/// pace is that of the later half so far, so that a machine that gets busier or idler is followed. Not thread-safe.
class TimeEstimate {
public:
    void begin(double now, long missing, int at_once);
    /// @param seconds  what the pair took, > 0
    void pair_done(double now, double seconds);

    /// Seconds until the last pair is done; NaN before the first one.
    [[nodiscard]] double seconds_left(double now) const;
    /// Enough pairs are done for an estimate within 30 %: a dozen, four for every core, and as many as it takes for a
    /// standard error of the mean of 10 % (many, if pairs differ much).
    [[nodiscard]] bool trustworthy() const;

private:
    struct Mark {
        double time;
        double done;
    };
    long missing_ = 0, done_ = 0;
    int at_once_ = 1;
    double sum_ = 0.0, squares_ = 0.0;  ///< of the seconds of pairs
    std::vector<Mark> marks_;           ///< at the begin and whenever twice as many pairs were done
};

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

    /// Before the first pair: how many there are, how many are in the store already, how many are to be computed, how
    /// many of them at the same time.
    void begin_pairs(long total, long stored, long missing, int at_once);
    /// After each pair. @param seconds  what it took
    void pair_done(bool has_distance, double seconds);
    void end_pairs();

private:
    void show_count(double now);
    void clear_line();

    Style style_;
    Write write_;
    Clock clock_;
    mutable std::mutex mutex_;
    TimeEstimate estimate_;
    long missing_ = 0, done_ = 0, failed_ = 0;
    double begin_ = 0.0, shown_ = 0.0;
    bool predicted_ = false, line_open_ = false;
};

/// 4200 -> "1 h 10 min", 75 -> "1 min 15 s", 2.34 -> "2.3 s".
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace morphodesic::pipeline
