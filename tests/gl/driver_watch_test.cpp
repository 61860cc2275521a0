#include "gl/driver_watch.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <thread>

namespace binosplat::gl {
namespace {

using std::chrono::milliseconds;

/// Makes no context.
void hang() {
  const std::jthread watch = watch_driver(milliseconds(50));
  std::this_thread::sleep_for(std::chrono::hours(1));
}

TEST(DriverWatch, EndsHungDriver) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const testing::ExitedWithCode no_gl(3);
  for (const char* name : {"GALLIUM_DRIVER", "VK_DRIVER_FILES"}) unsetenv(name);
  setenv("EGL_PLATFORM", "wayland", 1);
  EXPECT_EXIT(hang(), no_gl, "^binosplat: the driver has made .* in 0.05 s: unset EGL_PLATFORM=wayland\n$");
  setenv("GALLIUM_DRIVER", "zink", 1);
  EXPECT_EXIT(hang(), no_gl, "unset GALLIUM_DRIVER=zink, EGL_PLATFORM=wayland\n$");
  for (const char* name : {"GALLIUM_DRIVER", "EGL_PLATFORM"}) unsetenv(name);
  EXPECT_EXIT(hang(), no_gl, "0.05 s: try another `backend`\n$");
}

TEST(DriverWatch, StopsAfterContextCreation) {
  for (int k = 0; k < 100; ++k) const std::jthread watch = watch_driver(milliseconds(20));
  std::this_thread::sleep_for(milliseconds(50));
}

}  // namespace
}  // namespace binosplat::gl
