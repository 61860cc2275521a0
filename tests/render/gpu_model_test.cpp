// One model on the GPU that several frames draw.

#include "render/support.h"
#include "scene/reduce.h"

namespace binosplat {
namespace {

using render::Frame;
using render::GpuModel;

const render::FrameSettings half_precision{.precision = PRECISION_HALF};

struct SharedModel : testing::Test {
  Model model = test::random_model(93, 20000, 2);
  const std::vector<shared::View> views = {make_view(test::front_camera(60, 50, 60))};
};

TEST_F(SharedModel, FramesDrawItLikeOwn) {
  const auto gpu_model = std::make_shared<GpuModel>(test::gl_context(), model);
  Frame one(gpu_model), other(gpu_model);
  for (int n = 0; n < 2; ++n) {
    one.draw(views, half_precision);
    other.draw(views);
  }
  const Picture in_half = one.read_pictures()[0], in_full = other.read_pictures()[0];
  EXPECT_TRUE(test::same_bits(in_half, test::draw(model, views, half_precision)[0]));
  EXPECT_TRUE(test::same_bits(in_full, test::draw(model, views)[0]));
  EXPECT_FALSE(test::same_bits(in_half, in_full)) << "injected: one frame's precision for the other's";
}

TEST_F(SharedModel, IsUploadedOncePerPrecision) {
  const std::int64_t before = test::gl_context().allocated_bytes();
  const auto needs = [&](int precision) {
    return render::memory_needs(render::make_plan(views, {.precision = precision}, model)).model;
  };
  const auto gpu_model = std::make_shared<GpuModel>(test::gl_context(), model);
  const auto held = [&] { return test::gl_context().allocated_bytes() - before; };
  EXPECT_EQ(held(), needs(PRECISION_FULL));
  auto full = gpu_model->buffers_in(PRECISION_FULL);
  EXPECT_EQ(held(), needs(PRECISION_FULL));
  const auto in_half = gpu_model->buffers_in(PRECISION_HALF);
  EXPECT_EQ(held(), needs(PRECISION_FULL) + needs(PRECISION_HALF));
  full.reset();
  EXPECT_EQ(held(), needs(PRECISION_HALF));
}

TEST_F(SharedModel, ReloadKeepsMemory) {
  const auto gpu_model = std::make_shared<GpuModel>(test::gl_context(), model, PRECISION_HALF);
  Frame frame(gpu_model);
  frame.draw(views, half_precision);
  const std::int64_t in_half = test::gl_context().allocated_bytes();
  gpu_model->buffers_in(PRECISION_FULL);  // as for a frame that was destroyed
  EXPECT_GT(test::gl_context().allocated_bytes(), in_half);
  model = test::random_model(94, 20000, 2);
  for (int n = 0; n < 2; ++n) {
    gpu_model->reload();
    EXPECT_EQ(test::gl_context().allocated_bytes(), in_half) << n;
  }
  frame.draw(views, half_precision);
  EXPECT_TRUE(test::same_bits(frame.read_pictures()[0], test::draw(model, views, half_precision)[0]));
}

TEST(ChunkedModel, ReloadsChangedParts) {
  const std::vector<shared::View> views = {make_view(test::front_camera(60, 50, 60))};
  // Pages end within blocks and chunks.
  struct Kind {
    std::uint32_t page;
    int precision, degree;
  };
  for (const auto& [page, precision, degree] :
       {Kind{0, PRECISION_FULL, 0}, Kind{0, PRECISION_HALF, 2}, Kind{1000, PRECISION_FULL, 2},
        Kind{1000, PRECISION_HALF, 0}}) {
    const render::FrameSettings settings{.precision = precision};
    Model model;
    model.degree = degree;
    ModelChunks parts(6);
    auto replace = [&, seed = 95u, degree = degree](std::size_t part, int count) mutable {
      parts.replace(model, part, test::random_model(seed++, count, degree));
    };
    for (std::size_t p = 0; p < 6; ++p) replace(p, 500);
    parts.take_changes();
    const auto gpu_model = std::make_shared<GpuModel>(test::gl_context(), model, precision, page);
    Frame frame(gpu_model);
    const auto draw = [&] {
      frame.draw(views, settings);
      return frame.read_pictures()[0];
    };
    draw();
    test::Uniform random(9);
    for (int n = 0; n < 8; ++n) {
      const auto part = static_cast<std::size_t>(random(0.0, 6.0));
      replace(part, static_cast<int>(random(0.0, 900.0)));
      const Picture expected = test::draw(model, views, settings)[0];
      if (n == 0) {
        EXPECT_FALSE(test::same_bits(draw(), expected)) << "injected: told nothing";
      }
      gpu_model->reload(parts.take_changes());
      ASSERT_TRUE(test::same_bits(draw(), expected)) << page << " " << precision << " " << degree << " " << n;
    }
  }
}

// Levels are added to a model while frames draw its earlier state on the GPU.
TEST_F(SharedModel, UploadedStateIsDrawn) {
  const auto gpu_model = std::make_shared<GpuModel>(test::gl_context(), model);
  Frame frame(gpu_model);
  const std::uint32_t visible = frame.draw(views).visible;
  const Picture before = frame.read_pictures()[0];
  const Model more = test::random_model(95, 5000, 2);
  model.capacity = 40'000;
  append(model, more, 0, more.count());
  EXPECT_EQ(frame.draw(views).visible, visible);
  EXPECT_TRUE(test::same_bits(frame.read_pictures()[0], before));
  EXPECT_EQ(frame.plan().gaussian_count, 20'000u);
  gpu_model->reload();
  EXPECT_GT(frame.draw(views).visible, visible) << "injected: nothing more";
  EXPECT_EQ(frame.plan().gaussian_count, 25'000u);
}

// The model grows by a few blocks, within its reserved room and beyond it, with frames in between.
TEST(ChunkedModel, GrowsBetweenFrames) {
  const std::vector<shared::View> views = {make_view(test::front_camera(60, 50, 60))};
  Model model;
  model.capacity = 60000;
  ModelChunks parts(8);
  parts.replace(model, 0, test::random_model(120, 3000, 0));
  parts.take_changes();
  const auto gpu_model = std::make_shared<GpuModel>(test::gl_context(), model);
  Frame frame(gpu_model);
  frame.draw(views);
  const auto room = [&] { return gpu_model->buffers_in(PRECISION_FULL)->pages[0].gaussians->bytes(); };
  const std::int64_t at_first = room();
  for (std::size_t p = 1; p < parts.size(); ++p) {
    parts.replace(model, p, test::random_model(120 + static_cast<std::uint32_t>(p), 10'000, 0));
    gpu_model->reload(parts.take_changes());
    frame.draw(views);
    ASSERT_TRUE(test::same_bits(frame.read_pictures()[0], test::draw(model, views)[0])) << p;
    EXPECT_EQ(room() == at_first, model.count() <= 60000) << p;
  }
  EXPECT_GT(model.count(), 70000u);
}

}  // namespace
}  // namespace binosplat
