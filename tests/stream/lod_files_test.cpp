// Levels of detail for moving eyes. The leaves have 505 and 120, 247 and 65, 248 and 65 Gaussians.

#include "stream/lod_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <set>

#include "formats/models/model_file.h"
#include "formats/models/streamed_sog.h"
#include "scene/reduce.h"
#include "stream/chooser.h"
#include "support/broken.h"
#include "support/details.h"
#include "support/fixtures.h"
#include "support/ply_models.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using test::beside_first;
using test::beside_last;
using test::Copy;
using test::far_away;
using test::view_at;

/// A streamed SOG, and its chunks that were read.
struct Followed {
  LodFiles files;
  Chooser chooser{files};
  LevelChoice choice;
  std::vector<std::size_t> levels = std::vector(files.chunks().size(), LodFiles::not_read);
  std::vector<Model> chunks = std::vector(files.chunks().size(), files.properties());
  std::size_t read_at_last = 0;

  explicit Followed(const fs::path& path) : files(path) {}

  bool choose(const std::vector<shared::View>& views, const DetailRequest& request,
              const VisibleChunks& visible = {}) {
    choice = chooser.choose(views, request, visible);
    return choice.levels != levels;
  }
  /// Returns the Gaussians of the tree, then those that belong to every level.
  Model read() {
    read_at_last = 0;
    const std::vector<std::size_t> from = levels;
    files.read(from, choice, [&](LodFiles::LoadedChunk loaded) {
      levels.at(loaded.chunk) = loaded.level;
      chunks.at(loaded.chunk) = std::move(loaded.model);
      ++read_at_last;
    });
    Model all = files.properties();
    for (const Model& chunk : chunks) append(all, chunk, 0, chunk.count());
    const Model environment = files.environment();
    append(all, environment, 0, environment.count());
    return all;
  }
  Model read(const std::vector<shared::View>& views, const DetailRequest& request) {
    choose(views, request);
    return read();
  }
  std::optional<double> predicted_db() const {
    return choice.has_errors() ? std::optional(psnr_of_error(choice.error())) : std::nullopt;
  }
};

/// Returns the model that a first read gives.
Model read_anew(const fs::path& path, const glm::dvec3& eye, const DetailRequest& need) {
  return Followed(path).read({view_at(eye)}, need);
}

TEST(LodFiles, NearChunksAreFiner) {
  REQUIRE_FIXTURES(folder);
  const fs::path lod = folder / "sog/st-lod";
  const Model fine = load_model(lod, {.lod = 0}), coarse = load_model(lod, {.lod = 1});
  Followed scene(lod);
  EXPECT_EQ(scene.files.properties().degree, 3);
  EXPECT_TRUE(scene.choose({}, {}));
  EXPECT_TRUE(test::equal(scene.read(), coarse)) << "the coarsest, unless somebody looks";
  EXPECT_FALSE(scene.choose({view_at(far_away)}, {30.0}));
  EXPECT_TRUE(test::equal(scene.read({view_at(beside_last)}, {0.0}), fine)) << "0 px: nothing is fine enough";
  EXPECT_TRUE(test::equal(scene.read({view_at(far_away)}, {30.0}), coarse));
  const Model last = scene.read({view_at(beside_last)}, {30.0});
  EXPECT_EQ(last.count(), 120u + 65 + 248);
  const Model first = scene.read({view_at(beside_first)}, {30.0});
  EXPECT_EQ(first.count(), 505u + 65 + 65);
  EXPECT_EQ(first.position[0], fine.position[0]);
  EXPECT_EQ(first.position[505], coarse.position[120]);
  // A longer lens needs finer levels.
  EXPECT_TRUE(test::equal(scene.read({view_at(far_away, 1e5f)}, {30.0}), fine));
}

TEST(LodFiles, ReusedPartsMatchFiles) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "sog/st-lod");
  copy.edit("lod-meta.json", [](nlohmann::json& meta) { meta["environment"] = "1_0/meta.json"; });
  Followed scene(copy.path());
  for (const glm::dvec3& eye : {far_away, beside_last, beside_first, far_away, beside_first}) {
    const Model model = scene.read({view_at(eye)}, {30.0});
    const Model anew = read_anew(copy.path(), eye, {30.0});
    EXPECT_TRUE(test::equal(model, anew)) << eye.x;
    Model faulty = anew;  // injected: Gaussians in another order
    std::swap(faulty.position.front(), faulty.position.back());
    EXPECT_FALSE(test::equal(model, faulty));
  }
}

