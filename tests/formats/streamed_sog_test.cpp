// Levels of detail that follow the eyes: leaves of 505 and 120, 247 and 65, 248 and 65 Gaussians.

#include "formats/streamed_sog.h"

#include <gtest/gtest.h>

#include <set>

#include "formats/model_file.h"
#include "support/broken.h"
#include "support/fixtures.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using test::Copy;

bool equal(const Model& a, const Model& b) {
  return a.position == b.position && a.scale == b.scale && a.rotation == b.rotation &&
         a.opacity == b.opacity && a.sh == b.sh && a.degree == b.degree;
}

/// A view at a place; where it looks does not matter.
shared::View at(const glm::dvec3& eye, float focal = 100.0f) {
  shared::View view{};
  view.anchor = glm::vec4(eye, 0.2f);
  view.lens = {focal, focal, 0, 0};
  return view;
}

const glm::dvec3 beside_first = {-14, -1, 0}, beside_last = {6, 0, 15}, far_away = {0, 0, -400};

Model read(StreamedSog& scene, const std::vector<shared::View>& views, const DetailNeed& need) {
  scene.choose(views, need);
  return scene.read();
}

/// The same without anything read before.
Model read_anew(const fs::path& path, const glm::dvec3& eye, const DetailNeed& need) {
  StreamedSog scene(path);
  return read(scene, {at(eye)}, need);
}

TEST(StreamedSog, FineWhereItIsNearCoarseWhereItIsFar) {
  REQUIRE_FIXTURES(folder);
  const fs::path lod = folder / "sog/st-lod";
  const Model fine = load_model(lod, {.lod = 0}), coarse = load_model(lod, {.lod = 1});
  StreamedSog scene(lod);
  EXPECT_EQ(scene.degree(), 3);
  EXPECT_TRUE(scene.choose({}, {}));
  EXPECT_TRUE(equal(scene.read(), coarse)) << "the coarsest, unless somebody looks";
  EXPECT_FALSE(scene.choose(std::vector{at(far_away)}, {30.0}));
  EXPECT_TRUE(equal(read(scene, {at(beside_last)}, {0.0}), fine)) << "0 px: nothing is fine enough";
  EXPECT_TRUE(equal(read(scene, {at(far_away)}, {30.0}), coarse));
  const Model last = read(scene, {at(beside_last)}, {30.0});
  EXPECT_EQ(last.count(), 120u + 65 + 248);
  const Model first = read(scene, {at(beside_first)}, {30.0});
  EXPECT_EQ(first.count(), 505u + 65 + 65);
  EXPECT_EQ(first.position[0], fine.position[0]);
  EXPECT_EQ(first.position[505], coarse.position[120]);
  // A longer lens sees more of it.
  EXPECT_TRUE(equal(read(scene, {at(far_away, 1e5f)}, {30.0}), fine));
}

TEST(StreamedSog, WhatIsTakenFromTheLastModelIsWhatTheFilesSay) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "sog/st-lod");
  copy.edit("lod-meta.json", [](nlohmann::json& meta) { meta["environment"] = "1_0/meta.json"; });
  StreamedSog scene(copy.path());
  for (const glm::dvec3& eye : {far_away, beside_last, beside_first, far_away, beside_first}) {
    const Model model = read(scene, {at(eye)}, {30.0});
    const Model anew = read_anew(copy.path(), eye, {30.0});
    EXPECT_TRUE(equal(model, anew)) << eye.x;
    Model faulty = anew;  // planted: a Gaussian of another level
    std::swap(faulty.position.front(), faulty.position.back());
    EXPECT_FALSE(equal(model, faulty));
  }
}

TEST(StreamedSog, OneChoiceForBothEyes) {
  REQUIRE_FIXTURES(folder);
  const fs::path lod = folder / "sog/st-lod";
  const shared::View left = at(beside_first), right = at(beside_last);
  StreamedSog scene(lod), swapped(lod);
  const Model both = read(scene, {left, right}, {30.0});
  EXPECT_EQ(both.count(), 505u + 65 + 248) << "each part as the nearer eye sees it";
  EXPECT_TRUE(equal(both, read(swapped, {right, left}, {30.0})));
  EXPECT_FALSE(equal(both, read_anew(lod, beside_first, {30.0}))) << "planted: the left eye's choice";
}

TEST(StreamedSog, AHeadThatTremblesSwitchesOnce) {
  REQUIRE_FIXTURES(folder);
  StreamedSog scene(folder / "sog/st-lod");
  const auto place = [](int n) { return glm::dvec3(n % 2 == 0 ? -45.0 : -47.0, -1, 3); };
  // The outer leaves are seen 5.6 and 5.5 px coarse from the one place, 5.3 from the other.
  int switches = 0;
  std::set<std::size_t> anew;
  for (int n = 0; n < 20; ++n) {
    if (scene.choose(std::vector{at(place(n))}, {5.4})) {
      ++switches;
      scene.read();
    }
    anew.insert(read_anew(folder / "sog/st-lod", place(n), {5.4}).count());
  }
  EXPECT_EQ(switches, 1) << "the first";
  EXPECT_EQ(anew.size(), 2u) << "without a memory it would switch with each step";
}

TEST(StreamedSog, KeepsToTheRoomThereIs) {
  REQUIRE_FIXTURES(folder);
  StreamedSog scene(folder / "sog/st-lod");
  for (const std::size_t most : {1000, 999, 700, 440, 250}) {
    for (const glm::dvec3& eye : {beside_first, far_away, beside_last})
      EXPECT_LE(read(scene, {at(eye)}, {0.0, most}).count(), most);
  }
}

TEST(StreamedSog, SaysWhatItCannotOpen) {
  REQUIRE_FIXTURES(folder);
  EXPECT_TRUE(is_streamed_sog(folder / "sog/st-lod"));
  for (const char* other : {"sog/st-lod/0_0", "sog/st-train-sh3.sog", "nothing"}) {
    EXPECT_FALSE(is_streamed_sog(folder / other));
    EXPECT_TRUE(test::fails_saying([&] { StreamedSog scene(folder / other); },
                                   {"--detail", "no levels of detail", other}));
  }
  const Copy copy(folder / "sog/st-lod");  // what is not there is not chosen
  fs::remove_all(copy.path() / "0_0");
  EXPECT_EQ(read_anew(copy.path(), beside_first, {0.0}).count(), 250u);
  fs::remove_all(copy.path() / "1_0");
  EXPECT_TRUE(test::fails_saying([&] { StreamedSog scene(copy.path()); },
                                 {"lod-meta.json", "none of its levels of detail is there"}));
}

TEST(StreamedSog, RoomIsMadeForWhatIsThere) {
  REQUIRE_FIXTURES(folder);
  const Copy copy(folder / "sog/st-lod");
  copy.edit("lod-meta.json", [](nlohmann::json& meta) {
    meta["tree"]["children"][1]["children"][1]["lods"]["0"]["count"] = 4'000'000'000u;
  });
  StreamedSog scene(copy.path());
  scene.choose(std::vector{at(beside_last)}, {0.0});
  EXPECT_TRUE(test::fails_saying([&] { scene.read(); },
                                 {"Gaussians 752 to 4000000751 of", "0_0/meta.json", "which has 1000"}));
}

}  // namespace
}  // namespace binosplat
