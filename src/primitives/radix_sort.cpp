#include "primitives/radix_sort.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "shared/limits.h"
#include "shared/types.h"

namespace binosplat::primitives {

PairBuffers::PairBuffers(gl::Context& context, const std::string& label)
    : keys_(context, label + ": keys"),
      keys_other_(context, label + ": keys, other copy"),
      values_(context, label + ": values"),
      values_other_(context, label + ": values, other copy") {}

void PairBuffers::reserve(std::int64_t count) {
  for (gl::Buffer* buffer : {&keys_, &keys_other_, &values_, &values_other_}) buffer->reserve(count * 4);
}

std::uint32_t PairBuffers::block() const { return RadixSort::block(capacity()); }

void RadixSort::reserve(const PairBuffers& pairs, std::uint32_t bits) {
  const std::int64_t counters = counters_of(pairs.capacity(), bits);
  histogram_.reserve(counters * 4);
  scan_.reserve(counters);
  if (digits_.bytes() == 0)
    digits_.upload(std::vector<std::uint32_t>(SORT_PASSES_MAX + (2 * SORT_PASSES_MAX << SORT_BITS_MAX)));
}

std::uint32_t RadixSort::block(std::int64_t capacity) {
  return capacity <= SORT_FEW ? SORT_BLOCK_FEW : SORT_BLOCK;
}

std::int64_t RadixSort::counters_of(std::int64_t capacity, std::uint32_t bits) {
  return (capacity / block(capacity) + 1) << digit_bits(bits);
}

std::uint32_t RadixSort::digit_bits(std::uint32_t bits) { return bits <= 8 * passes(bits) ? 8 : 9; }

std::uint32_t RadixSort::passes(std::uint32_t bits) { return (bits + SORT_BITS_MAX - 1) / SORT_BITS_MAX; }

void RadixSort::run(gl::Dispatcher& dispatcher, const gl::Buffer& arguments, PairBuffers& pairs,
                    std::uint32_t bits) {
  gl::Context& context = dispatcher.context();
  if (context.limits().subgroups_of_32) return run_looking_back(dispatcher, arguments, pairs, bits);
  const std::array variant = {pairs.block_number(), gl::Number{"DIGIT_BITS", digit_bits(bits), 16}};
  const gl::Program& count = context.program("primitives/sort_count.comp", variant);
  const gl::Program& scatter = context.program("primitives/sort_scatter.comp", variant);
  const auto blocks = gl::DispatchSize::indirect(arguments, offsetof(shared::DispatchArguments, sort_x));
  for (std::uint32_t shift = 0; shift < bits; shift += digit_bits(bits)) {
    dispatcher.run(count, blocks,
                   {{"Arguments", arguments}, {"Keys", pairs.keys()}, {"Histogram", histogram_}},
                   {{"shift", shift}});
    scan_.run(dispatcher, arguments, 1, histogram_);
    dispatcher.run(scatter, blocks,
                   {{"Arguments", arguments},
                    {"Keys", pairs.keys()},
                    {"Values", pairs.values()},
                    {"Histogram", histogram_},
                    {"KeysOut", pairs.keys_out()},
                    {"ValuesOut", pairs.values_out()}},
                   {{"shift", shift}});
    pairs.flip();
  }
}

void RadixSort::run_looking_back(gl::Dispatcher& dispatcher, const gl::Buffer& arguments, PairBuffers& pairs,
                                 std::uint32_t bits) {
  if (bits == 0) return;
  gl::Context& context = dispatcher.context();
  const std::array variant = {pairs.block_number(), gl::Number{"DIGIT_BITS", digit_bits(bits), 16},
                              gl::Number{"PASSES", passes(bits), SORT_PASSES_MAX + 1}};
  const gl::Program& scatter = context.program("primitives/sort_scatter_subgroups.comp", variant);
  const auto blocks = gl::DispatchSize::indirect(arguments, offsetof(shared::DispatchArguments, sort_x));
  dispatcher.run(
      context.program("primitives/sort_digits.comp", variant),
      gl::DispatchSize::of_groups(SORT_DIGITS_GROUPS),
      {{"Arguments", arguments}, {"Keys", pairs.keys()}, {"SortDigits", digits_}, {"Reached", histogram_}},
      {{"half_now", half_now_}});
  for (std::uint32_t pass = 0; pass < passes(bits); ++pass) {
    dispatcher.run(scatter, blocks,
                   {{"Arguments", arguments},
                    {"Keys", pairs.keys()},
                    {"Values", pairs.values()},
                    {"Reached", histogram_},
                    {"SortDigits", digits_},
                    {"KeysOut", pairs.keys_out()},
                    {"ValuesOut", pairs.values_out()}},
                   {{"pass", pass}, {"half_now", half_now_}});
    pairs.flip();
  }
  half_now_ = 1 - half_now_;
}

}  // namespace binosplat::primitives
