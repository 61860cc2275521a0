// Levels that are read by a thread of their own: leaves of 505 and 120, 247 and 65, 248 and 65 Gaussians.

#include "stream/level_stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <random>
#include <set>

#include "formats/content.h"
#include "formats/model_file.h"
#include "lab/streamed_sog_writer.h"
#include "support/broken.h"
#include "support/details.h"
#include "support/fixtures.h"
#include "support/level_errors.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using test::beside_first;
using test::beside_last;
using test::far_away;
using test::view_at;

DetailRequest coarse_to_30_px(const StreamedSog&, std::span<const shared::View>) { return {30.0}; }

LevelStream::Need for_db(double db) {
  return [db](const StreamedSog&, std::span<const shared::View>) { return DetailRequest{.db = db}; };
}

/// Takes what comes for a view, so many Gaussians at a time; how many there were after each that came.
std::vector<std::size_t> follow(LevelStream& stream, Model& model, const glm::dvec3& eye, std::size_t most) {
  stream.want(std::vector{view_at(eye)}, {});
  std::vector<std::size_t> counts;
  const auto start = std::chrono::steady_clock::now();
  while (!stream.settled()) {
    if (!stream.take(model, most).empty()) counts.push_back(stream.gaussians());
    if (std::chrono::steady_clock::now() - start > std::chrono::seconds(60)) ADD_FAILURE() << "it hangs";
    if (testing::Test::HasFailure()) break;
    std::this_thread::yield();
  }
  return counts;
}

/// Along x, of all Gaussians that are drawn, in order.
std::vector<float> positions(const Model& model) {
  std::vector<float> found;
  for (std::size_t i = 0; i < model.count(); ++i) {
    if (model.opacity[i] > 0.0f) found.push_back(model.position[i].x);
  }
  std::ranges::sort(found);
  return found;
}

/// Of all parts, in a picture of 100 x 100 px.
shared::View before_all() {
  shared::View view = view_at({0, 0, -30});
  view.row_x = {1, 0, 0, 0};
  view.row_y = {0, 1, 0, 0};
  view.row_z = {0, 0, 1, 0};
  view.lens = {100, 100, 50, 50};
  view.width = view.height = 100;
  return view;
}

/// Frames of a view that looks and takes, until that is so; false after a minute without.
bool frames_until(LevelStream& stream, Model& model, const shared::View& view, const LevelStream::Look& look,
                  const std::function<bool()>& is_so) {
  const auto start = std::chrono::steady_clock::now();
  do {
    stream.want(std::vector{view}, look);
    stream.take(model, 1);
    if (std::chrono::steady_clock::now() - start > std::chrono::seconds(60)) return false;
    std::this_thread::yield();
  } while (!is_so());
  return true;
}

