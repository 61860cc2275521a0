#include "gl/context.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "base/error.h"
#include "gl/dispatch.h"
#include "support/errors.h"

namespace binosplat::gl {
namespace {

TEST(Context, OpensWithoutDisplay) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const auto context = Context::open();
  EXPECT_FALSE(context->renderer().empty());
  EXPECT_GE(context->limits().groups, 65535u);
  EXPECT_GE(context->limits().invocations, 1024u);
  EXPECT_GE(context->limits().storage_block_bytes, std::int64_t{128} << 20);
}

TEST(Context, ContextsKeepOwnPrograms) {
  const auto first = Context::open();
  Buffer a(*first, "a");
  a.upload(std::vector<std::uint32_t>{1, 2, 3});
  {
    const auto second = Context::open();
    EXPECT_NO_THROW(second->program("recolour.comp"));
  }
  // open() made the second context current. A program of the first makes the first current again.
  const auto third = Context::open();
  EXPECT_NO_THROW(third->program("recolour.comp"));
}

TEST(Context, ReportsMissingDevice) {
  EXPECT_ERROR(Context::open(Backend::device, 99), "device 99: EGL offers");
}

TEST(Context, ErrorListsTriedBackends) {
  // With llvmpipe only, there is no GPU for this backend to open. On a GPU server it works.
  try {
    const auto context = Context::open(Backend::device);
    EXPECT_FALSE(context->software());
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::no_gl);
    EXPECT_NE(std::string(error.what()).find("Tried:"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("apt install"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace binosplat::gl
