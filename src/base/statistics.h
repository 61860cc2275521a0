#pragma once
// Statistics of measurements.

#include <cstddef>
#include <vector>

namespace binosplat {

/// Returns a quantile: the smallest value that at least the fraction `share` (0 to 1) of the values does not
/// exceed. A share of 0.5 gives the median, and 0.99 gives p99. The values must not be empty.
double quantile(std::vector<double> values, double share);

/// Returns the arithmetic mean. The values must not be empty.
double mean(const std::vector<double>& values);

/// Returns Student's t: the mean of n normal samples lies within t * (standard deviation / sqrt(n)) of the
/// true mean, except in a share `outside` of all cases. The deviation has `freedom` (1 or more) degrees of
/// freedom.
double student_t(double outside, int freedom);

/// Rounds a positive number up to 1, 2 or 5 times a power of ten, for scales and grids.
double round_up(double number);

/// Returns `count` indices spread evenly over 0 to `all` - 1, both ends included, or all if there are fewer.
std::vector<std::size_t> spread_evenly(std::size_t all, std::size_t count);

}  // namespace binosplat