TEST(LevelStream, BringsWhatViewsNeedAPartAtATime) {
  REQUIRE_FIXTURES(folder);
  LevelStream stream(folder / "sog/st-lod", coarse_to_30_px);
  Model model = stream.coarsest();
  EXPECT_EQ(stream.gaussians(), 250u);
  EXPECT_TRUE(stream.settled());
  EXPECT_TRUE(follow(stream, model, far_away, 1).empty());
  EXPECT_EQ(follow(stream, model, beside_last, 1), (std::vector<std::size_t>{120u + 65 + 248}));
  EXPECT_EQ(follow(stream, model, beside_first, 1), (std::vector<std::size_t>{250, 505 + 65 + 65}))
      << "what shrinks comes first";
  EXPECT_TRUE(follow(stream, model, beside_first, 1).empty());
  EXPECT_EQ(follow(stream, model, beside_last, 100'000).back(), 120u + 65 + 248);
  // Each part is what the file says.
  const Model fine = load_model(folder / "sog/st-lod", {.lod = 0});
  std::size_t same = 0;
  for (const std::size_t b : stream.parts().blocks(2)) {
    for (std::size_t i = b * ModelChunks::block; i < (b + 1) * ModelChunks::block; ++i)
      same += std::count(fine.position.begin() + 752, fine.position.end(), model.position[i]) == 1 &&
                      model.opacity[i] > 0.0f
                  ? 1
                  : 0;
  }
  EXPECT_EQ(same, 248u);
}

// However often it changes its mind, and whatever was taken by then.
TEST(LevelStream, EndsWithWhatWasWantedLast) {
  REQUIRE_FIXTURES(folder);
  const fs::path path = folder / "sog/st-lod";
  const std::vector<glm::dvec3> places = {far_away, beside_first, beside_last, {-8, 0, 4}, {0, 0, 12}};
  std::vector<std::vector<float>> alone;
  for (const glm::dvec3& place : places) {
    LevelStream stream(path, coarse_to_30_px);
    Model model = stream.coarsest();
    follow(stream, model, place, 1);
    alone.push_back(positions(model));
  }
  std::mt19937 random(5);
  LevelStream stream(path, coarse_to_30_px);
  Model model = stream.coarsest();
  std::set<std::vector<float>> met;
  for (int n = 0; n < 400; ++n) {
    const std::size_t place = random() % places.size();
    stream.want(std::vector{view_at(places[place])}, {});
    for (std::size_t k = random() % 4; k > 0; --k) {
      std::this_thread::sleep_for(std::chrono::microseconds(random() % 2000));
      stream.take(model, 1);
    }
    if (n % 5 != 0) continue;
    follow(stream, model, places[place], 1);
    ASSERT_EQ(positions(model), alone[place]) << n;
    met.insert(positions(model));
  }
  EXPECT_GE(met.size(), 3u);
}

TEST(LevelStream, ALevelWithoutGaussiansIsALevel) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  copy.edit("lod-meta.json", [](nlohmann::json& meta) {
    meta["tree"]["children"][1]["children"][1]["lods"]["1"]["count"] = 0;
  });
  LevelStream stream(copy.path(), coarse_to_30_px);
  Model model = stream.coarsest();
  EXPECT_EQ(stream.gaussians(), 120u + 65);
  EXPECT_EQ(follow(stream, model, beside_last, 1).back(), 120u + 65 + 248);
  EXPECT_EQ(follow(stream, model, far_away, 1).back(), 120u + 65);
}

// By dB it looks when the views change, and again once what they needed is there, but not for ever.
TEST(LevelStream, LooksAFewTimes) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  test::add_level_errors(copy);
  LevelStream stream(copy.path(), for_db(40.0));
  Model model = stream.coarsest();
  shared::View view = before_all();
  // What one look shows the next one hides.
  std::vector<std::size_t> gaussians;
  const auto rest = [&] {
    gaussians.clear();
    const auto look = [&](const shared::View& seen_by, Band, const ModelChunks& parts) {
      EXPECT_EQ(seen_by.anchor.x, view.anchor.x);
      gaussians.push_back(parts.gaussians());
      const ChunkVisibility seen{gaussians.size() % 2 == 1 ? 2000.0 : 1e-6, 30.0};
      return std::vector(parts.size(), seen);
    };
    ASSERT_TRUE(frames_until(stream, model, view, look, [&] { return stream.settled(); })) << "it hangs";
  };
  rest();
  EXPECT_EQ(gaussians, (std::vector<std::size_t>{250, 1000, 250}));
  EXPECT_EQ(stream.gaussians(), 1000u);
  EXPECT_TRUE(stream.predicted_psnr());
  view.anchor.x += 0.1f;
  rest();
  EXPECT_EQ(gaussians, std::vector<std::size_t>{1000}) << "nothing had to be read";
}

// What nothing needs any more stays for a second, and then goes though nobody asks.
TEST(LevelStream, FinerLevelsStayForAWhile) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  test::add_level_errors(copy);
  LevelStream stream(copy.path(), for_db(40.0));
  Model model = stream.coarsest();
  shared::View view = before_all();
  double of_last = 2000.0;  // px that are seen of the last part
  const auto look = [&](const shared::View&, Band, const ModelChunks& parts) {
    std::vector<ChunkVisibility> seen(parts.size(), {2000.0, 30.0});
    seen[2].area = of_last;
    return seen;
  };
  const auto waits = [&](const std::function<bool()>& is_so) {
    return frames_until(stream, model, view, look, is_so);
  };
  ASSERT_TRUE(waits([&] { return stream.gaussians() == 1000; }));
  of_last = 1e-9;
  view.anchor.x += 0.1f;
  const auto hidden = std::chrono::steady_clock::now();
  const auto since = [&] { return std::chrono::steady_clock::now() - hidden; };
  ASSERT_TRUE(waits([&] {
    EXPECT_EQ(stream.gaussians(), 1000u) << "at once";
    return since() >= std::chrono::milliseconds(500) || testing::Test::HasFailure();
  }));
  EXPECT_FALSE(stream.settled()) << "something is left to go";
  ASSERT_TRUE(waits([&] { return stream.gaussians() == 817; })) << "in the end";
  EXPECT_GT(since(), std::chrono::milliseconds(800));
  ASSERT_TRUE(waits([&] { return stream.settled(); })) << "and nothing more";
  EXPECT_EQ(stream.gaussians(), 817u);
}

