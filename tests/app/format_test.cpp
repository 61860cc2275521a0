// --format: reads a file as the named format, whatever its content seems to be.

#include "app/scene.h"

namespace binosplat {
namespace {

struct Format : SceneTest {
  /// A .splat under another name. Its quaternions of 255, 255, 255, 255 do not tell it from other data.
  Format() {
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

TEST_F(Format, OptionForcesReader) {
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
    EXPECT_TRUE(has(well(run_program({command, "--help"})).out, "--format NAME")) << command;
}

TEST_F(Format, ErrorsAreTheNamedReaders) {
  expect_refused({{{"--format", "SPZ"}, model + " is not an spz model"},
                  {{"--format", "gltf"}, model + " is not valid JSON"},
                  {{"--format", "splat"}, "format splat: expected Scaffold-GS, compressed ply"}});
  expect_refused_after({"render"}, {{{"demo:room", "--format", "ply"}, "--format is for model files"}});
}

}  // namespace
}  // namespace binosplat
