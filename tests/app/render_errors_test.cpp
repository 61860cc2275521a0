// binosplat render where a file, a disk or a device is wrong: the message, the exit code, and nothing left
// behind.

#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "app/scene.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::has;
using test::Outcome;
using test::PlyFile;
using test::write_text;

struct RenderErrors : test::SceneTest {
  RenderErrors() { add_cameras(); }

  /// Runs, and expects the code, the message, and the files that were there before.
  void expect(const std::string& said, const test::Words& words = {}, int code = 2,
              const test::Surroundings& surroundings = {}) {
    const auto before = folder.files();
    EXPECT_TRUE(ended(render(words, surroundings), code, said));
    EXPECT_EQ(folder.files(), before);
  }
};

// Each reader's own tests have the rest.
TEST_F(RenderErrors, TheModel) {
  const std::string bytes = to_bytes(test::small_model());
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
  std::filesystem::remove(model);
  expect("No such file");
}

TEST_F(RenderErrors, GaussiansThatCannotBeDrawnAreCounted) {
  PlyFile file = test::small_model();
  file.at(7, "scale_1") = std::nan("");
  file.at(8, "x") = INFINITY;
  for (const char* name : {"rot_0", "rot_1", "rot_2", "rot_3"}) file.at(9, name) = 0.0;
  write_text(model, to_bytes(file));
  EXPECT_TRUE(ended(render({"--json", folder / "r.json"}), 0, "3 of 300 Gaussians left out"));
  const auto scene = test::load_json(folder / "r.json")["scene"];
  EXPECT_EQ(scene["left_out"], 3);
  EXPECT_EQ(scene["gaussians"], 297);
  EXPECT_TRUE(has(test::run_program({"info", model}).out, "297 (3 more left out"));
}

TEST_F(RenderErrors, Cameras) {
  const test::Words named = {"--cameras", folder / "cameras.json"};
  nlohmann::json cameras = {test::camera_json("front", 0.0)};
  cameras[0]["fx"] = 0.0;
  write_text(folder / "cameras.json", cameras.dump());
  expect("camera 0 (counted from 0), key 'fx': expected a number above 0", named);
  write_text(folder / "cameras.json", "[{]");
  expect("is not valid JSON at line 1", named);
  cameras.clear();
  for (int i = 0; i < 20; ++i) cameras.push_back(test::camera_json("view" + std::to_string(i), 0.0));
  write_text(folder / "cameras.json", cameras.dump());
  expect("view7\n  and 12 more", {"--view", "x"});
  for (const std::string& bad : {std::string("a\x1b[31m"), std::string("a\0b", 3), std::string("a\nb")}) {
    write_text(folder / "cameras.json", nlohmann::json({test::camera_json(bad, 0.0)}).dump());
    const Outcome outcome = render(named);
    EXPECT_TRUE(ended(outcome, 2, "has a control character"));
    EXPECT_EQ(outcome.err.find('\x1b'), std::string::npos);
    EXPECT_EQ(outcome.err.find('\0'), std::string::npos);
  }
}

TEST_F(RenderErrors, AFullDisk) {
  test::Surroundings small;
  small.limits[RLIMIT_FSIZE] = 3000;
  expect("cannot write " + out + "/front_left.png: File too large", {}, 2, small);
  expect("a.exr", {"-o", folder / "a.exr"}, 2, small);
}

TEST_F(RenderErrors, NoUsableOpenGl) {
  test::Surroundings bare;
  bare.variables["__EGL_VENDOR_LIBRARY_FILENAMES"] = "/no/such/vendor.json";
  write_text(folder / "libOSMesa.so.8", "no library");
  bare.variables["LD_LIBRARY_PATH"] = folder.path().string();
  expect("no usable OpenGL", {}, 3, bare);
  expect("apt install libosmesa6", {"--backend", "osmesa"}, 3, bare);
}

TEST_F(RenderErrors, InterruptsAndHangupsLeaveNoHalfFile) {
  const auto before = folder.files();
  for (const int signal : {SIGINT, SIGHUP}) {
    test::Program program({"render", model, "-o", out, "--frames", "100000"});
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (program.said().find("drawing with") == std::string::npos && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    program.send(signal);
    EXPECT_EQ(program.wait().code, -signal);
    EXPECT_EQ(folder.files(), before);
  }
}

}  // namespace
}  // namespace binosplat
