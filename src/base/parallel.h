#pragma once
// Loops on all cores.

#include <concepts>
#include <cstddef>
#include <functional>
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
