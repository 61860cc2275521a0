#include "formats/models/codebook.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "support/models.h"

namespace binosplat {
namespace {

using test::Uniform;

/// Returns many values near 0 and a few large ones, as trained coefficients are.
std::vector<float> trained(std::size_t count) {
  Uniform uniform(5);
  std::vector<float> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(
        static_cast<float>(0.1 * std::pow(uniform(-1, 1), 3) + (i % 1000 == 0 ? uniform(-4, 4) : 0.0)));
  return values;
}

double squared_error(const std::vector<float>& values, const std::array<float, 256>& entries) {
  double sum = 0.0;
  for (const float v : values) {
    double least = 1e9;
    for (const float e : entries) least = std::min(least, std::pow(static_cast<double>(v) - e, 2));
    sum += least;
  }
  return sum;
}

TEST(Codebook, KeepsFewValues) {
  for (const std::size_t count : {1u, 2u, 200u, 256u}) {
    std::vector<float> values = trained(count);
    const Codebook book(values);
    for (const float v : values) EXPECT_EQ(book.entries()[book.nearest(v)], v);
  }
}

TEST(Codebook, ApproximatesManyValues) {
  const std::vector<float> values = trained(20000);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const Codebook book(values);
  std::array<float, 256> even;
  for (std::size_t k = 0; k < 256; ++k) even[k] = *low + (*high - *low) * static_cast<float>(k) / 255.0f;
  double error = 0.0;
  for (const float v : values) {
    const float entry = book.entries()[book.nearest(v)];
    EXPECT_LE(std::abs(v - entry), (*high - *low) / 126 + 1e-6);
    error += std::pow(static_cast<double>(v) - entry, 2);
  }
  EXPECT_NEAR(error, squared_error(values, book.entries()), 1e-12 * error) << "not the nearest entry";
  EXPECT_LT(10.0 * error, squared_error(values, even)) << "even steps are nearly as good";
  double faulty = 0.0;  // injected fault: the entry next to the nearest one
  for (const float v : values)
    faulty += std::pow(static_cast<double>(v) - book.entries()[std::min(book.nearest(v) + 1, 255)], 2);
  EXPECT_GT(faulty, 1.5 * error);
}

// A float cannot hold the sum of a million numbers exactly enough to compute their mean.
TEST(Codebook, KeepsPrecisionForMillions) {
  Uniform uniform(7);
  std::vector<float> values;
  for (int i = 0; i < 1 << 20; ++i) values.push_back(static_cast<float>(uniform(-8, -4)));
  const Codebook book(values);
  double error = 0.0;
  for (const float v : values)
    error += std::pow(static_cast<double>(v) - book.entries()[book.nearest(v)], 2) / (1 << 20);
  const double even = std::pow(4.0 / 256, 2) / 12;  // mean squared error of 256 equal steps, the optimum here
  EXPECT_LT(error, 1.4 * even);
  EXPECT_GT(error, 0.99 * even);
}

TEST(Codebook, HugeValuesStayFinite) {
  std::vector<float> values;
  for (int i = 0; i < 1000; ++i) values.push_back(static_cast<float>(i % 2 == 0 ? 3e38 : -3e38 + i * 1e34));
  const Codebook book(values);
  for (const float e : book.entries()) EXPECT_TRUE(std::isfinite(e));
}

struct Rows {
  std::vector<float> numbers;
  std::size_t size;

  const float* operator()(std::size_t i) const { return &numbers[i * size]; }
  std::size_t count() const { return numbers.size() / size; }
  double error(const Palette& palette) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      sum += std::pow(
          static_cast<double>(numbers[i]) - palette.entries[palette.labels[i / size] * size + i % size], 2);
    return sum;
  }
};

/// Returns rows scattered around 40 centres.
Rows clusters(std::size_t count, std::size_t size) {
  Uniform uniform(6);
  Rows rows{{}, size};
  std::vector<double> centres;
  for (std::size_t k = 0; k < 40 * size; ++k) centres.push_back(uniform(-1, 1));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t d = 0; d < size; ++d)
      rows.numbers.push_back(static_cast<float>(centres[i * 7 % 40 * size + d] + uniform(-0.01, 0.01)));
  }
  return rows;
}

TEST(Palette, KeepsFewRows) {
  const Rows rows = clusters(500, 9);
  const Palette palette = make_palette(rows.count(), rows.size, 500, rows);
  EXPECT_EQ(palette.count, 500u);
  EXPECT_EQ(rows.error(palette), 0.0);
  Rows same = rows;  // each row three times
  for (int n = 0; n < 2; ++n)
    same.numbers.insert(same.numbers.end(), rows.numbers.begin(), rows.numbers.end());
  const Palette once = make_palette(same.count(), same.size, 1500, same);
  EXPECT_LE(once.count, 600u);
  EXPECT_LT(same.error(once), 1e-9);
}

TEST(Palette, FindsClusters) {
  const Rows rows = clusters(4000, 24);
  const Palette palette = make_palette(rows.count(), rows.size, 60, rows);
  EXPECT_EQ(palette.count, 60u);
  EXPECT_EQ(std::set<std::uint32_t>(palette.labels.begin(), palette.labels.end()).size(), 60u);
  const double all = static_cast<double>(rows.numbers.size());
  EXPECT_LT(std::sqrt(rows.error(palette) / all), 0.02) << "the spread within a cluster is 0.006";
  Palette faulty = palette;
  std::rotate(faulty.labels.begin(), faulty.labels.begin() + 1, faulty.labels.end());
  EXPECT_GT(std::sqrt(rows.error(faulty) / all), 0.3);
  EXPECT_EQ(make_palette(rows.count(), rows.size, 60, rows).entries, palette.entries);
}

}  // namespace
}  // namespace binosplat
