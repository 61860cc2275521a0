// Levels of detail, an inset and meshes, used by another program.

#include <binosplat/stream.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/output_file.h"
#include "base/thread_spans.h"
#include "formats/models/model_writers.h"
#include "library/renderer_fixture.h"
#include "stream/stream.h"
#include "support/errors.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat {
namespace {

struct Levels : Library {
  static void SetUpTestSuite() {
    folder = std::make_unique<test::TempFolder>();
    const std::string model = (*folder / "model.ply").string();
    OutputFile file(model);
    write_ply(file, test::random_model(3, 2000, 0));
    file.commit();
    ASSERT_EQ(
        test::run_program({"levels", model, "-o", levels().string(), "--chunk", "64", "--levels", "3"}).code,
        0);
  }
  static void TearDownTestSuite() { folder.reset(); }
  static std::filesystem::path levels() { return *folder / "levels"; }

  inline static std::unique_ptr<test::TempFolder> folder;
};

class LevelsWithPrecision : public Levels, public testing::WithParamInterface<Precision> {};

TEST_P(LevelsWithPrecision, StreamDuringFrames) {
  SplatStream stream(levels(), {.quality = 45.0});
  const Placement there = stream.placement({0.0, 1.6, 0.0});
  EXPECT_ERROR(stream.begin_frame(views(), there, over_black, 2.5), "Renderer");
  Renderer renderer(caller.get_proc_address(), stream, GetParam());
  const std::size_t at_first = stream.count();
  renderer.draw(views(), there, over_black);  // before the first begin_frame(), which may add levels
  const std::vector<float> coarse = read(0);
  for (int n = 0; n < 2000 && (n < 2 || !stream.settled()); ++n) {
    stream.begin_frame(views(), there, over_black, 2.5);
    renderer.draw(views(), there, over_black);
  }
  ASSERT_TRUE(stream.settled());
  EXPECT_GT(stream.count(), at_first);
  EXPECT_NE(read(0), coarse);
  // The picture equals that of the whole model, except for the requested loss.
  const SplatModel finest_level(levels(), {.lod = 0});
  const Bounds seen = stream.bounds(), true_ones = finest_level.bounds();
  EXPECT_LT(glm::distance(seen.low, true_ones.low), 0.1f * glm::distance(true_ones.low, true_ones.high));
  Renderer whole(caller.get_proc_address(), finest_level);
  const std::vector<float> drawn = read(0);
  whole.draw(views(), there, over_black);
  const std::vector<float> finest = read(0);
  double squared = 0.0, from_coarse = 0.0;
  for (std::size_t k = 0; k < finest.size(); ++k) {
    squared += std::pow(drawn[k] - finest[k], 2.0);
    from_coarse += std::pow(coarse[k] - finest[k], 2.0);
  }
  EXPECT_GT(10.0 * std::log10(static_cast<double>(finest.size()) / squared), 43.0);
  EXPECT_LT(squared, from_coarse);
}

INSTANTIATE_TEST_SUITE_P(Precision, LevelsWithPrecision, testing::Values(Precision::full, Precision::half));

TEST_F(Levels, CompileNothingAfterPrepare) {
  // Returns the programs that are compiled until the levels settle, by frames or by the stream.
  const auto new_programs = [&](bool is_prepared, const Settings& settings, Precision precision) {
    SplatStream stream(std::make_shared<Stream>(levels(), StreamSettings{.detail = {.db = 45.0}}));
    Renderer renderer(caller.get_proc_address(), stream, precision);
    if (is_prepared) renderer.prepare(views(), placement, settings);
    keep_spans();
    for (int n = 0; n < 2000 && (n < 2 || !stream.settled()); ++n) {
      stream.begin_frame(views(), placement, settings, 2.5);
      renderer.draw(views(), placement, settings);
    }
    EXPECT_TRUE(stream.settled());
    std::vector<std::string> names;
    for (const ThreadSpan& span : take_thread_spans())
      if (span.name.starts_with("compile ") || span.name.starts_with("load ")) names.push_back(span.name);
    return names;
  };
  EXPECT_TRUE(std::ranges::any_of(new_programs(false, over_black, Precision::full), [](const auto& name) {
    return name.ends_with("chunk_visibility.comp");
  })) << "there is nothing to prepare";
  const std::vector<std::string> none;
  EXPECT_EQ(new_programs(true, over_black, Precision::full), none);
  EXPECT_EQ(new_programs(true, {.quality = 40.0f}, Precision::half), none);
}

TEST_F(Levels, HaveOneRenderer) {
  std::optional<SplatStream> stream(std::in_place, levels());
  std::optional<Renderer> renderer(std::in_place, caller.get_proc_address(), *stream);
  EXPECT_ERROR(Renderer(caller.get_proc_address(), *stream), "one renderer");
  renderer->submit(views(), placement, over_black);
  EXPECT_ERROR(stream->begin_frame(views(), placement, over_black, 2.5), "finish()");
  renderer->finish();
  renderer.reset();
  EXPECT_ERROR(stream->begin_frame(views(), placement, over_black, 2.5), "Renderer");
  renderer.emplace(caller.get_proc_address(), *stream);
  stream->begin_frame(views(), placement, over_black, 2.5);
  stream.reset();  // the renderer continues with the levels that were read
  EXPECT_GT(renderer->draw(views(), placement, over_black).pairs, 0u);
}

TEST_F(Levels, RejectInvalidUse) {
  EXPECT_ERROR(SplatStream("/no/such/city"), "/no/such/city", "No such file");
  EXPECT_ERROR(SplatStream(levels(), {.quality = 300.0}), "quality 300", "dB");
  SplatStream stream(levels());
  Renderer renderer(caller.get_proc_address(), stream);
  EXPECT_ERROR(stream.begin_frame(views(), placement, {}, NAN), "ms");
  std::vector<View> bad = views();
  bad[1].eye.position.x = NAN;
  EXPECT_ERROR(stream.begin_frame(bad, placement, {}, 2.5), "views[1]");
  const SplatStream taken(std::move(stream));
  // NOLINTBEGIN(bugprone-use-after-move)
  EXPECT_ERROR(stream.begin_frame(views(), placement, {}, 2.5), "moved from");
  EXPECT_ERROR(Renderer(caller.get_proc_address(), stream), "moved from");
  EXPECT_ERROR(stream.count(), "moved from");
  EXPECT_ERROR(stream.placement(), "moved from");
  // NOLINTEND(bugprone-use-after-move)
}

TEST_F(Levels, WorkWithInsetAndMeshes) {
  SplatStream stream(levels());
  Renderer renderer(caller.get_proc_address(), stream);
  const Settings foveated{.foveation = Foveation{.inset_degrees = 15.0, .gaze = {{5.0, 0.0}}}};
  const std::vector<float> white(4 * static_cast<std::size_t>(size.x * size.y), 1.0f);
  std::vector<View> pair = views();
  const auto draw = [&](float z) {
    for (View& view : pair) {
      caller.TextureSubImage2D(view.target.texture, 0, 0, 0, size.x, size.y, GL_RGBA, GL_FLOAT, white.data());
      view.mesh_depth = {.texture = caller.texture(GL_R32F, size.x, size.y), .coding = DepthCoding::axis};
      const std::vector<float> wall(static_cast<std::size_t>(size.x * size.y), z);
      caller.TextureSubImage2D(view.mesh_depth->texture, 0, 0, 0, size.x, size.y, GL_RED, GL_FLOAT,
                               wall.data());
    }
    stream.begin_frame(pair, placement, foveated, 2.5);
    renderer.draw(pair, placement, foveated);
    return read(0);
  };
  EXPECT_EQ(draw(0.15f), white) << "behind a wall";
  EXPECT_NE(draw(0.0f), white) << "without one";
}

TEST_F(Library, OnlyInsetIsExact) {
  Renderer renderer(caller.get_proc_address(), in_memory(test::random_model(3, 400, 2)));
  renderer.draw(views(), placement, over_black);
  const std::vector<float> whole = read(0);
  Settings foveated = over_black;
  foveated.foveation = Foveation{.inset_degrees = 20.0, .context_scale = 0.4};
  for (const bool in_place : {true, false}) {
    std::vector<View> pair = views();
    for (View& view : pair) view.target.in_place = in_place;
    const Report report = renderer.draw(pair, placement, foveated);
    EXPECT_EQ(report.in_place, in_place);
    const std::vector<float> drawn = read(0);
    // The eye's axis in px: by tangents, 49 of 86 degrees from the left and 48 of 93 from below.
    constexpr int axis_x = 43, axis_y = 33;
    int inside = 0, outside = 0;
    for (int p = 0; p < size.x * size.y; ++p) {
      const bool near = std::abs(p % size.x - axis_x) < 4 && std::abs(p / size.x - axis_y) < 4;
      (near ? inside : outside) += std::memcmp(&drawn[4 * static_cast<std::size_t>(p)],
                                               &whole[4 * static_cast<std::size_t>(p)], 16) != 0
                                       ? 1
                                       : 0;
    }
    EXPECT_EQ(inside, 0);
    EXPECT_GT(outside, 500);
  }
  std::vector<View> with_depths = views();
  for (View& view : with_depths)
    view.depth = {.texture = caller.texture(GL_DEPTH_COMPONENT24, size.x, size.y)};
  EXPECT_ERROR(renderer.draw(with_depths, placement, foveated), "depth targets");
  foveated.foveation->inset_degrees = 500.0;
  EXPECT_ERROR(renderer.draw(views(), placement, foveated), "inset 500");
}

}  // namespace
}  // namespace binosplat
