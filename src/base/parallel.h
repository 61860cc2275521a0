#pragma once
// Parallel loops on all cores.

#include <concepts>
#include <cstddef>
#include <functional>
#include <memory>

namespace binosplat {

/// Calls body(begin, end) for chunks of about `chunk` that cover [0, count), on several threads. Rethrows
/// exceptions of body.
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

/// A pipeline: calls work(k) for k = 0, 1, 2... while begins(k) is true, up to `ahead` at once, and
/// hand_over(k) after each. Calls of begins are serial, and so are those of hand_over. Rethrows their
/// exceptions.
void parallel_stages(std::size_t ahead, const std::function<bool(std::size_t k)>& begins,
                     const std::function<void(std::size_t k)>& work,
                     const std::function<void(std::size_t k)>& hand_over, HandOver how);

/// Runs body() in the background: its loops use at most this share of the cores, and at least one. All
/// participating threads, including this one, keep a low priority afterwards.
void on_some_cores(double share, const std::function<void()>& body);

/// While the returned object exists, every loop runs only on its calling thread.
[[nodiscard]] std::shared_ptr<void> without_helpers();

/// Number of cores for loops.
int core_count();

}  // namespace binosplat