// By what is asked of frames, which may change.
TEST(LevelStream, SharesAQuality) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  test::add_level_errors(copy);
  LevelStream stream(copy.path(), [](const StreamedSog&, std::span<const shared::View>) {
    return DetailRequest{.shares = true};
  });
  Model model = stream.coarsest();
  EXPECT_EQ(stream.left(), 0.0);
  shared::View view = before_all();
  int looks = 0;
  const auto rest = [&] {
    const auto look = [&](const shared::View&, Band, const ModelChunks& parts) {
      ++looks;
      return std::vector(parts.size(), ChunkVisibility{20.0, 30.0});
    };
    ASSERT_TRUE(frames_until(stream, model, view, look, [&] { return stream.settled(); })) << "it hangs";
  };
  rest();
  EXPECT_EQ(looks, 0);
  EXPECT_EQ(stream.gaussians(), 1000u) << "nothing may be lost";
  stream.share(20.0);
  rest();
  EXPECT_GT(looks, 0);
  ASSERT_TRUE(stream.predicted_psnr());
  EXPECT_NEAR(psnr_of_both(stream.left(), *stream.predicted_psnr()), 20.0, 1e-6);
  const double told = *stream.predicted_psnr();
  stream.share(60.0);
  rest();
  EXPECT_EQ(stream.gaussians(), 1000u);
  EXPECT_GT(*stream.predicted_psnr(), told) << "planted: as it was told before";
  EXPECT_GE(*stream.predicted_psnr(), 60.0);
}

// One eye where it is, and the other where it will be.
TEST(LevelStream, LooksAheadOfAHeadThatMoves) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  test::add_level_errors(copy);
  LevelStream stream(copy.path(), for_db(40.0));
  Model model = stream.coarsest();
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const double speed = 2.0, stops_at = 1.0;  // world units a second, s
  float now = 0.0f;                          // where the head is
  std::vector<float> here, ahead, at_rest;   // of the looks: where, or how far from the head
  const auto look = [&](const shared::View& seen_by, Band, const ModelChunks& parts) {
    const float from_head = seen_by.anchor.x + seen_by.eye.x - now;
    const bool is_left = seen_by.centre.y == 0.0f;
    if (seconds() > stops_at) {
      at_rest.push_back(from_head);
    } else if (seconds() > 0.5 && seconds() < stops_at) {
      (is_left ? here : ahead).push_back(from_head);
    }
    return std::vector(parts.size(), ChunkVisibility{2000.0, 30.0});
  };
  do {
    now = static_cast<float>(speed * std::min(seconds(), stops_at));
    shared::View left = before_all();
    left.anchor.x = now;
    shared::View right = left;
    right.centre.y = 1.0f;  // tells it from the other
    stream.want(std::vector{left, right}, look);
    stream.take(model, 1);
    ASSERT_LT(seconds(), 60.0) << "it hangs";
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  } while (!stream.settled() || seconds() < stops_at);
  ASSERT_GE(here.size(), 2u);
  ASSERT_GE(ahead.size(), 2u);
  for (const float x : here) EXPECT_EQ(x, 0.0f);
  for (const float x : ahead) EXPECT_NEAR(x, 1.0f, 0.2f);  // half a second
  ASSERT_GE(at_rest.size(), 2u);
  EXPECT_EQ(at_rest.end()[-2], 0.0f) << "planted: a head that has stopped";
  EXPECT_EQ(at_rest.back(), 0.0f);
}