TEST(LodFiles, ReadsOnlySwitchedLevels) {
  REQUIRE_FIXTURES(folder);
  Followed scene(folder / "sog/st-lod");
  scene.read({view_at(beside_last)}, {30.0});
  EXPECT_EQ(scene.read_at_last, 3u);
  scene.read({view_at(beside_last)}, {30.0});
  EXPECT_EQ(scene.read_at_last, 0u);
  scene.choose({view_at(beside_first)}, {30.0});
  std::vector<std::size_t> counts;
  const auto take = [&](const LodFiles::LoadedChunk& loaded) {
    counts.push_back(loaded.model.count());
    scene.levels[loaded.chunk] = loaded.level;
  };
  scene.files.read(std::vector(scene.levels), scene.choice, take, [] { return false; });
  EXPECT_EQ(counts, std::vector<std::size_t>{65}) << "a file, and then it was asked to end";
  scene.files.read(std::vector(scene.levels), scene.choice, take);
  EXPECT_EQ(counts, (std::vector<std::size_t>{65, 505}));
}

TEST(LodFiles, TremblingHeadSwitchesOnce) {
  REQUIRE_FIXTURES(folder);
  Followed scene(folder / "sog/st-lod");
  const auto place = [](int n) { return glm::dvec3(n % 2 == 0 ? -45.0 : -47.0, -1, 3); };
  // The outer leaves' spacings are 5.6 and 5.5 px from one position, 5.3 px from the other.
  int switches = 0;
  std::set<std::size_t> anew;
  for (int n = 0; n < 20; ++n) {
    scene.read({view_at(place(n))}, {5.4});
    switches += scene.read_at_last > 0 ? 1 : 0;
    anew.insert(read_anew(folder / "sog/st-lod", place(n), {5.4}).count());
  }
  EXPECT_EQ(switches, 1) << "the first";
  EXPECT_EQ(anew.size(), 2u) << "without a memory it would switch with each step";
}

TEST(LodFiles, ReportsUnreadableFiles) {
  REQUIRE_FIXTURES(folder);
  EXPECT_TRUE(is_streamed_sog(folder / "sog/st-lod"));
  for (const char* other : {"sog/st-lod/0_0", "sog/st-train-sh3.sog"}) {
    EXPECT_FALSE(is_streamed_sog(folder / other));
    EXPECT_ERROR(LodFiles files(folder / other), "no levels of detail", other);
  }
  EXPECT_ERROR(LodFiles files(folder / "nothing"), "nothing", "No such file");
  const Copy copy(folder / "sog/st-lod");  // missing files are not chosen
  fs::remove_all(copy.path() / "0_0");
  EXPECT_EQ(read_anew(copy.path(), beside_first, {0.0}).count(), 250u);
  fs::remove_all(copy.path() / "1_0");
  EXPECT_ERROR(LodFiles files(copy.path()), "lod-meta.json", "all its levels of detail are missing");
}

/// The tree's leaves, and the errors of their level 1 in pixels 0.02 and 0.04 wide, the same in all
/// directions.
const std::vector<std::pair<const char*, std::vector<double>>> learnt = {
    {"/tree/children/0", {40.0, 10.0}},
    {"/tree/children/1/children/0", {20.0, 5.0}},
    {"/tree/children/1/children/1", {30.0, 6.0}}};

/// Writes these errors into lod-meta.json.
void add_errors(nlohmann::json& meta) {
  for (const auto& [pointer, errors] : learnt) {
    nlohmann::json& leaf = meta[nlohmann::json::json_pointer(pointer)];
    const auto from_everywhere = [](const std::vector<double>& by_width) {
      return std::vector(detail_directions, by_width);
    };
    leaf["pixels"] = {0.02, 0.04};
    leaf["seen"] = from_everywhere({4000.0, 1000.0});
    leaf["lods"]["0"]["errors"] = from_everywhere({0.0, 0.0});
    leaf["lods"]["1"]["errors"] = from_everywhere(errors);
  }
}

/// Returns a picture of 100 x 100 px of everything ahead.
shared::View ahead(const glm::dvec3& eye, float forward = 1.0f) {
  shared::View view = view_at(eye);
  view.row_x = {forward, 0, 0, 0};
  view.row_y = {0, 1, 0, 0};
  view.row_z = {0, 0, forward, 0};
  view.lens = {100, 100, 50, 50};
  view.width = view.height = 100;
  return view;
}

