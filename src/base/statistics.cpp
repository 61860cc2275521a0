#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace binosplat {

double quantile(std::vector<double> values, double share) {
  const double rank = std::max(1.0, std::ceil(share * static_cast<double>(values.size())));
  const auto found = values.begin() + static_cast<std::ptrdiff_t>(rank) - 1;
  std::nth_element(values.begin(), found, values.end());
  return *found;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double round_up(double number) {
  const double ten = std::pow(10.0, std::floor(std::log10(number)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (number <= step * ten) return step * ten;
  }
  return 10.0 * ten;
}

}  // namespace binosplat