// What is told goes on from what was seen where the head was to what was seen ahead of it.
TEST(LevelStream, TellsOfAHeadThatMoves) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  test::add_level_errors(copy);
  LevelStream stream(copy.path(), for_db(20.0));
  Model model = stream.coarsest();
  float now = 0.0f;  // where the head is
  bool saw_ahead = false;
  const auto look = [&](const shared::View& seen_by, Band, const ModelChunks& parts) {
    const bool is_ahead = seen_by.anchor.x + seen_by.eye.x - now > 0.5f;
    saw_ahead = saw_ahead || is_ahead;
    return std::vector(parts.size(), ChunkVisibility{is_ahead ? 100.0 : 1000.0, 30.0});
  };
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  while (!saw_ahead || seconds() < 0.5) {
    now = static_cast<float>(2.0 * seconds());
    shared::View view = before_all();
    view.anchor.x = now;
    stream.want(std::vector{view, view}, look);
    stream.take(model, 1);
    ASSERT_LT(seconds(), 60.0) << "it looks nowhere ahead";
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const double here = -10.0 * std::log10(3 * 1000.0 * 0.02 / 1e4), ahead = here + 10.0;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ASSERT_TRUE(stream.predicted_psnr());
  const double told = *stream.predicted_psnr();
  EXPECT_GT(told, here) << "planted: of where it was";
  EXPECT_LT(told, ahead);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_NEAR(*stream.predicted_psnr(), ahead, 0.01);
}

// Where a look takes long, the next one is at bands: both times the same is seen, and the same is chosen.
TEST(LevelStream, LooksAtBandsWhereThatTakesLong) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  test::add_level_errors(copy);
  shared::View view = before_all();
  for (const int slow_ms : {0, 10}) {
    LevelStream stream(copy.path(), for_db(40.0));
    Model model = stream.coarsest();
    std::vector<std::pair<float, Band>> looks;  // where the eye was, and at what
    const auto look = [&](const shared::View& seen_by, Band band, const ModelChunks& parts) {
      looks.emplace_back(seen_by.anchor.x, band);
      std::this_thread::sleep_for(std::chrono::milliseconds(slow_ms));
      return std::vector(parts.size(), ChunkVisibility{2000.0 * (band.end - band.begin), 30.0});
    };
    for (const float x : {0.0f, 1.0f}) {
      view.anchor.x = x;
      shared::View other = view;
      other.anchor.x += 0.5f;
      const auto start = std::chrono::steady_clock::now();
      do {
        const std::size_t before = looks.size();
        stream.want(std::vector{view, other}, look);
        EXPECT_LE(looks.size(), before + 1) << "one look a frame";
        const bool took = !stream.take(model, 1).empty();
        EXPECT_FALSE(took && looks.size() > before) << "a look, or levels";
        ASSERT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60)) << "it hangs";
      } while (!stream.settled());
      EXPECT_EQ(stream.gaussians(), 1000u);
    }
    ASSERT_GE(looks.size(), 4u);
    for (const std::size_t k : {0u, 1u}) {
      EXPECT_EQ(looks[k].first, k == 0 ? 0.0f : 0.5f);
      EXPECT_TRUE(looks[k].second.is_all());
    }
    if (slow_ms == 0) continue;
    std::size_t k = 2;
    for (const float eye : {0.0f, 0.5f}) {
      int bands = 0;
      do {
        EXPECT_EQ(looks.at(k).first, eye);
        EXPECT_EQ(looks[k].second.begin, bands == 0 ? 0.0 : looks[k - 1].second.end);
        ++bands;
      } while (looks[k++].second.end < 1.0);
      EXPECT_GE(bands, 3) << "10 ms in glances of 4.5";
    }
  }
}

