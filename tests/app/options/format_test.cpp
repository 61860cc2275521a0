// --format: reads a file as the named format, whatever its content seems to be.

#include "app/scene.h"

namespace binosplat {
namespace {

struct FormatOption : SceneTest {
  /// A .splat under another name. Its quaternions of 255, 255, 255, 255 do not tell it from other data.
  FormatOption() {
    std::string bytes;
    for (int i = 0; i < 40; ++i) {
      for (const double x : {0.05 * i - 1.0, 0.0, 4.0, 0.1, 0.1, 0.1})
        test::append_bytes(bytes, static_cast<float>(x), false);
      bytes += "\xff\x80\x40\xff\xff\xff\xff\xff";
    }
    write_text(unmarked, bytes);
    add_cameras();
  }

  const std::string unmarked = folder / "scan.bin";
};

TEST_F(FormatOption, ForcesReader) {
  const std::string to = folder / "to.ply";
  for (const Words& line :
       {Words{"render", unmarked, "--view", "front", "-o", folder / "a.png"},
        {"info", unmarked, "--json", folder / "i.json"},
        {"convert", unmarked, "-o", to},
        {"levels", unmarked, "--chunk", "64", "--levels", "2", "-o", folder / "levels"}}) {
    EXPECT_TRUE(ended(run_program(line), 2, "is not a model that can be read")) << line[0];
    EXPECT_TRUE(good(run_program(joined(line, {"--format", ".splat"})))) << line[0];
  }
  EXPECT_EQ(load_json(folder / "i.json").at("gaussians"), 40);
  for (const char* command : {"trim", "refit", "calibrate", "bench", "profile", "view"})
    EXPECT_TRUE(has(checked(run_program({command, "--help"})).out, "--format NAME")) << command;
}

TEST_F(FormatOption, ReportsErrorsOfNamedReader) {
  expect_refused({{{"--format", "SPZ"}, model + " is not an spz model"},
                  {{"--format", "gltf"}, model + " is not valid JSON"},
                  {{"--format", "splat"}, "format splat: expected Scaffold-GS, compressed ply"}});
  expect_refused_after({"render"}, {{{"demo:room", "--format", "ply"}, "--format is for model files"}});
}

// Pictures of an independent float64 renderer, for glTF files that were once refused or drawn wrong.
TEST(GltfPictures, MatchIndependentRenderer) {
  REQUIRE_FIXTURES(fixtures);
  const fs::path field = fixtures.parent_path() / "broken/field";
  if (!fs::is_directory(field)) GTEST_SKIP() << field << " is not there";
  const std::pair<const char*, const char*> models[] = {
      {"gltf-extensions/hidden", "m.glb"},
      {"gltf-extensions/instancing", "m.glb"},
      {"gltf-accessor-without-view/zeros", "m.glb"},
      {"gltf-turned-harmonics/rx90_4", "m.glb"},
      {"gltf-turned-harmonics/trs_4", "m.glb"},
      {"gltf-uri/space", "m.gltf"},
      {"gltf-uri/umlaut", "m.gltf"},
  };
  const TempFolder folder;
  for (const auto& [name, file] : models) {
    const fs::path of = field / name;
    ASSERT_TRUE(good(run_program(
        {"render", of / file, "--cameras", of / "cameras.json", "--mono", "-o", folder / "p.png"})))
        << name;
    EXPECT_GE(psnr_of_files(of / "expected.png", folder / "p.png"), 60.0) << name;
  }
  const fs::path unknown = field / "gltf-extensions/required_unknown";
  EXPECT_TRUE(ended(run_program({"render", unknown / "m.glb", "--mono", "-o", folder / "p.png"}), 2,
                    "'VENDOR_unknown'"));
  // Injected fault: the picture of another file.
  EXPECT_LT(psnr_of_files(field / models[0].first / "expected.png", field / models[1].first / "expected.png"),
            40.0);
}

}  // namespace
}  // namespace binosplat
