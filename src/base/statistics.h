#pragma once
// Statistics of measurements.

#include <vector>

namespace binosplat {

/// The smallest value that at least `share` (0 to 1) of the values do not exceed: 0.5 the median, 0.99 p99.
/// The values must not be empty.
double quantile(std::vector<double> values, double share);

/// The arithmetic mean. For frames of differing work it gives their average cost. The values must not be
/// empty.
double mean(const std::vector<double>& values);

/// Student's t, two-sided, for means of n normal samples. They lie within t * (standard deviation / sqrt(n))
/// of the true mean, except for a share `outside` of all cases. `freedom` (at least 1) is that of the
/// standard deviation.
double student_t(double outside, int freedom);

/// The standard deviation of a population, estimated from a sample of two or more.
double deviation(const std::vector<double>& values);

/// The least of 1, 2 and 5 times a power of ten that is not below a positive number, for scales and grids.
double round_up(double number);

}  // namespace binosplat