TEST(LodFiles, ChoosesByErrorsOfFile) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "sog/st-lod");
  copy.edit("lod-meta.json", add_errors);
  Followed scene(copy.path());
  scene.choose({}, {});
  EXPECT_FALSE(scene.predicted_db());
  // At this distance a pixel is 3.8 to 4 world units wide, about 100 times the largest width in the file. So
  // the chunks cover 10,000 times fewer pixels.
  const std::size_t coarse = scene.read({ahead(far_away)}, {.db = 40.0}).count();
  EXPECT_EQ(coarse, 250u);
  const double lost = 4000.0 * 0.02 * 0.02 / (3.9 * 3.9) * 21.0 / 1000.0 / 1e4;
  EXPECT_NEAR(*scene.predicted_db(), -10.0 * std::log10(lost), 1.0);
  std::size_t last = coarse;
  for (const double db : {60.0, 66.0, 69.0, 72.0, 80.0}) {
    const std::size_t count = scene.read({ahead(far_away)}, {.db = db}).count();
    EXPECT_GE(count, last) << db;
    EXPECT_GE(*scene.predicted_db(), db - 0.5) << db;
    last = count;
  }
  EXPECT_EQ(last, 1000u);
  // If no chunk is visible, nothing is lost.
  Followed behind(copy.path());
  behind.choose({ahead(far_away, -1.0f)}, {.db = 40.0});
  EXPECT_TRUE(std::isinf(*behind.predicted_db()));
  behind.choose({}, {.db = 40.0});
  EXPECT_FALSE(behind.predicted_db()) << "the coarsest, unless somebody looks";
  EXPECT_EQ(behind.read().count(), 250u);
}

// According to the file, the finest level shows nothing and a coarser one does. So the coarser level's loss
// is unknown.
TEST(LodFiles, RefinesUnknownLosses) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "sog/st-lod");
  for (const double seen : {4000.0, 1e-20, 0.0}) {
    copy.edit("lod-meta.json", [&](nlohmann::json& meta) {
      add_errors(meta);
      for (nlohmann::json& of : meta["tree"]["children"][0]["seen"]) of[1] = seen;
    });
    Followed scene(copy.path());
    scene.choose({ahead(far_away)}, {.db = 40.0});
    EXPECT_EQ(scene.choice.levels[0] == 0, seen < 1.0) << seen;
    EXPECT_NE(scene.choice.levels[1], 0u);
  }
}

TEST(LodFiles, ReadsLargestSavingFirst) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "sog/st-lod");
  fs::copy(copy.path() / "0_0", copy.path() / "0_1", fs::copy_options::recursive);
  copy.edit("lod-meta.json", [](nlohmann::json& meta) {
    add_errors(meta);
    meta["filenames"].push_back("0_1/meta.json");
    meta["tree"]["children"][1]["children"][1]["lods"]["0"]["file"] = 2;
  });
  const double much = 1000.0, little = 100.0;  // visible px of each chunk
  for (const bool last_is_first : {false, true}) {
    Followed scene(copy.path());
    scene.read({}, {});
    VisibleChunks visible{{std::vector<ChunkVisibility>(3, {little, 21.0})}, scene.levels};
    visible.by_view[0][last_is_first ? 2 : 0].area = much;
    scene.choose({ahead({0, 0, -20})}, {.db = 80.0}, visible);
    std::vector<std::size_t> order;
    scene.files.read(scene.levels, scene.choice,
                     [&](const LodFiles::LoadedChunk& loaded) { order.push_back(loaded.chunk); });
    ASSERT_EQ(order.size(), 3u);
    EXPECT_EQ(order[last_is_first ? 0 : 2], 2u);
  }
}

TEST(LodFiles, ReadsFinestLevelsOfChunks) {
  REQUIRE_FIXTURES(folder);
  const LodFiles files(folder / "sog/st-lod");
  const Model fine = load_model(folder / "sog/st-lod", {.lod = 0});
  const ChunkModels finest = files.read_finest(std::vector<std::size_t>{2, 0});
  ASSERT_EQ(finest.chunks.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t first = finest.chunks[k] == 0 ? 0 : 752;
    EXPECT_EQ(finest.models[k].count(), finest.chunks[k] == 0 ? 505u : 248u);
    EXPECT_EQ(finest.models[k].position.front(), fine.position[first]);
  }
}