/// So many Gaussians in leaves of 200 at three levels, of which each loses more, the same from everywhere.
void write_levels(const test::TempFolder& folder, std::size_t count) {
  const auto path = [&](const std::string& name) { return folder / name; };
  const auto learn = [](std::span<const std::vector<Model>> leaves) {
    std::vector<LeafErrors> errors;
    for (const std::vector<Model>& levels : leaves) {
      LeafErrors& leaf = errors.emplace_back();
      leaf.pixels = {0.1};
      leaf.seen.assign(detail_directions, {100.0});
      for (std::size_t level = 0; level < levels.size(); ++level)
        leaf.of_level.emplace_back(detail_directions, std::vector{2.0 * static_cast<double>(level)});
    }
    return errors;
  };
  const auto together = [](std::span<const std::vector<Model>>, std::span<const LeafErrors>, int) {
    return std::vector<LossTogether>{{1.0, 1.0}};
  };
  Model model = test::random_model(1, static_cast<int>(count), 0);
  model.name = "model";
  write_streamed_sog(model, {.leaf = 200, .levels = 3},
                     {[&](const std::string& name) { return fs::exists(path(name)); },
                      [&](const std::string& name) { return test::read_text(path(name)); },
                      [&](const std::string& name, std::span<const std::byte> bytes) {
                        fs::create_directories(path(name).parent_path());
                        test::write_text(path(name), std::string(as_text(bytes)));
                      }},
                     {learn, together});
}

// What frames cannot take in time is not wanted while a head moves, but comes in the end.
TEST(LevelStream, WantsNoMoreThanComes) {
  constexpr std::size_t most = 1 << 14;  // of a choice, however few frames there were
#if defined(__SANITIZE_THREAD__)
  constexpr int idle_frames = 3000;  // what is to come takes ten times as long
#else
  constexpr int idle_frames = 300;
#endif
  const test::TempFolder folder;
  write_levels(folder, 3 * most);
  LevelStream stream(folder.path(), for_db(100.0));
  Model model = stream.coarsest();
  const std::size_t coarsest = stream.gaussians();
  double area = 1e-12;
  int looks = 0;
  const auto look = [&](const shared::View&, Band, const ModelChunks& parts) {
    ++looks;
    return std::vector(parts.size(), ChunkVisibility{area, 30.0});
  };
  shared::View view = before_all();
  const auto frame = [] { std::this_thread::sleep_for(std::chrono::milliseconds(1)); };
  const auto settles = [&] {
    frame();
    return stream.settled();
  };
  ASSERT_TRUE(frames_until(stream, model, view, look, settles));
  EXPECT_EQ(stream.gaussians(), coarsest);
  area = 50.0;
  looks = 0;
  view.anchor.x += 1.0f;
  ASSERT_TRUE(frames_until(stream, model, view, look, [&] {
    frame();
    return looks > 0;
  }));
  for (int idle = 0; idle < idle_frames; ++idle) {
    frame();
    if (!stream.take(model, 1).empty()) idle = 0;
  }
  EXPECT_LE(stream.gaussians(), coarsest + most) << "planted: all at once";
  EXPECT_GT(stream.gaussians(), coarsest + most / 4);
  EXPECT_FALSE(stream.settled());
  ASSERT_TRUE(frames_until(stream, model, view, look, settles));
  EXPECT_EQ(stream.gaussians(), 3 * most);
}

// Frames that look take what the look leaves time for: a long one none of what has been read meanwhile.
TEST(LevelStream, TakesWhatALookLeavesTimeFor) {
  const test::TempFolder folder;
  write_levels(folder, 3000);
  const auto takes_where_it_looked = [&](int look_ms, double frame_has_ms) {
    LevelStream stream(folder.path(), for_db(100.0));
    stream.give_time(frame_has_ms);
    Model model = stream.coarsest();
    int looks = 0;
    const auto look = [&](const shared::View&, Band, const ModelChunks& parts) {
      ++looks;
      std::this_thread::sleep_for(std::chrono::milliseconds(look_ms));
      return std::vector(parts.size(), ChunkVisibility{50.0, 30.0});
    };
    bool takes = false;
    shared::View view = before_all();
    for (int frame = 0; frame < 10 && !takes; ++frame) {
      const int before = looks;
      view.anchor.x += 0.01f;
      stream.want(std::vector{view}, look);
      takes = !stream.take(model, 1).empty() && looks > before;
      std::this_thread::sleep_for(std::chrono::milliseconds(150));
    }
    if (takes) {
      const int before = looks;
      view.anchor.x += 0.01f;
      stream.want(std::vector{view}, look);
      EXPECT_EQ(looks, before) << "though others are left to take";
      EXPECT_FALSE(stream.take(model, 1).empty());
    }
    EXPECT_TRUE(frames_until(stream, model, view, look, [&] { return stream.settled(); })) << "it hangs";
    EXPECT_EQ(stream.gaussians(), 3000u);
    return takes;
  };
  EXPECT_FALSE(takes_where_it_looked(20, LevelStream::brings_most_ms));
  EXPECT_FALSE(takes_where_it_looked(3, 2.5)) << "in a frame that has less time";
  EXPECT_TRUE(takes_where_it_looked(0, LevelStream::brings_most_ms)) << "planted: a short one";
}

