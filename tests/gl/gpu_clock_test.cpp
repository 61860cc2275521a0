#include "gl/gpu_clock.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <numeric>
#include <thread>

#include "support/gl.h"

namespace binosplat::gl {
namespace {

GpuClock::Uuid counting() {
  GpuClock::Uuid uuid{};
  std::iota(uuid.begin(), uuid.end(), std::uint8_t{0});
  return uuid;
}

// The fake library is missing if the test program was copied to another machine (tests/bench/bundle).
bool has_library() { return std::filesystem::exists(BINOSPLAT_FAKE_NVML); }

TEST(GpuClock, UpdatesClockOfDrawingGpu) {
  if (!has_library()) GTEST_SKIP() << "no " BINOSPLAT_FAKE_NVML;
  const GpuClock clock(BINOSPLAT_FAKE_NVML, counting());
  EXPECT_EQ(clock.problem(), "");
  ASSERT_TRUE(clock.mhz());
  const auto start = std::chrono::steady_clock::now();
  while (*clock.mhz() > 1900.0 && std::chrono::steady_clock::now() - start < std::chrono::seconds(20))
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  EXPECT_LE(*clock.mhz(), 1900.0) << "it is told once only";
}

TEST(GpuClock, ExplainsMissingClock) {
  if (!has_library()) GTEST_SKIP() << "no " BINOSPLAT_FAKE_NVML;
  const GpuClock none("libno-such-library.so.1", counting());
  EXPECT_FALSE(none.mhz());
  EXPECT_EQ(none.problem(), "libno-such-library.so.1 cannot be loaded");
  GpuClock::Uuid other = counting();
  other[3] = 99;
  const GpuClock of_another(BINOSPLAT_FAKE_NVML, other);
  EXPECT_FALSE(of_another.mhz());
  EXPECT_NE(of_another.problem().find("does not list the GPU of this OpenGL context"), std::string::npos);
  const GpuClock of_two(BINOSPLAT_FAKE_NVML, std::nullopt);
  EXPECT_FALSE(of_two.mhz()) << "one of two, nobody knows which";
  if (test::gl_context().software()) {
    EXPECT_EQ(GpuClock(test::gl_context()).problem(), "the CPU draws, so there is no GPU clock");
  }
}

}  // namespace
}  // namespace binosplat::gl
