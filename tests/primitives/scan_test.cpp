#include "primitives/scan.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <vector>

#include "primitives/arguments.h"
#include "shared/limits.h"
#include "support/gl.h"

namespace binosplat::primitives {
namespace {

struct Scanned {
  std::vector<std::uint32_t> values;
  std::uint32_t total;
};

Scanned scan_on_gpu(const std::vector<std::uint32_t>& values) {
  gl::Context& context = test::gl_context();
  gl::Buffer arguments(context, "arguments");
  gl::Buffer buffer(context, "values");
  const auto count = static_cast<std::uint32_t>(values.size());
  arguments.upload(std::vector{make_arguments(count, context.limits().groups)});
  buffer.upload(values);
  Scan scan(context);
  scan.reserve(count);
  gl::Dispatcher dispatcher(context);
  scan.run(dispatcher, arguments, 0, buffer);
  return {buffer.read<std::uint32_t>(count), scan.total().read<std::uint32_t>(1).front()};
}

std::vector<std::uint32_t> random_values(std::size_t count, std::uint32_t below) {
  std::mt19937 engine(7);
  std::vector<std::uint32_t> values(count);
  for (std::uint32_t& v : values) v = engine() % below;
  return values;
}

TEST(Scan, EqualsTheStandardLibrarysAtEverySizeThatMatters) {
  const std::size_t block = SCAN_BLOCK;
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{255}, std::size_t{256}, std::size_t{257}, block - 1,
        block, block + 1, 3 * block + 17, block * THREADS + 5}) {
    const std::vector<std::uint32_t> values = random_values(size, 100);
    std::vector<std::uint32_t> expected(size);
    std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0u);
    const Scanned scanned = scan_on_gpu(values);
    EXPECT_EQ(scanned.values, expected) << size;
    EXPECT_EQ(scanned.total, std::accumulate(values.begin(), values.end(), 0u)) << size;
    if (size > 1) {  // an inclusive scan is told apart
      std::vector<std::uint32_t> inclusive(size);
      std::inclusive_scan(values.begin(), values.end(), inclusive.begin());
      EXPECT_NE(scanned.values, inclusive) << size;
    }
  }
}

TEST(Scan, StopsAtTheLargestNumberInsteadOfWrapping) {
  std::vector<std::uint32_t> values(5000, 1u << 20);  // 5.2e9 in all
  const Scanned scanned = scan_on_gpu(values);
  EXPECT_EQ(scanned.values[4095], 4095u << 20);
  EXPECT_EQ(scanned.values[4096], COUNT_MAX);
  EXPECT_EQ(scanned.values[4999], COUNT_MAX);
  EXPECT_EQ(scanned.total, COUNT_MAX);
}

TEST(Scan, WorksWhenADriverAllowsFewGroups) {
  gl::Context& context = test::gl_context();
  const std::uint32_t before = context.limits().groups;
  context.limit_groups(3);
  const std::vector<std::uint32_t> values = random_values(20 * SCAN_BLOCK + 3, 10);
  std::vector<std::uint32_t> expected(values.size());
  std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0u);
  EXPECT_EQ(scan_on_gpu(values).values, expected);
  context.limit_groups(before);
}

}  // namespace
}  // namespace binosplat::primitives
