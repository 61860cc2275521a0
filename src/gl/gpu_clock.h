#pragma once
// How fast the GPU's clock runs, which frame times go by: NVIDIA's management library tells it, where it is
// installed. It is opened when the program runs.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "gl/context.h"

namespace binosplat::gl {

/// Asks for the clock again and again in a thread of its own, since an answer may take longer than a frame.
class GpuClock {
 public:
  using Uuid = std::array<std::uint8_t, 16>;

  /// Of the GPU that the context draws with.
  explicit GpuClock(const Context& context);
  /// Of the GPU that a library of this name knows by its UUID; without a UUID, of its only one.
  GpuClock(const char* library, const std::optional<Uuid>& uuid);
  ~GpuClock();
  GpuClock(const GpuClock&) = delete;
  GpuClock& operator=(const GpuClock&) = delete;

  /// MHz, some milliseconds ago; none where nothing tells.
  std::optional<double> mhz() const;
  /// Why nothing tells; empty where something does.
  const std::string& problem() const { return problem_; }

 private:
  struct Library;
  void open(const char* library, const std::optional<Uuid>& uuid);

  std::unique_ptr<Library> library_;
  std::string problem_;
  std::atomic<unsigned> mhz_ = 0;
  std::jthread thread_;  // last: it ends first
};

}  // namespace binosplat::gl
