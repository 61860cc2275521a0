#pragma once
// Reads the GPU's clock rate, on which frame times depend, by NVIDIA's management library if it is installed.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "gl/context.h"

namespace binosplat::gl {

/// Reads the clock rate repeatedly in a thread, because a reading may take longer than a frame.
class GpuClock {
 public:
  using Uuid = std::array<std::uint8_t, 16>;

  explicit GpuClock(const Context& context);
  /// Without a UUID, reads the only GPU that the library reports. `library`: file name of NVIDIA's library.
  GpuClock(const char* library, const std::optional<Uuid>& uuid);
  ~GpuClock();
  GpuClock(const GpuClock&) = delete;
  GpuClock& operator=(const GpuClock&) = delete;

  /// The clock rate in MHz, read some milliseconds ago; none if unavailable.
  std::optional<double> mhz() const;
  /// Why the clock is unavailable; empty if it is available.
  const std::string& problem() const { return problem_; }

 private:
  struct Library;
  void open(const char* library, const std::optional<Uuid>& uuid);

  std::unique_ptr<Library> library_;
  std::string problem_;
  std::atomic<unsigned> mhz_ = 0;
  std::jthread thread_;  // declared last, so that it ends before the other members are destroyed
};

}  // namespace binosplat::gl
