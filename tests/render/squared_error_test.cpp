// Compares pictures on the GPU.
#include "render/squared_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/frame.h"
#include "scene/camera.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::render {
namespace {

TEST(SquaredError, OnGpuEqualsReadBack) {
  const std::vector<shared::View> views(2, make_view(look_at({0, 0, -4}, {0, 0, 0}, {0, -1, 0}, 60, 80, 48)));
  const Model model = test::random_model(1, 300, 1), other = test::random_model(2, 300, 1);
  Frame frame(test::gl_context(), model), other_frame(test::gl_context(), other);
  frame.draw(views);
  SquaredError read(test::gl_context(), frame.read_pictures());
  SquaredError kept(test::gl_context()), half(test::gl_context());
  for (const shared::View& view : views) {
    frame.draw({&view, 1});
    kept.add(frame.colours(), 80 * 48);
    half.add(frame.colours(), 80 * 24);
  }
  other_frame.draw(views);
  EXPECT_GT(read.mean(other_frame.colours()), 1e-4);
  EXPECT_EQ(kept.mean(other_frame.colours()), read.mean(other_frame.colours()));
  EXPECT_NE(half.mean(other_frame.colours()), read.mean(other_frame.colours())) << "injected: half of each";
}

// There are more pixels than invocations, so each invocation sums several.
TEST(SquaredError, AveragesLargePictures) {
  Picture wanted(1100, 1000);
  std::vector<glm::vec4> colours(wanted.colour.size(), glm::vec4(0.5f));
  double sum = 0.0;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    wanted.colour[i] = glm::vec4(0.5f + 0.25f * static_cast<float>(i % 7) / 7.0f);
    sum += 3.0 * std::pow(static_cast<double>(wanted.colour[i].x) - 0.5, 2);
  }
  colours.back() = glm::vec4(5.0f);  // clamped
  sum += 3.0 * (std::pow(1.0 - static_cast<double>(wanted.colour.back().x), 2) -
                std::pow(static_cast<double>(wanted.colour.back().x) - 0.5, 2));
  gl::Buffer drawn(test::gl_context(), "drawn");
  drawn.upload(colours);
  const double mean = sum / (3.0 * static_cast<double>(colours.size()));
  EXPECT_NEAR(SquaredError(test::gl_context(), std::vector{wanted}).mean(drawn), mean, 1e-6 * mean);
}

TEST(SquaredError, AppliesExposure) {
  glm::mat4x3 exposure(1.0f), transposed(1.0f);
  exposure[0] = {0.9f, 0.2f, 0.0f};
  exposure[3] = {0.02f, 0.0f, -0.05f};
  transposed[0][0] = 0.9f;
  transposed[1][0] = 0.2f;
  transposed[3] = exposure[3];
  Image drawn(20, 30, 3);
  Picture wanted(20, 30);
  std::vector<glm::vec4> colours;
  for (std::size_t i = 0; i < wanted.colour.size(); ++i) {
    colours.emplace_back(0.01f * static_cast<float>(i % 90), 0.5f, 0.02f * static_cast<float>(i % 40), 0.0f);
    for (std::size_t c = 0; c < 3; ++c) drawn.data[3 * i + c] = colours.back()[static_cast<int>(c)];
  }
  const Image photo = exposed(drawn, exposure);
  for (std::size_t i = 0; i < wanted.colour.size(); ++i)
    wanted.colour[i] = {photo.data[3 * i], photo.data[3 * i + 1], photo.data[3 * i + 2], 0.0f};
  gl::Buffer buffer(test::gl_context(), "drawn");
  buffer.upload(colours);
  const auto mean = [&](const glm::mat4x3& by) {
    return SquaredError(test::gl_context(), std::span(&wanted, 1), 255, by).mean(buffer);
  };
  EXPECT_LT(mean(exposure), 1e-6);
  EXPECT_GT(mean(transposed), 1e-4) << "injected: a column in the place of the row";
  EXPECT_GT(mean(glm::mat4x3(1.0f)), 1e-4);
}

}  // namespace
}  // namespace binosplat::render
