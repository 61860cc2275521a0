#pragma once
// Parallel loops on all cores.

#include <concepts>
#include <cstddef>
#include <functional>
#include <memory>

namespace binosplat {

/// Covers [0, count) by parallel calls of body(begin, end) of about `chunk` indices. Rethrows exceptions.
void parallel_chunks(std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Calls body(i) for each i of [0, count) in parallel. `chunk` calls should be worth a thread's overhead.
template <std::integral Count, typename Body>
void parallel_for(Count count, const Body& body, std::size_t chunk = 1) {
  parallel_chunks(static_cast<std::size_t>(count), chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(static_cast<Count>(i));
  });
}

enum class HandOver { in_order, as_done };

/// A pipeline: calls begins(k), work(k) and hand_over(k) for k = 0, 1, 2... until begins(k) is false, with at
/// most `ahead` indices in it. Only calls of work() run in parallel with each other. Rethrows exceptions.
void parallel_stages(std::size_t ahead, const std::function<bool(std::size_t k)>& begins,
                     const std::function<void(std::size_t k)>& work,
                     const std::function<void(std::size_t k)>& hand_over, HandOver how);

/// Runs body() in the background: its loops use at most this share of the cores, but at least one core. All
/// participating threads, including the calling thread, keep a low priority afterwards.
void on_some_cores(double share, const std::function<void()>& body);

/// While the returned object exists, every loop runs only on its calling thread.
[[nodiscard]] std::shared_ptr<void> without_helpers();

int core_count();

}  // namespace binosplat
