// Per-image exposures in INRIA's exposure.json.

#include "formats/training/exposures.h"

#include <gtest/gtest.h>

#include "base/image.h"
#include "formats/models/model_file.h"
#include "support/broken.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;

const char* const two_views = R"({
  "0001.png": [[0.9, 0.2, 0, 0.01], [0.1, 0.8, 0, 0.02], [0, 0, 1.1, -0.03]],
  "b": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]})";

TEST(Exposures, ApplyMatrixLikeInria) {
  const test::TempFolder folder;
  test::write_text(folder / "exposure.json", two_views);
  const Exposures exposures(folder / "exposure.json");
  EXPECT_EQ(exposures.count(), 2u);
  EXPECT_TRUE(exposures.changes_any());
  Image picture(1, 1, 3);
  picture.data = {0.5f, 0.25f, 0.75f};
  const Image changed = exposed(picture, exposures.of("0001.png"));
  // The colour is a row vector that multiplies the matrix from the left: red adds 0.2 of itself to green, and
  // gets 0.1 of green.
  EXPECT_NEAR(changed.data[0], 0.9 * 0.5 + 0.1 * 0.25 + 0.01, 1e-6);
  EXPECT_NEAR(changed.data[1], 0.2 * 0.5 + 0.8 * 0.25 + 0.02, 1e-6);
  EXPECT_NEAR(changed.data[2], 1.1 * 0.75 - 0.03, 1e-6);
  const Image back = exposed(changed, inverse_exposure(exposures.of("0001.png")).value());
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(back.data[i], picture.data[i], 1e-6);
  EXPECT_FALSE(inverse_exposure(glm::mat4x3(0.0f)));
}

TEST(Exposures, MatchNamesWithoutExtension) {
  const test::TempFolder folder;
  test::write_text(folder / "e.json", two_views);
  const Exposures exposures(folder / "e.json");
  EXPECT_EQ(exposures.of("0001"), exposures.of("0001.png"));
  EXPECT_EQ(exposures.of("0001.JPG"), exposures.of("0001.png"));
  EXPECT_TRUE(exposures.has("b.jpg"));
  EXPECT_FALSE(exposures.has("c"));
  EXPECT_EQ(exposures.of("c"), glm::mat4x3(1.0f));
  // If two names differ only in their extensions, only the full names match.
  const char* const same =
      R"({"a.png": [[2,0,0,0],[0,1,0,0],[0,0,1,0]], "a.jpg": [[3,0,0,0],[0,1,0,0],[0,0,1,0]]})";
  test::write_text(folder / "e.json", same);
  const Exposures apart(folder / "e.json");
  EXPECT_EQ(apart.of("a.jpg")[0][0], 3.0f);
  EXPECT_FALSE(apart.has("a"));
}

TEST(Exposures, RejectInvalidFiles) {
  const test::TempFolder folder;
  const auto read = [&](const std::string& text) {
    test::write_text(folder / "e.json", text);
    return Exposures(folder / "e.json");
  };
  EXPECT_FALSE(Exposures().changes_any());
  EXPECT_FALSE(read(R"({"b": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]})").changes_any());
  const std::vector<test::BrokenFile> refusals = {
      {"[1]", {"expected an object"}},
      {"{\"a\": 1}", {"key 'a'"}},
      {"{\"a\": [[1,0,0,0],[0,1,0,0]]}", {"key 'a'"}},
      {"{\"a\": [[1,0,0],[0,1,0],[0,0,1]]}", {"key 'a[0]'"}},
      {"{\"a\": [[1,0,0,0],[0,\"x\",0,0],[0,0,1,0]]}", {"key 'a[1][1]'"}},
      {"{\"a\": [[1,0,0,0],[0,1e999,0,0],[0,0,1,0]]}", {}},
      {"{\"a\": ", {"not valid JSON"}}};
  test::expect_refusals("e.json", refusals, read);
}

TEST(Exposures, AreFoundInTrainingFolder) {
  const test::TempFolder folder;
  const fs::path ply = folder / "run/point_cloud/iteration_7/point_cloud.ply";
  fs::create_directories(ply.parent_path());
  test::write_text(ply, "a model");
  EXPECT_FALSE(find_exposures(ply));
  test::write_text(folder / "run/exposure.json", "{}");
  EXPECT_EQ(find_exposures(ply), folder / "run/exposure.json");
  EXPECT_EQ(find_exposures(folder / "run"), folder / "run/exposure.json");
}

}  // namespace
}  // namespace binosplat
