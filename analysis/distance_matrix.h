#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace morphodesic::analysis {

/// No trustworthy distance.
inline constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Largest distance that is accepted: squares, sums of squares and their products stay finite.
inline constexpr double largest_distance = 1e100;

/// Labelled symmetric matrix of distances with zero diagonal. Entries may be missing (NaN) and may carry an error bar.
/// Storage is condensed: pair (i < j) of n items lies at n i - i (i + 1) / 2 + j - i - 1, the order of SciPy's pdist.
/// Unit of distances and error bars: whatever the producer uses; nothing here depends on it.
class DistanceMatrix {
public:
    DistanceMatrix() = default;
    /// All distances missing. @throws std::invalid_argument if two labels are equal or one is empty
    explicit DistanceMatrix(std::vector<std::string> labels);
    /// @param condensed n (n - 1) / 2 distances in [0, largest_distance], or NaN
    DistanceMatrix(std::vector<std::string> labels, std::vector<double> condensed);

    [[nodiscard]] std::size_t size() const { return labels_.size(); }
    [[nodiscard]] std::size_t pair_count() const { return distances_.size(); }
    [[nodiscard]] const std::vector<std::string>& labels() const { return labels_; }

    /// d(i, j); 0 for i = j, NaN if missing.
    [[nodiscard]] double operator()(std::size_t i, std::size_t j) const {
        return i == j ? 0.0 : distances_[index(i, j)];
    }
    [[nodiscard]] bool known(std::size_t i, std::size_t j) const {
        const double d = (*this)(i, j);
        return d == d;
    }
    /// @throws std::invalid_argument if d is not in [0, largest_distance], or if i = j and d is not 0; NaN marks it as
    /// missing
    void set(std::size_t i, std::size_t j, double d);
    /// @param error half width of the error bar of d, >= 0; NaN: not known
    void set(std::size_t i, std::size_t j, double d, double error);

    /// Half width of the error bar of d(i, j), >= 0; 0 for i = j, NaN if not known.
    [[nodiscard]] double error(std::size_t i, std::size_t j) const {
        return i == j ? 0.0 : errors_.empty() ? missing : errors_[index(i, j)];
    }
    /// True if at least one pair has been given an error bar.
    [[nodiscard]] bool has_errors() const { return !errors_.empty(); }

    [[nodiscard]] std::span<const double> condensed() const { return distances_; }
    [[nodiscard]] std::span<const double> condensed_errors() const { return errors_; }  ///< empty if there are none
    [[nodiscard]] std::size_t missing_count() const;                                    ///< pairs without distance
    [[nodiscard]] std::vector<double> dense() const;                                    ///< row-major [n x n]
    /// Rows and columns of these items, in this order (no item twice).
    [[nodiscard]] DistanceMatrix subset(std::span<const std::size_t> items) const;

    [[nodiscard]] std::size_t index(std::size_t i, std::size_t j) const { return condensed_index(size(), i, j); }
    [[nodiscard]] static std::size_t condensed_index(std::size_t n, std::size_t i, std::size_t j) {
        return i < j ? n * i - i * (i + 1) / 2 + j - i - 1 : n * j - j * (j + 1) / 2 + i - j - 1;
    }

private:
    std::vector<std::string> labels_;
    std::vector<double> distances_;  // [n (n - 1) / 2]
    std::vector<double> errors_;     // the same, or empty
};

}  // namespace morphodesic::analysis
