#pragma once
// Loops on all cores.

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <functional>
#include <iterator>
#include <memory>

namespace binosplat {

/// Calls body(begin, end) for chunks of about `chunk` that make up [0, count), on any number of threads at
/// once. What body throws is thrown here.
void parallel_chunks(std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Calls body(i) for each i of [0, count) that way; each call is taken to be worth a thread's while unless
/// `chunk` says how many are.
template <std::integral Count, typename Body>
void parallel_for(Count count, const Body& body, std::size_t chunk = 1) {
  parallel_chunks(static_cast<std::size_t>(count), chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(static_cast<Count>(i));
  });
}

/// Sorts [begin, end), what lies on both sides of a middle value at once. Equal ones are in any order.
template <std::random_access_iterator Iterator, typename Less = std::less<>>
void parallel_sort(Iterator begin, Iterator end, const Less& less = {}) {
  constexpr std::ptrdiff_t worth_a_thread = 1 << 13;
  const std::ptrdiff_t count = end - begin;
  if (count <= worth_a_thread) return std::sort(begin, end, less);
  std::array<std::iter_value_t<Iterator>, 9> some;
  for (std::ptrdiff_t k = 0; k < 9; ++k) some[static_cast<std::size_t>(k)] = begin[(2 * k + 1) * count / 18];
  std::nth_element(some.begin(), some.begin() + 4, some.end(), less);
  const auto& middle = some[4];
  const Iterator left = std::partition(begin, end, [&](const auto& value) { return less(value, middle); });
  const Iterator right = std::partition(left, end, [&](const auto& value) { return !less(middle, value); });
  // Where the middle was badly chosen, no square of the time comes of it.
  if (std::max(left - begin, end - right) > count - count / 16) return std::sort(begin, end, less);
  parallel_for(2, [&](int side) {
    if (side == 0) return parallel_sort(begin, left, less);
    parallel_sort(right, end, less);
  });
}

enum class HandOver { in_order, as_done };

/// Calls work(k) for k = 0, 1, 2... for as long as begins(k) says yes, up to `ahead` of them at once, and
/// hand_over(k) for each whose work is done. Of calls of begins there is one at a time, and of hand_over too.
/// What they throw is thrown here.
void parallel_stages(std::size_t ahead, const std::function<bool(std::size_t k)>& begins,
                     const std::function<void(std::size_t k)>& work,
                     const std::function<void(std::size_t k)>& hand_over, HandOver how);

/// Calls body() in the background: its loops have a share of the cores at most, and one at least, and threads
/// that take part, this one too, give way to others from then on.
void on_some_cores(double share, const std::function<void()>& body);

/// All loops run on the threads that call them alone for as long as what is returned lives.
[[nodiscard]] std::shared_ptr<void> without_helpers();

/// Cores that loops may use.
int core_count();

}  // namespace binosplat
