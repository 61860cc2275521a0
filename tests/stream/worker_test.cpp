// The thread that chooses and reads levels. The leaves have 505 and 120, 247 and 65, 248 and 65 Gaussians.

#include "stream/worker.h"

#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <set>
#include <thread>

#include "stream/stream_levels.h"
#include "support/broken.h"
#include "support/details.h"
#include "support/fixtures.h"

namespace binosplat {
namespace {

using Levels = std::vector<std::size_t>;
using test::beside_first;
using test::beside_last;
using test::far_away;
using test::view_at;

StreamWorker::Request request_from(const glm::dvec3& eye) { return {{view_at(eye)}, {30.0}, {}}; }

/// Returns all chunks that arrive, in order.
std::vector<LodFiles::LoadedChunk> all_of(StreamWorker& worker) {
  std::vector<LodFiles::LoadedChunk> all;
  const auto start = std::chrono::steady_clock::now();
  while (!worker.is_idle() && !testing::Test::HasFailure()) {
    worker.check();
    for (LodFiles::LoadedChunk& loaded : worker.take(1)) all.push_back(std::move(loaded));
    if (std::chrono::steady_clock::now() - start > std::chrono::seconds(60)) ADD_FAILURE() << "it hangs";
    std::this_thread::yield();
  }
  return all;
}

void note_levels(const std::vector<LodFiles::LoadedChunk>& loaded_chunks, Levels& levels) {
  for (const LodFiles::LoadedChunk& loaded : loaded_chunks) levels[loaded.chunk] = loaded.level;
}

TEST(StreamWorker, ReadsShrinkingLevelsFirst) {
  REQUIRE_FIXTURES(folder);
  const LodFiles files(folder / "sog/st-lod");
  StreamWorker worker(files, {1, 1, 1});
  EXPECT_TRUE(worker.is_idle());
  worker.request(request_from(far_away));
  EXPECT_TRUE(all_of(worker).empty());
  worker.request(request_from(beside_last));
  const auto finer = all_of(worker);
  ASSERT_EQ(finer.size(), 1u);
  EXPECT_EQ(finer[0].model.count(), 248u);
  worker.request(request_from(beside_first));
  const auto both = all_of(worker);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[0].model.count(), 65u);
  EXPECT_EQ(both[1].model.count(), 505u);
  worker.request(request_from(beside_first));
  EXPECT_TRUE(all_of(worker).empty());
}

// This holds for any number of other requests, and whatever chunks arrived before.
TEST(StreamWorker, LastRequestWins) {
  REQUIRE_FIXTURES(folder);
  const LodFiles files(folder / "sog/st-lod");
  const std::vector<glm::dvec3> places = {far_away, beside_first, beside_last, {-8, 0, 4}, {0, 0, 12}};
  std::vector<Levels> alone;
  for (const glm::dvec3& place : places)
    alone.push_back(choose_levels(files.chunks(), std::vector{view_at(place)}, {30.0}).levels);
  std::mt19937 random(5);
  Levels levels = {1, 1, 1};
  StreamWorker worker(files, levels);
  std::set<Levels> met;
  for (int n = 0; n < 400; ++n) {
    const std::size_t place = random() % places.size();
    worker.request(request_from(places[place]));
    for (std::size_t k = random() % 4; k > 0; --k) {
      std::this_thread::sleep_for(std::chrono::microseconds(random() % 2000));
      note_levels(worker.take(1), levels);
    }
    if (n % 5 != 0) continue;
    note_levels(all_of(worker), levels);
    ASSERT_EQ(levels, alone[place]) << n;
    met.insert(levels);
  }
  EXPECT_GE(met.size(), 3u) << "injected: always the same";
}

TEST(StreamWorker, AcceptsEmptyLevel) {
  REQUIRE_FIXTURES(folder);
  const test::Copy copy(folder / "sog/st-lod");
  copy.edit("lod-meta.json", [](nlohmann::json& meta) {
    meta["tree"]["children"][1]["children"][1]["lods"]["1"]["count"] = 0;
  });
  const LodFiles files(copy.path());
  StreamWorker worker(files, {1, 1, 0});
  worker.request(request_from(far_away));
  const auto loaded_chunks = all_of(worker);
  ASSERT_EQ(loaded_chunks.size(), 1u);
  EXPECT_EQ(loaded_chunks[0].level, 1u);
  EXPECT_EQ(loaded_chunks[0].model.count(), 0u);
}

TEST(StreamWorker, ReportsErrorOfViews) {
  const test::TempFolder folder;
  test::write_levels(folder, 3000);
  const LodFiles files(folder.path());
  const std::size_t chunks = files.chunks().size();
  StreamWorker worker(files, Levels(chunks, 2));
  shared::View view = view_at({0, 0, -30});
  view.row_x = {1, 0, 0, 0};
  view.row_y = {0, 1, 0, 0};
  view.row_z = {0, 0, 1, 0};
  view.width = view.height = 100;
  EXPECT_FALSE(worker.chosen().error);
  const VisibleChunks visible{{std::vector<ChunkVisibility>(chunks, {50.0, 30.0})}, Levels(chunks, 2)};
  worker.request({{view}, {.db = 100.0, .max_read = 400}, visible});
  Levels levels(chunks, 2);
  note_levels(all_of(worker), levels);
  ASSERT_TRUE(worker.chosen().error);
  EXPECT_TRUE(worker.chosen().is_limited);
  const double before = worker.chosen().error->error(0, 1);
  worker.chosen().error->follow(levels);
  EXPECT_LT(worker.chosen().error->error(0, 1), before) << "injected: of the levels that were drawn";
  EXPECT_GT(worker.chosen().error->error(0, 1), 0.0);
  worker.request({{view}, {.db = 100.0}, visible});
  note_levels(all_of(worker), levels);
  EXPECT_FALSE(worker.chosen().is_limited);
  EXPECT_EQ(levels, Levels(chunks, 0));
}

TEST(StreamWorker, StopsWhileReading) {
  REQUIRE_FIXTURES(folder);
  const LodFiles files(folder / "sog/st-lod");
  for (int n = 0; n < 20; ++n) {
    StreamWorker worker(files, {1, 1, 1});
    for (int k = 0; k < n; ++k) {
      worker.request(request_from(k % 2 == 0 ? beside_first : beside_last));
      worker.take(1);
    }
  }
}

}  // namespace
}  // namespace binosplat
