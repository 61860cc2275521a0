// binosplat render with errors in a file, a disk or a device: checks the message and the exit code, and that
// no files remain.

#include "app/scene.h"

namespace binosplat {
namespace {

struct RenderErrors : SceneTest {
  RenderErrors() { add_cameras(); }

  /// Runs the command, and expects the message and unchanged files.
  void expect(const std::string& said, const Words& words = {}) const { expect_refused({{words, said}}); }
};

// The tests of each reader have the other errors.
TEST_F(RenderErrors, ModelFaultsAreNamed) {
  const std::string bytes = to_bytes(small_model());
  const std::pair<std::string, const char*> cases[] = {
      {bytes.substr(0, bytes.size() - 700), "cut short"},
      {"version https://git-lfs.github.com/spec/v1\n", "git lfs pull"},
      {"", "empty"},
      {"hello", "model.ply"},
  };
  for (const auto& [content, said] : cases) {
    write_text(model, content);
    expect(said);
  }
  fs::remove(model);
  expect("No such file");
}

TEST_F(RenderErrors, InvalidGaussiansAreCounted) {
  PlyFile file = small_model();
  file.at(7, "scale_1") = std::nan("");
  file.at(8, "x") = INFINITY;
  for (const char* name : {"rot_0", "rot_1", "rot_2", "rot_3"}) file.at(9, name) = 0.0;
  write_text(model, to_bytes(file));
  EXPECT_TRUE(ended(render({"--json", folder / "r.json"}), 0, "3 of 300 Gaussians left out"));
  const auto scene = load_json(folder / "r.json")["scene"];
  EXPECT_EQ(scene["left_out"], 3);
  EXPECT_EQ(scene["gaussians"], 297);
  EXPECT_TRUE(has(run_program({"info", model}).out, "297 (3 more left out"));
}

TEST_F(RenderErrors, CameraFaultsAreNamed) {
  const Words named = {"--cameras", folder / "cameras.json"};
  json cameras;
  for (int i = 0; i < 20; ++i) cameras.push_back(camera_json("view" + std::to_string(i), 0.0));
  save("cameras.json", cameras);
  expect("view7\n  and 12 more", {"--view", "x"});
  for (const std::string& bad : {std::string("a\x1b[31m"), std::string("a\0b", 3), std::string("a\nb")}) {
    save("cameras.json", json({camera_json(bad, 0.0)}));
    const Outcome outcome = render(named);
    EXPECT_TRUE(ended(outcome, 2, "has a control character"));
    EXPECT_EQ(outcome.err.find_first_of(std::string("\x1b\0", 2)), std::string::npos);
  }
}

}  // namespace
}  // namespace binosplat
