#include "primitives/radix_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "primitives/arguments.h"
#include "shared/limits.h"
#include "support/gl.h"

namespace binosplat::primitives {
namespace {

using Keys = std::vector<std::uint32_t>;

// Values are 0, 1, 2, ...: where equal keys keep their order, values of equal keys ascend.
// `room` for more than SORT_FEW makes large blocks of any number of keys.
std::pair<Keys, Keys> sort_on_gpu(const Keys& keys, std::uint32_t bits, std::int64_t room = 0) {
  gl::Context& context = test::gl_context();
  const auto count = static_cast<std::uint32_t>(keys.size());
  PairBuffers pairs(context, "pairs");
  pairs.reserve(std::max<std::int64_t>(count, room));
  gl::Buffer arguments(context, "arguments");
  arguments.upload(std::vector{
      make_sort_arguments(count, RadixSort::digit_bits(bits), context.limits().groups, pairs.block())});
  Keys values(count);
  std::iota(values.begin(), values.end(), 0u);
  pairs.keys().upload(keys);
  pairs.values().upload(values);
  RadixSort sort(context);
  sort.reserve(pairs, bits);
  gl::Dispatcher dispatcher(context);
  sort.run(dispatcher, arguments, pairs, bits);
  return {pairs.keys().read<std::uint32_t>(count), pairs.values().read<std::uint32_t>(count)};
}

std::pair<Keys, Keys> sort_on_cpu(const Keys& keys, std::uint32_t bits) {
  const std::uint32_t mask = bits >= 32 ? ~0u : (1u << bits) - 1;
  Keys values(keys.size());
  std::iota(values.begin(), values.end(), 0u);
  std::stable_sort(values.begin(), values.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return (keys[a] & mask) < (keys[b] & mask); });
  Keys sorted;
  for (const std::uint32_t v : values) sorted.push_back(keys[v]);
  return {sorted, values};
}

Keys random_keys(std::size_t count, std::uint32_t mask) {
  std::mt19937 engine(11);
  Keys keys(count);
  for (std::uint32_t& key : keys) key = engine() & mask;
  return keys;
}

TEST(RadixSort, EqualsAStableSortAtEverySizeThatMatters) {
  struct Case {
    int block;
    int room;
    std::uint32_t bits;
  };
  for (const auto& [block, room, bits] :
       {Case{SORT_BLOCK_FEW, 0, 32}, {SORT_BLOCK, SORT_FEW + 1, 32}, {SORT_BLOCK, SORT_FEW + 1, 27}}) {
    for (const int size : {0, 1, 2, 255, 257, block - 1, block, block + 1, 5 * block + 33, 200000}) {
      const Keys keys = random_keys(static_cast<std::size_t>(size), ~0u);
      EXPECT_EQ(sort_on_gpu(keys, bits, room), sort_on_cpu(keys, bits)) << size << ", blocks of " << block;
    }
  }
}

TEST(RadixSort, KeepsTheOrderOfEqualKeys) {
  const Keys keys = random_keys(50000, 0x1Fu);
  const auto sorted = sort_on_gpu(keys, 8);
  const auto expected = sort_on_cpu(keys, 8);
  EXPECT_EQ(sorted, expected);
  auto unstable = expected;  // two equal keys the other way round are told apart
  std::swap(unstable.second[0], unstable.second[1]);
  EXPECT_NE(sorted, unstable);
  const Keys all_equal(20000, 7u);
  EXPECT_EQ(sort_on_gpu(all_equal, 32), sort_on_cpu(all_equal, 32));
}

TEST(RadixSort, TakesWholeDigitsOfTheBitsAsked) {
  const Keys keys = random_keys(30000, 0x1FFFFu);
  for (const std::uint32_t bits : {1u, 8u, 9u, 16u, 17u}) {
    const std::uint32_t digit = RadixSort::digit_bits(bits);
    EXPECT_EQ(sort_on_gpu(keys, bits), sort_on_cpu(keys, (bits + digit - 1) / digit * digit)) << bits;
  }
  EXPECT_EQ(sort_on_gpu(keys, 0), sort_on_cpu(keys, 0));
}

TEST(RadixSort, TakesWiderDigitsWhereThatSavesAPass) {
  const auto passes = [](std::uint32_t bits) {
    const std::uint32_t digit = RadixSort::digit_bits(bits);
    return (bits + digit - 1) / digit;
  };
  EXPECT_EQ(RadixSort::digit_bits(16), 8u);
  EXPECT_EQ(RadixSort::digit_bits(17), 9u);
  EXPECT_EQ(passes(17), 2u);
  EXPECT_EQ(passes(18), 2u);
  EXPECT_EQ(passes(27), 3u);
  EXPECT_EQ(passes(32), 4u);
  const Keys keys = random_keys(70001, ~0u);
  EXPECT_EQ(sort_on_gpu(keys, 27), sort_on_cpu(keys, 27));
}

// Where there are no subgroups, which llvmpipe lacks, this says nothing new.
TEST(RadixSort, IsTheSameWithoutSubgroups) {
  gl::Context& context = test::gl_context();
  const Keys keys = random_keys(200003, ~0u);
  for (const std::uint32_t bits : {17u, 32u}) {
    for (const int room : {0, SORT_FEW + 1}) {
      const auto with = sort_on_gpu(keys, bits, room);
      context.use_subgroups(false);
      EXPECT_EQ(sort_on_gpu(keys, bits, room), with);
      context.use_subgroups(true);
    }
  }
}

// What one sort leaves behind is ready for the next, of other digits and as many blocks, more or none.
TEST(RadixSort, SortsAgainAndAgain) {
  gl::Context& context = test::gl_context();
  RadixSort sort(context);
  gl::Dispatcher dispatcher(context);
  PairBuffers pairs(context, "pairs");
  gl::Buffer arguments(context, "arguments");
  for (const auto& [count, bits] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{
           {90000, 27}, {300, 15}, {0, 27}, {70000, 16}, {0, 8}, {250000, 32}, {250000, 9}, {1500, 27}}) {
    const Keys keys = random_keys(count, ~0u);
    Keys values(count);
    std::iota(values.begin(), values.end(), 0u);
    pairs.reserve(count);
    sort.reserve(pairs, bits);
    arguments.upload(std::vector{
        make_sort_arguments(count, RadixSort::digit_bits(bits), context.limits().groups, pairs.block())});
    if (count > 0) {
      pairs.keys().upload_part(std::span<const std::uint32_t>(keys), 0);
      pairs.values().upload_part(std::span<const std::uint32_t>(values), 0);
    }
    sort.run(dispatcher, arguments, pairs, bits);
    const std::uint32_t digit = RadixSort::digit_bits(bits);
    const auto expected = sort_on_cpu(keys, std::min(32u, (bits + digit - 1) / digit * digit));
    EXPECT_EQ(pairs.keys().read<std::uint32_t>(count), expected.first) << count << " by " << bits;
    EXPECT_EQ(pairs.values().read<std::uint32_t>(count), expected.second) << count << " by " << bits;
  }
}

TEST(RadixSort, WorksWhenADriverAllowsFewGroups) {
  gl::Context& context = test::gl_context();
  const std::uint32_t before = context.limits().groups;
  context.limit_groups(2);
  const Keys keys = random_keys(10 * SORT_BLOCK + 3, ~0u);
  EXPECT_EQ(sort_on_gpu(keys, 32), sort_on_cpu(keys, 32));
  context.limit_groups(before);
}

}  // namespace
}  // namespace binosplat::primitives
