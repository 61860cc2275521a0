#pragma once
// What a set of timings says.

#include <vector>

namespace binosplat {

/// The smallest value that at least `share` (0 to 1) of the values do not exceed: 0.5 the median, 0.99 p99.
/// The values must not be empty.
double quantile(std::vector<double> values, double share);

/// The arithmetic mean: of frames some of which do more than others, what they cost. The values must not be
/// empty.
double mean(const std::vector<double>& values);

/// Of numbers that scatter by chance around one value, of which `freedom` + 1 told how far, the mean of n
/// lies within so many times (their standard deviation / sqrt(n)) of it, but for a share `outside` of all
/// cases: Student's t, both sides. `freedom` is at least 1.
double student_t(double outside, int freedom);

/// The standard deviation that a sample of two or more tells of what it is from.
double deviation(const std::vector<double>& values);

/// The least of 1, 2 and 5 times a power of ten that is no less than a number above 0: for scales and grids.
double round_up(double number);

}  // namespace binosplat
