// A model whose levels follow the views. The leaves have 505 and 120, 247 and 65, 248 and 65 Gaussians.

#include "stream/stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "formats/models/model_file.h"
#include "measure/metrics.h"
#include "scene/camera.h"
#include "stream/picture_stream.h"
#include "stream/stream_levels.h"
#include "support/broken.h"
#include "support/details.h"
#include "support/fixtures.h"
#include "support/gl.h"
#include "support/level_errors.h"

namespace binosplat {
namespace {

using test::beside_first;
using test::beside_last;
using test::far_away;
using test::view_at;

/// Returns a view of all chunks of sog/st-lod, or of write_levels().
shared::View before_all(double distance = 20.0) {
  return make_view(look_at({0, -1, -distance}, {0, -1, 0}, {0, -1, 0}, 60, 64, 48));
}

/// A stream, and frames that follow it.
struct Frames {
  Stream stream;
  std::shared_ptr<render::GpuModel> gpu_model;
  int changes = 0;

  Frames(const std::filesystem::path& path, const StreamSettings& settings)
      : stream(path, settings), gpu_model(stream.gpu_model(test::gl_context(), PRECISION_FULL)) {}

  void step(const std::vector<shared::View>& views, std::optional<float> quality = {}) {
    changes += stream.begin_frame(views, {{.quality = quality}}, max_levels_ms) ? 1 : 0;
  }
  /// Draws until the levels settle. Returns the number of Gaussians.
  std::size_t rest(const std::vector<shared::View>& views, std::optional<float> quality = {}) {
    const auto start = std::chrono::steady_clock::now();
    do {
      step(views, quality);
      if (std::chrono::steady_clock::now() - start > std::chrono::seconds(60)) ADD_FAILURE() << "it hangs";
      std::this_thread::yield();
    } while (!stream.settled() && !testing::Test::HasFailure());
    return stream.gaussians();
  }
};

std::vector<Picture> pictures(const Model& model, const shared::View& view) {
  render::Frame frame(test::gl_context(), model);
  frame.draw({&view, 1}, {});
  return frame.read_pictures();
}

std::vector<Picture> pictures(const std::shared_ptr<render::GpuModel>& model, const shared::View& view) {
  render::Frame frame(model);
  frame.draw({&view, 1}, {});
  return frame.read_pictures();
}

TEST(Stream, LoadsLevelsForViews) {
  REQUIRE_FIXTURES(folder);
  Frames frames(folder / "sog/st-lod", {.detail = {30.0}});
  EXPECT_EQ(frames.stream.gaussians(), 250u);
  EXPECT_TRUE(frames.stream.settled());
  EXPECT_EQ(frames.rest({view_at(far_away)}), 250u);
  EXPECT_EQ(frames.changes, 0);
  EXPECT_EQ(frames.rest({view_at(beside_last)}), 120u + 65 + 248);
  EXPECT_GT(frames.changes, 0);
  EXPECT_EQ(frames.rest({view_at(beside_first)}), 505u + 65 + 65);
  EXPECT_FALSE(frames.stream.reported_db()) << "px tell no dB";
  // The GPU holds the same Gaussians as the model.
  const shared::View view = before_all();
  EXPECT_EQ(pictures(frames.gpu_model, view)[0].colour, pictures(frames.stream.model(), view)[0].colour);
  EXPECT_NE(pictures(load_model(folder / "sog/st-lod", {.lod = 1}), view)[0].colour,
            pictures(frames.gpu_model, view)[0].colour)
      << "injected: the coarsest";
}

// A moving head finally gets its levels, whatever arrived in between.
TEST(Stream, FollowsMovingHead) {
  const test::TempFolder folder;
  test::write_levels(folder, 3000);
  Frames frames(folder.path(), {.detail = {.db = 60.0}});
  const std::size_t coarsest = frames.stream.gaussians();
  EXPECT_FALSE(frames.stream.reported_db()) << "nobody looked";
  for (int n = 0; n < 60; ++n) {
    frames.step({before_all(20.0 - 0.1 * n)});
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_GT(frames.stream.gaussians(), coarsest) << "while it moves";
  const std::size_t followed = frames.rest({before_all(5.0)});
  EXPECT_GE(*frames.stream.reported_db(), 59.5);
  EXPECT_GE(followed, coarsest);
  EXPECT_EQ(pictures(frames.gpu_model, before_all(5.0))[0].colour,
            pictures(frames.stream.model(), before_all(5.0))[0].colour);
}

// The loss of levels was measured at the head's earlier position.
TEST(Stream, MovingHeadLowersReportedDb) {
  const test::TempFolder folder;
  test::write_levels(folder, 3000);
  Frames frames(folder.path(), {.detail = {.db = 20.0}});
  const shared::View view = before_all(40.0), near_it = before_all(40.001);
  frames.rest({view, view});
  const double at_rest = *frames.stream.reported_db();
  ASSERT_LT(at_rest, 60.0) << "levels lose something";
  frames.step({view, view});
  EXPECT_EQ(*frames.stream.reported_db(), at_rest);
  frames.step({near_it, near_it});  // a pass measures one view a frame: nothing is chosen yet
  EXPECT_NEAR(*frames.stream.reported_db(), at_rest - 10.0 * std::log10(1.3), 1e-6);
  frames.rest({near_it, near_it});
  EXPECT_NEAR(*frames.stream.reported_db(), at_rest, 1.0);
}

TEST(Stream, SharesQuality) {
  const test::TempFolder folder;
  test::write_levels(folder, 3000);
  Frames frames(folder.path(), {.shares_quality = true});
  const std::vector<shared::View> views = {before_all(40.0)};
  EXPECT_EQ(frames.rest(views), 3000u) << "nothing may be lost";
  EXPECT_FALSE(frames.stream.frame_quality({}));
  const std::size_t fewer = frames.rest(views, 20.0f);
  EXPECT_LT(fewer, 3000u);
  EXPECT_NEAR(psnr_of_both(*frames.stream.frame_quality(20.0f), levels_target_db(20.0)), 20.0, 1e-5);
  EXPECT_GE(*frames.stream.reported_db(), levels_target_db(20.0) - 0.5);
  EXPECT_GT(frames.rest(views, 60.0f), fewer) << "injected: as before";
}

// For few Gaussians, a visibility pass takes more time than levels save: all are drawn, if there is room.
TEST(Stream, DrawsSmallModelsCompletely) {
  const test::TempFolder folder;
  test::write_levels(folder, 3000);
  const auto reports = [&](StreamSettings settings, std::optional<float> quality) {
    Frames frames(folder.path(), settings);
    const std::size_t gaussians = frames.rest({before_all()}, quality);
    const bool by_db = frames.stream.reported_db().has_value();
    EXPECT_EQ(gaussians == 3000u, !by_db);
    EXPECT_EQ(frames.stream.frame_quality(quality) == quality, !by_db || !quality);
    return by_db;
  };
  EXPECT_FALSE(reports({.detail = {.db = 40.0}, .finest_up_to = 3000}, {}));
  EXPECT_FALSE(reports({.shares_quality = true, .finest_up_to = 3000}, 40.0f));
  EXPECT_TRUE(reports({.detail = {.db = 40.0}, .finest_up_to = 2999}, {})) << "injected: too many";
  EXPECT_TRUE(reports({.detail = {.max_gaussians = 2999, .db = 40.0}, .finest_up_to = 3000}, {}))
      << "no room";
}

// A larger window leaves less room.
TEST(Stream, KeepsMemoryBudgetOfViews) {
  const test::TempFolder folder;
  test::write_levels(folder, 3000);
  const std::size_t spare = LodFiles(folder.path()).extra_capacity();
  const auto max_in_memory = [&](std::span<const shared::View> views, int) {
    return spare + (views.empty() ? 3000u : 2000u);
  };
  for (const bool by_db : {false, true}) {
    StreamSettings settings{.max_in_memory = max_in_memory, .reserve = 10'000};
    if (by_db) settings.detail.db = 80.0;
    Frames frames(folder.path(), settings);
    EXPECT_EQ(frames.stream.model().capacity, 3000 + spare);
    const std::size_t gaussians = frames.rest({before_all()});
    EXPECT_LE(gaussians, 2000u) << "injected: as at first";
    EXPECT_GT(gaussians, 1000u);
  }
}

TEST(PictureStream, SettlesPicturesIndependently) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  test::add_level_errors(copy);
  const auto settled = [&](const std::vector<double>& distances, bool heads_turn) {
    PictureStream stream(copy.path(), {.detail = {.db = 30.0, .heads_turn = heads_turn}});
    const auto gpu_model = stream.gpu_model(test::gl_context(), PRECISION_FULL);
    for (const double distance : distances) {
      int told = 0;
      const bool changed = stream.settle(std::vector{before_all(distance)}, {}, [&] { ++told; });
      EXPECT_EQ(told, changed ? 1 : 0);
      EXPECT_FALSE(stream.settle(std::vector{before_all(distance)}, {})) << "it is there";
      EXPECT_TRUE(stream.reported_db());
    }
    return std::pair(stream.gaussians(), pictures(gpu_model, before_all(distances.back())));
  };
  const auto alone = settled({60.0}, false), after_another = settled({8.0, 60.0}, false);
  EXPECT_EQ(alone.first, after_another.first);
  EXPECT_EQ(alone.second[0].colour, after_another.second[0].colour);
  EXPECT_GT(settled({8.0}, false).first, alone.first);
  // Injected: levels for a turning head have at least as many Gaussians.
  EXPECT_GE(settled({8.0, 60.0}, true).first, alone.first);
}

// The errors in the file are calibrated by measurements.
TEST(Stream, CalibratesPictures) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  test::add_level_errors(copy);
  copy.edit("lod-meta.json", [](nlohmann::json& meta) {
    for (const char* leaf : {"/children/0", "/children/1/children/0", "/children/1/children/1"})
      for (auto& errors : meta["tree"][nlohmann::json::json_pointer(leaf)]["lods"]["1"]["errors"])
        errors[0] = 2e-6;  // far too small
  });
  const shared::View view = before_all();
  const auto finest = pictures(load_model(copy.path(), {.lod = 0}), view);
  const auto true_db = [&](const std::shared_ptr<render::GpuModel>& model) {
    return std::min(measure::psnr(pictures(model, view), finest, glm::vec3(0.0f)), 60.0);
  };
  PictureStream picture(copy.path(), {.detail = {.db = 40.0, .heads_turn = false}});
  const auto of_picture = picture.gpu_model(test::gl_context(), PRECISION_FULL);
  picture.settle(std::vector{view}, {});
  EXPECT_GT(picture.gaussians(), 250u);
  EXPECT_NEAR(std::min(*picture.reported_db(), 60.0), true_db(of_picture), 2.0);
  // Frames calibrate once nothing moves.
  Frames frames(copy.path(), {.detail = {.db = 40.0}});
  // Waits until the worker has chosen, before the next frame, which would calibrate.
  const auto has_chosen = [&] {
    for (int wait = 0; wait < 500 && !frames.stream.reported_db(); ++wait)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return frames.stream.reported_db().has_value();
  };
  do frames.step({view});
  while (!has_chosen());
  EXPECT_GT(*frames.stream.reported_db(), true_db(frames.gpu_model) + 20.0) << "injected: as the file says";
  EXPECT_GT(frames.rest({view}), 250u);
  EXPECT_NEAR(std::min(*frames.stream.reported_db(), 60.0), true_db(frames.gpu_model), 2.0);
}

TEST(Stream, DrawsLeavesWithoutLevels) {
  const test::TempFolder folder;
  test::write_levels(folder, 1000);
  const std::string file = folder / "lod-meta.json";
  nlohmann::json meta = nlohmann::json::parse(test::read_text(file));
  nlohmann::json* leaf = &meta["tree"];
  while (!leaf->contains("lods")) leaf = &(*leaf)["children"][0];
  const std::size_t without = (*leaf)["lods"]["0"]["count"];
  (*leaf)["lods"] = nlohmann::json::object();
  test::write_text(file, meta.dump());
  PictureStream stream(file, {.detail = {.db = 80.0}});
  const auto model = stream.gpu_model(test::gl_context(), PRECISION_FULL);
  for (int n = 0; n < 3; ++n) stream.settle(std::vector{before_all(3.0)}, {});
  EXPECT_EQ(stream.gaussians(), 1000 - without);
  Frames frames(file, {.detail = {.db = 80.0}, .reserve = 1000});
  EXPECT_EQ(frames.rest({before_all(3.0)}), 1000 - without);
}

TEST(Stream, ReportsErrors) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  EXPECT_ERROR(Stream(copy.path(), {.detail = {.db = 40.0}}), "lacks the errors of its levels");
  Frames frames(copy.path(), {.detail = {30.0}});
  std::filesystem::resize_file(copy.path() / "0_0/means_l.webp", 100);
  EXPECT_ERROR(frames.rest({view_at(beside_first)}), "0_0", "means_l.webp");
  EXPECT_EQ(frames.stream.gaussians(), 250u);
  EXPECT_ERROR(frames.step({view_at(far_away)}), "0_0", "means_l.webp") << "still";
}

TEST(Stream, UsesRemainingFrameTime) {
  EXPECT_NEAR(time_for_levels(11.1, 5.9), 4.0, 1e-9);
  EXPECT_EQ(time_for_levels(11.1, 1.0), max_levels_ms);
  EXPECT_EQ(time_for_levels(11.1, 20.0), 2.5) << "or a head would wait forever";
}

}  // namespace
}  // namespace binosplat
