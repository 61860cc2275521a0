// Frames that are submitted and finished separately, and pictures that are read while the next ones are
// drawn.

#include "render/read_back.h"

#include <thread>

#include "render/support.h"
#include "stereo/rig.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using render::ReadBack;

/// Returns the eyes of a head that walks past the model.
std::vector<stereo::EyePair> walk(int frames) {
  Camera head = test::front_camera(70, 45, 60);
  std::vector<stereo::EyePair> eyes;
  for (int k = 0; k < frames; ++k) {
    eyes.push_back(stereo::make_rig(head, {.ipd = 0.06}));
    head.position.x += 0.02;
  }
  return eyes;
}

TEST(ReadBack, EqualsImmediateRead) {
  const Model model = test::random_model(91, 3000, 1);
  for (const FrameSettings& settings :
       {FrameSettings{}, FrameSettings{{.quality = 38.0f}, TILES_ELLIPSE, PRECISION_FULL, false}}) {
    render::Frame one(test::gl_context(), model), other(test::gl_context(), model);
    ReadBack read_back(test::gl_context());
    const std::vector<stereo::EyePair> eyes = walk(3);
    std::vector<std::vector<Picture>> expected, taken(eyes.size());
    std::vector<std::jthread> threads;
    std::unique_ptr<ReadBack::Pictures> on_their_way;
    const auto hand_over = [&](std::size_t to) {
      on_their_way->wait();
      threads.emplace_back(
          [&taken, to, pictures = std::move(on_their_way)] { taken[to] = pictures->take(); });
    };
    for (std::size_t k = 0; k < eyes.size(); ++k) {
      other.draw(eyes[k].views, settings);
      expected.push_back(other.read_pictures());
      one.submit(eyes[k].views, settings);
      if (on_their_way) hand_over(k - 1);
      one.finish();
      on_their_way = read_back.start(one);
    }
    hand_over(eyes.size() - 1);
    threads.clear();
    for (std::size_t k = 0; k < eyes.size(); ++k)
      EXPECT_TRUE(same_bits(taken[k], expected[k])) << k << " with quality " << settings.quality.has_value();
    EXPECT_FALSE(same_bits(taken[1], expected[0]));
  }
}

TEST(ReadBack, SeveralReadsOverlap) {
  const Model model = test::random_model(92, 2000, 0);
  render::Frame frame(test::gl_context(), model);
  ReadBack read_back(test::gl_context());
  std::vector<std::vector<Picture>> expected;
  std::vector<std::unique_ptr<ReadBack::Pictures>> all;
  for (const stereo::EyePair& eyes : walk(4)) {
    frame.draw(eyes.views);
    all.push_back(read_back.start(frame));
    expected.push_back(frame.read_pictures());
  }
  for (std::size_t k = all.size(); k-- > 0;) {
    all[k]->wait();
    EXPECT_TRUE(same_bits(all[k]->take(), expected[k])) << k;
  }
}

TEST(Submit, CompletesAndGrowsBuffers) {
  const Model model = test::random_model(93, 3000, 0);
  const shared::View view = make_view(test::front_camera(96, 64, 90));
  const Picture expected = test::draw(model, view);
  render::Frame frame(test::gl_context(), model);
  frame.submit(std::vector{view}, {}, {.slots = 1, .pairs = 1});
  while (!frame.is_done()) std::this_thread::yield();
  const Report report = frame.finish();
  EXPECT_GT(report.redraws, 0);
  EXPECT_TRUE(test::same_bits(frame.read_pictures().front(), expected));
}

// Two frames of one model may be in flight at once.
TEST(Submit, OverlappingFramesAreIndependent) {
  const Model model = test::random_model(94, 3000, 1);
  const auto gpu_model = std::make_shared<render::GpuModel>(test::gl_context(), model);
  const shared::View near = make_view(test::front_camera(96, 64, 90)),
                     wide = make_view(test::front_camera(64, 48, 30));
  render::Frame one(gpu_model), other(gpu_model);
  one.submit(std::vector{near});
  other.submit(std::vector{wide}, test::squared(0.5f));
  one.finish();
  other.finish();
  EXPECT_TRUE(test::same_bits(one.read_pictures().front(), test::draw(model, near)));
  EXPECT_TRUE(test::same_bits(other.read_pictures().front(), test::draw(model, wide, test::squared(0.5f))));
}

}  // namespace
}  // namespace binosplat
