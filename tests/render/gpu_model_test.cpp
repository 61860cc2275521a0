// A model on the GPU that several frames draw.

#include "render/support.h"

namespace binosplat {
namespace {

using render::Frame;
using render::GpuModel;

const render::FrameSettings half{.precision = PRECISION_HALF};

struct SharedModel : testing::Test {
  Model model = test::random_model(93, 20000, 2);
  const std::vector<shared::View> views = {make_view(test::front_camera(60, 50, 60))};
};

TEST_F(SharedModel, FramesDrawItAsTheyDrawTheirOwn) {
  const auto gpu_model = std::make_shared<GpuModel>(test::gl_context(), model);
  Frame one(gpu_model), other(gpu_model);
  for (int n = 0; n < 2; ++n) {
    one.draw(views, half);
    other.draw(views);
  }
  const Picture in_half = one.read_pictures()[0], in_full = other.read_pictures()[0];
  EXPECT_TRUE(test::same_bits(in_half, test::draw(model, views, half)[0]));
  EXPECT_TRUE(test::same_bits(in_full, test::draw(model, views)[0]));
  EXPECT_FALSE(test::same_bits(in_half, in_full)) << "planted: one frame's precision for the other's";
}

TEST_F(SharedModel, IsOnTheGpuOnceInEachPrecisionThatAFrameHolds) {
  const std::int64_t before = test::gl_context().allocated_bytes();
  const auto needs = [&](int precision) {
    return render::memory_needs(render::make_shape(views, {.precision = precision}, model)).model;
  };
  const auto gpu_model = std::make_shared<GpuModel>(test::gl_context(), model);
  const auto held = [&] { return test::gl_context().allocated_bytes() - before; };
  EXPECT_EQ(held(), needs(PRECISION_FULL));
  auto full = gpu_model->in(PRECISION_FULL);
  EXPECT_EQ(held(), needs(PRECISION_FULL));
  const auto in_half = gpu_model->in(PRECISION_HALF);
  EXPECT_EQ(held(), needs(PRECISION_FULL) + needs(PRECISION_HALF));
  full.reset();
  EXPECT_EQ(held(), needs(PRECISION_HALF));
}

TEST_F(SharedModel, ReloadsWhatFramesHoldHoweverOften) {
  const auto gpu_model = std::make_shared<GpuModel>(test::gl_context(), model, PRECISION_HALF);
  Frame frame(gpu_model);
  frame.draw(views, half);
  const std::int64_t in_half = test::gl_context().allocated_bytes();
  gpu_model->in(PRECISION_FULL);  // for a frame that is gone
  EXPECT_GT(test::gl_context().allocated_bytes(), in_half);
  model = test::random_model(94, 20000, 2);
  for (int n = 0; n < 2; ++n) {
    gpu_model->reload();
    EXPECT_EQ(test::gl_context().allocated_bytes(), in_half) << n;
  }
  frame.draw(views, half);
  EXPECT_TRUE(test::same_bits(frame.read_pictures()[0], test::draw(model, views, half)[0]));
}

}  // namespace
}  // namespace binosplat