// What looks take is more than what levels of few Gaussians save: all are shown.
TEST(LevelStream, LooksAtNothingWhereFewGaussiansAreAll) {
  const test::TempFolder folder;
  write_levels(folder, 3000);
  const auto looks = [&](DetailRequest need, std::size_t all_up_to, double together_db) {
    LevelStream stream(
        folder.path(), [need](const StreamedSog&, std::span<const shared::View>) { return need; }, all_up_to);
    stream.share(together_db);
    Model model = stream.coarsest();
    bool looked = false;
    const auto look = [&](const shared::View&, Band, const ModelChunks& parts) {
      looked = true;
      return std::vector(parts.size(), ChunkVisibility{50.0, 30.0});
    };
    EXPECT_TRUE(frames_until(stream, model, before_all(), look, [&] { return stream.settled(); }))
        << "it hangs";
    if (!looked) {
      EXPECT_EQ(stream.gaussians(), 3000u);
      EXPECT_FALSE(stream.predicted_psnr()) << "nothing is lost";
      EXPECT_EQ(stream.left(), together_db);
    }
    return looked;
  };
  EXPECT_FALSE(looks({.db = 40.0}, 3000, 0.0));
  EXPECT_FALSE(looks({.shares = true}, 3000, 40.0));
  EXPECT_TRUE(looks({.db = 40.0}, 2999, 0.0)) << "planted: too many";
  EXPECT_TRUE(looks({.most = 2999, .db = 40.0}, 3000, 0.0)) << "planted: there is no room";
}

// A window that grows leaves less room: then as many as fit, and nobody goes by dB in the midst of it.
TEST(LevelStream, GoesOnWithoutLooksWhereRoomGrowsLess) {
  const test::TempFolder folder;
  write_levels(folder, 3000);
  const auto need = [](const StreamedSog&, std::span<const shared::View> views) {
    return DetailRequest{.most = views.empty() ? 3000u : 2000u, .db = 40.0};
  };
  LevelStream stream(folder.path(), need, 3000);
  Model model = stream.coarsest();
  const auto look = [](const shared::View&, Band, const ModelChunks& parts) {
    ADD_FAILURE() << "it looks";
    return std::vector<ChunkVisibility>(parts.size());
  };
  EXPECT_TRUE(frames_until(stream, model, before_all(), look, [&] { return stream.settled(); }))
      << "it hangs";
  EXPECT_LE(stream.gaussians(), 2000u);
  EXPECT_GT(stream.gaussians(), 1000u);
  EXPECT_FALSE(stream.predicted_psnr());
}

// A frame that takes what came while the one before it was drawn, looks where it took nothing, and then has
// more put into the model beside it.
struct FrameAhead {
  LevelStream& stream;
  Model& model;
  int looks = 0;
  std::size_t on_gpu = stream.gaussians();
  std::size_t new_most = 0;

  ModelChunks::Changes step(const shared::View& view, std::size_t most, const PartsTrial* trial = nullptr) {
    const std::size_t before = stream.gaussians();
    EXPECT_EQ(before, on_gpu) << "before anybody takes them";
    ModelChunks::Changes changes = stream.take(model, most);
    on_gpu = stream.gaussians();
    new_most = std::max(new_most, on_gpu - std::min(on_gpu, before));
    const auto look = [&](const shared::View&, Band, const ModelChunks& parts) {
      ++looks;
      EXPECT_TRUE(changes.empty()) << "a frame has no time for both";
      EXPECT_EQ(parts.gaussians(), on_gpu) << "what is on the GPU, and nothing that is on its way";
      return std::vector(parts.size(), ChunkVisibility{50.0, 30.0});
    };
    stream.want(std::vector{view}, look);
    if (trial != nullptr) stream.try_out(model, *trial);
    stream.take_ahead(model, most);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // it is drawn
    return changes;
  }