TEST(LodFiles, RejectsInvalidErrors) {
  REQUIRE_FIXTURES(folder);
  using Json = nlohmann::json;
  const Copy copy(folder / "sog/st-lod");
  Json good = Json::parse(copy.read("lod-meta.json"));
  add_errors(good);
  const Json right = std::vector(detail_directions, std::vector(2, 1.0));
  const auto with = [&](std::size_t d, const Json& wrong) {
    Json json = right;
    json[d] = wrong;
    return json;
  };
  // The wrong key in the first leaf, its value (null: missing), and the expected message about it.
  std::vector<std::tuple<std::string, Json, std::string>> cases = {
      {"/pixels", 0, ".pixels': expected a list"},
      {"/pixels", Json::array(), ".pixels': expected one width at least"},
      {"/pixels", {0.0, 1.0}, ".pixels[0]': expected a width above 0, found 0"},
      {"/pixels", {0.5, 0.5}, ".pixels[1]': expected a width above 0.5, found 0.5"},
      {"/pixels", {0.5, 1e21}, ".pixels[1]': expected at most 1e+20, found 1e+21"},
      {"/pixels", {0.5, "x"}, ".pixels[1]': expected a finite number"},
      {"/lods/2", right, ".lods': expected only levels from 0 to 1"},
      {"/bound/min", {1e9, 1e9, 1e9}, ".bound': expected a 'min' that is at most 'max'"},
      {"/bound/max/1", 1e300, ".bound': expected numbers from -1e+20 to 1e+20"}};
  for (const auto& [pointer, key] : {std::pair("/lods/1/errors", ".lods.1.errors"), {"/seen", ".seen"}}) {
    const std::pair<Json, const char*> wrong_lists[] = {
        {nullptr, "' is missing"},
        {3, "': expected a list"},
        {Json::array(), "': expected 6 values, found 0"},
        {with(2, 3), "[2]': expected a list"},
        {with(5, {1.0}), "[5]': expected 2 values, found 1"},
        {with(0, {1, 2, 3}), "[0]': expected 2 values, found 3"},
        {with(1, {1.0, -1.0}), "[1][1]': expected 0 or more, found -1"},
        {with(4, {1e308, 1.0}), "[4][0]': expected at most 1e+20, found 1e+308"},
        {with(1, {nullptr, 1.0}), "[1][0]': expected a finite number"},
        {with(1, {1.0, "x"}), "[1][1]': expected a finite number"}};
    for (const auto& [wrong, said] : wrong_lists) cases.emplace_back(pointer, wrong, std::string(key) + said);
  }
  for (const Json& wrong : {Json(0), Json::array(), Json("x"), Json(true)}) {
    cases.emplace_back("/lods", wrong, ".lods': expected an object");
    cases.emplace_back("", wrong, "': expected an object");
  }
  for (const auto& [pointer, wrong, said] : cases) {
    copy.write(test::with_value(good, "/tree/children/0" + pointer, wrong), "lod-meta.json");
    EXPECT_ERROR(LodFiles(copy.path()).check({.db = 40.0}), "lod-meta.json", "key 'tree.children[0]" + said)
        << pointer << wrong;
  }
  for (const Json& version : {Json(99), Json(0), Json(1.5), Json("1"), Json::array()}) {
    copy.write(test::with_value(good, "/version", version), "lod-meta.json");
    for (const auto& read :
         std::vector<std::function<void()>>{[&] { LodFiles{copy.path()}; }, [&] { load_model(copy.path()); }})
      EXPECT_TRUE(test::fails_saying(read, {"lod-meta.json, key 'version': "})) << version;
  }
  // Without widths the errors are ignored. Without any errors, levels cannot be chosen by dB.
  Json without = good;
  without["tree"]["children"][0].erase("pixels");
  copy.write(test::with_value(without, "/tree/children/0/lods/1/errors", -1), "lod-meta.json");
  EXPECT_NO_THROW(LodFiles(copy.path()).check({.db = 40.0}));
  const LodFiles none(folder / "sog/st-lod");
  EXPECT_ERROR(none.check({.db = 40.0}), "st-lod/lod-meta.json lacks the errors of its levels, which 40 dB",
               "run `binosplat levels`");
}

TEST(LodFiles, RejectsExcessiveCounts) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "sog/st-lod");
  copy.edit("lod-meta.json", [](nlohmann::json& meta) {
    meta["tree"]["children"][1]["children"][1]["lods"]["0"]["count"] = 4'000'000'000u;
  });
  Followed scene(copy.path());
  EXPECT_ERROR(scene.read({view_at(beside_last)}, {0.0}), "Gaussians 752 to 4000000751 of", "0_0/meta.json",
               "which has 1000");
}

}  // namespace
}  // namespace binosplat
