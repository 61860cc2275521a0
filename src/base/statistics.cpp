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

// Bisects the share of Student's distribution beyond +-t (Abramowitz and Stegun, 26.7.3 and 26.7.4).
double student_t(double outside, int freedom) {
  const auto beyond = [&](double t) {
    const double angle = std::atan(t / std::sqrt(static_cast<double>(freedom))), c = std::cos(angle);
    const bool is_odd = freedom % 2 == 1;
    double term = is_odd ? c : 1.0, sum = 0.0;
    for (int k = is_odd ? 1 : 0; k < freedom - 1; k += 2) {
      sum += term;
      term *= c * c * (k + 1.0) / (k + 2.0);
    }
    const double within =
        is_odd ? (angle + std::sin(angle) * sum) * 2.0 / std::acos(-1.0) : std::sin(angle) * sum;
    return 1.0 - within;
  };
  double low = 0.0, high = 1.0;
  while (beyond(high) > outside && high < 1e9) high *= 2.0;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (beyond(middle) > outside ? low : high) = middle;
  }
  return high;
}

double round_up(double number) {
  const double ten = std::pow(10.0, std::floor(std::log10(number)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (number <= step * ten) return step * ten;
  }
  return 10.0 * ten;
}

std::vector<std::size_t> spread_evenly(std::size_t all, std::size_t count) {
  std::vector<std::size_t> chosen;
  count = std::min(all, count);
  for (std::size_t i = 0; i < count; ++i)
    chosen.push_back(count == 1 ? 0 : (i * (all - 1) + (count - 1) / 2) / (count - 1));
  return chosen;
}

}  // namespace binosplat