  bool settles(const shared::View& view, std::size_t most) {
    for (int n = 0; n < 10'000 && !stream.settled(); ++n) step(view, most);
    return stream.settled();
  }
};

TEST(LevelStream, TakesAheadWhileAFrameIsDrawn) {
  const test::TempFolder folder;
  write_levels(folder, 3000);
  Model model;
  LevelStream stream(folder.path(), for_db(100.0));
  model = stream.coarsest();
  FrameAhead frame{stream, model};
  shared::View view = before_all();
  frame.step(view, 1);
  EXPECT_TRUE(frame.settles(view, 1));
  EXPECT_EQ(stream.gaussians(), 3000u);
  EXPECT_GT(frame.looks, 0);
  EXPECT_LE(frame.new_most, 200u) << "planted: more than one part at a time";
  EXPECT_GT(frame.new_most, 0u);
  // A head that moves: looks go on beside what comes.
  frame.looks = 0;
  for (int n = 0; n < 300; ++n) {
    view.anchor.x += 0.02f;
    frame.step(view, 100'000);
  }
  EXPECT_GT(frame.looks, 2);
  EXPECT_TRUE(frame.settles(view, 100'000));
  // What it holds is what one gets that takes nothing ahead.
  LevelStream other(folder.path(), for_db(100.0));
  Model same = other.coarsest();
  const auto look = [](const shared::View&, Band, const ModelChunks& parts) {
    return std::vector(parts.size(), ChunkVisibility{50.0, 30.0});
  };
  ASSERT_TRUE(frames_until(other, same, view, look, [&] { return other.settled(); }));
  EXPECT_EQ(positions(model), positions(same));
}

// A sample waits for what is under way, and while it is tried out nothing else comes.
TEST(LevelStream, TakesNothingAheadBesideASample) {
  const test::TempFolder folder;
  write_levels(folder, 50'000);  // more than come in so many frames
  Model model;
  LevelStream stream(folder.path(), for_db(100.0));
  model = stream.coarsest();
  std::vector<float> kept;
  bool is_there = false;  // the sample, or about to be
  int tried = 0;
  const PartsTrial trial = {.upload =
                                [&](const ModelChunks::Changes& changes) {
                                  EXPECT_FALSE(changes.empty());
                                  if (tried % 2 == 0) return;
                                  EXPECT_EQ(positions(model), kept) << "put back, and nothing else has come";
                                  is_there = false;
                                  ++tried;
                                },
                            .keep =
                                [&](const shared::View&) {
                                  EXPECT_EQ(stream.parts().gaussians(), stream.gaussians())
                                      << "planted: what was taken ahead is not on the GPU";
                                  kept = positions(model);
                                  is_there = true;
                                },
                            .differs =
                                [&](const shared::View&) {
                                  EXPECT_NE(positions(model), kept) << "planted: no sample";
                                  ++tried;
                                  return 0.01;
                                }};
  FrameAhead frame{stream, model};
  shared::View view = before_all();
  for (int n = 0; n < 300; ++n) {
    view.anchor.x += n < 200 ? 0.02f : 0.0f;
    const bool was_there = is_there;
    const ModelChunks::Changes changes = frame.step(view, 1, &trial);
    EXPECT_FALSE(was_there && !changes.empty()) << "beside a sample";
    frame.on_gpu = stream.gaussians();  // with a sample
  }
  EXPECT_GT(tried, 1);
}

TEST(LevelStream, EndsWhileItTakesAhead) {
  const test::TempFolder folder;
  write_levels(folder, 3000);
  for (int n = 0; n < 20; ++n) {
    Model model;
    LevelStream stream(folder.path(), for_db(100.0));
    model = stream.coarsest();
    FrameAhead frame{stream, model};
    for (int k = 0; k < n; ++k) frame.step(before_all(), 1);
  }
}

TEST(LevelStream, HasWhatDrawingLeavesOfAFrame) {
  EXPECT_NEAR(time_for_levels(11.1, 5.9), 4.0, 1e-9);
  EXPECT_EQ(time_for_levels(11.1, 1.0), 6.0);
  EXPECT_EQ(time_for_levels(11.1, 20.0), 2.5) << "or a head would wait forever";
}

// What samples are found to lose changes what is told, and what is wanted.
TEST(LevelStream, GoesByWhatASampleLoses) {
  const test::TempFolder folder;
  write_levels(folder, 3000);
  const auto settle = [&](double found, bool tries) {
    LevelStream stream(folder.path(), for_db(24.0));
    Model model = stream.coarsest();
    const auto look = [](const shared::View&, Band, const ModelChunks& parts) {
      return std::vector(parts.size(), ChunkVisibility{100.0, 30.0});
    };
    int kept = 0, tried = 0;
    const PartsTrial trial = {.upload = [](const ModelChunks::Changes&) {},
                              .keep = [&](const shared::View&) { ++kept; },
                              .differs =
                                  [&](const shared::View&) {
                                    ++tried;
                                    return found;
                                  }};
    const auto settles = [&] {
      if (tries) stream.try_out(model, trial);
      return stream.settled();
    };
    EXPECT_TRUE(frames_until(stream, model, before_all(), look, settles));
    EXPECT_EQ(kept, tried);
    EXPECT_EQ(tried > 0, tries);
    return std::pair(stream.gaussians(), stream.predicted_psnr().value());
  };
  const auto [gaussians, told] = settle(0.0, false);
  EXPECT_NEAR(told, 24.0, 1.0);
  const auto [fewer, of_fewer] = settle(0.0, true);
  EXPECT_LT(fewer, gaussians);
  const auto [more, of_more] = settle(10.0, true);
  EXPECT_GT(more, gaussians);
  for (const double db : {of_fewer, of_more}) EXPECT_GT(db, 23.0);
}

// Where the model has all the Gaussians that it may have, too.
TEST(LevelStream, HasRoomForASample) {
  const test::TempFolder folder;
  write_levels(folder, 3000);
  LevelStream stream(folder.path(), [](const StreamedSog&, std::span<const shared::View>) {
    return DetailRequest{.most = 1600, .db = 60.0};
  });
  Model model = stream.coarsest();
  EXPECT_EQ(model.room, 1600 + StreamedSog(folder.path()).spare()) << "which --gpu-memory counts";
  const auto look = [](const shared::View&, Band, const ModelChunks& parts) {
    return std::vector(parts.size(), ChunkVisibility{100.0, 30.0});
  };
  int tried = 0;
  const PartsTrial trial = {.upload = [](const ModelChunks::Changes&) {},
                            .keep = [](const shared::View&) {},
                            .differs =
                                [&](const shared::View&) {
                                  EXPECT_GT(stream.gaussians(), 1600u);
                                  ++tried;
                                  return 0.01;
                                }};
  EXPECT_TRUE(frames_until(stream, model, before_all(), look, [&] {
    stream.try_out(model, trial);
    return stream.settled();
  }));
  EXPECT_GT(tried, 0) << "planted: room for what is chosen only";
  EXPECT_GT(stream.gaussians(), 1500u);
  EXPECT_LE(stream.gaussians(), 1600u);
}

TEST(LevelStream, EndsInTheMidstOfIt) {
  REQUIRE_FIXTURES(folder);
  for (int n = 0; n < 20; ++n) {
    LevelStream stream(folder / "sog/st-lod", coarse_to_30_px);
    Model model = stream.coarsest();
    for (int k = 0; k < n; ++k) {
      stream.want(std::vector{view_at(k % 2 == 0 ? beside_first : beside_last)}, {});
      stream.take(model, 300);
    }
  }
}

TEST(LevelStream, TellsWhatIsWrong) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  LevelStream stream(copy.path(), coarse_to_30_px);
  Model model = stream.coarsest();
  EXPECT_TRUE(test::fails_saying([&] { LevelStream(copy.path(), for_db(40.0)).coarsest(); },
                                 {"--detail 40dB", "has no errors of its levels to go by"}));
  std::filesystem::resize_file(copy.path() / "0_0/means_l.webp", 100);
  EXPECT_TRUE(test::fails_saying([&] { follow(stream, model, beside_first, 1); }, {"0_0", "means_l.webp"}));
  EXPECT_EQ(stream.gaussians(), 250u);
  EXPECT_TRUE(test::fails_saying([&] { stream.take(model, 1); }, {"0_0", "means_l.webp"})) << "still";
}

}  // namespace
}  // namespace binosplat
