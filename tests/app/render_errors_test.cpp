// binosplat render where something is wrong: the message, the exit code, and nothing left behind.

#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

#include "app/scene.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::Outcome;
using test::PlyFile;
using test::write_text;

struct RenderErrors : test::SceneTest {
  RenderErrors() { add_cameras(); }

  /// Runs, and expects the code, the message, and the files that were there before.
  void expect(const std::vector<std::string>& arguments, const std::string& said, int code = 2,
              const test::Surroundings& surroundings = {}) {
    const auto before = folder.files();
    EXPECT_TRUE(ended(render(arguments, surroundings), code, said));
    EXPECT_EQ(folder.files(), before);
  }
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST_F(RenderErrors, TheModel) {
  const PlyFile file = test::small_model();
  const std::string bytes = to_bytes(file);
  const struct {
    std::string content;
    const char* said;
  } cases[] = {
      {bytes.substr(0, bytes.size() - 700), "cut short"},
      {replaced(bytes, "property float opacity", "property list uchar float opacity"), "opacity"},
      {replaced(bytes, "property float x", "property real x"), "'real' is no type"},
      {replaced(bytes, "property float opacity", "property float other"), "has no property 'opacity'"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
       "z\nend_header\n1 2 3\n",
       "point"},
      {replaced(bytes, "element vertex 300", "element vertex 0"), "holds no Gaussians"},
      {"version https://git-lfs.github.com/spec/v1\n", "git lfs pull"},
      {"", "empty"},
      {"hello", "model.ply"},
  };
  for (const auto& c : cases) {
    write_text(model, c.content);
    expect({"-o", out}, c.said);
  }
  std::filesystem::remove(model);
  expect({"-o", out}, "No such file");
}

TEST_F(RenderErrors, GaussiansThatCannotBeDrawnAreCounted) {
  PlyFile file = test::small_model();
  file.at(7, "scale_1") = std::nan("");
  file.at(8, "x") = INFINITY;
  for (const char* name : {"rot_0", "rot_1", "rot_2", "rot_3"}) file.at(9, name) = 0.0;
  write_text(model, to_bytes(file));
  const Outcome outcome = render({"-o", out, "--json", folder / "r.json"});
  ASSERT_TRUE(good(outcome));
  EXPECT_NE(outcome.err.find("3 of 300 Gaussians left out"), std::string::npos) << outcome.err;
  const auto json = nlohmann::json::parse(test::read_text(folder / "r.json"));
  EXPECT_EQ(json["scene"]["left_out"], 3);
  EXPECT_EQ(json["scene"]["gaussians"], 297);
}

TEST_F(RenderErrors, Cameras) {
  nlohmann::json flat = {test::camera_json("front", 0.0)};
  flat[0]["fx"] = 0.0;
  write_text(folder / "cameras.json", flat.dump());
  expect({"-o", out}, "camera 0 (counted from 0), key 'fx': expected a focal length above 0");
  write_text(folder / "cameras.json", "[{]");
  expect({"-o", out}, "is not valid JSON at line 1");
  expect({"-o", out, "--cameras", folder / "no.json"}, "no.json");
  std::filesystem::remove(folder / "cameras.json");
  expect({"-o", out, "--view", "front"}, "no cameras beside");
}

TEST_F(RenderErrors, Views) {
  expect({"-o", out, "--view", "frnt"}, "has no camera of this name. It has:\n  front\n  side\n");
  expect({"-o", out, "--view", "pair", "--mono"}, "pair_left or pair_right");
  expect({"-o", out, "--view", "pair", "--ipd", "0.06"}, "is a pair of eyes that the cameras give");
  expect({"-o", out, "--view", "pair", "--preset", "headset"}, "use --size");
  expect({"-o", folder / "a.png", "--view", "all"}, "name a folder");
  nlohmann::json many;
  for (int i = 0; i < 20; ++i) many.push_back(test::camera_json("view" + std::to_string(i), 0.0));
  write_text(folder / "cameras.json", many.dump());
  expect({"-o", out, "--view", "x"}, "view7\n  and 12 more");
}

TEST_F(RenderErrors, OptionsThatContradict) {
  expect({"-o", out, "--eye", "0,0,0"}, "--eye and --at go together");
  expect({"-o", out, "--eye", "0,0,0", "--at", "0,0,0"}, "must look at another point");
  expect({"-o", out, "--eye", "0,0,0", "--at", "0,0,1", "--view", "front"}, "leave --cameras and --view out");
  expect({"-o", out, "--orbit", "3", "--eye", "0,0,0", "--at", "0,0,1"}, "choose one");
  expect({"-o", out, "--up", "0,0,1"}, "--up and --fov are for cameras that are made up");
  expect({"-o", out, "--mono", "--only", "left"}, "choose one");
  expect({"-o", out, "--mono", "--cant", "1"}, "--mono has no rig");
  expect({"-o", out, "--cant", "1", "--convergence", "2"}, "--convergence 2 with --cant 1");
  expect({"-o", out, "--photos", folder.path()}, "--photos needs --mono");
  expect({"-o", out, "--photos", folder.path(), "--mono"}, "no photo of any view");
  expect({"-o", folder / "a.exr", "--bits", "16"}, "--bits is for PNG");
  expect({"-o", out, "--exr-encoding", "display"}, "--exr-encoding is for OpenEXR");
  expect({"-o", out, "--device", "0", "--backend", "surfaceless"}, "surfaceless has none");
  expect({"-o", out, "--device", "0", "--backend", "osmesa"}, "osmesa has none");
}

TEST_F(RenderErrors, ValuesThatAreNone) {
  const struct {
    std::vector<std::string> arguments;
    const char* said;
  } cases[] = {
      {{"--size", "0x10"}, "WIDTHxHEIGHT"},
      {{"--size", "10"}, "WIDTHxHEIGHT"},
      {{"--size", "99999999999x2"}, "WIDTHxHEIGHT"},
      {{"--size", "2000000000x2000000000", "--mono"}, "2^31 pixels"},
      {{"--eye", "1,2", "--at", "0,0,0"}, "three numbers"},
      {{"--eye", "1,2,nan", "--at", "0,0,0"}, "three numbers"},
      {{"--background", "2,0,0"}, "from 0 to 1, or none"},
      {{"--background", "blue"}, "three numbers"},
      {{"--near", "nan"}, "above zero"},
      {{"--near", "0"}, "above zero"},
      {{"--fov", "200", "--orbit", "1"}, "between 0 and 180"},
      {{"--ipd", "-1"}, "--ipd -1"},
      {{"--units-per-metre", "0"}, "above zero"},
      {{"--tiles", "round"}, "see: binosplat render --help"},
      {{"--tile", "12"}, "see: binosplat render --help"},
      {{"--frames", "0"}, "see: binosplat render --help"},
      {{"--no-such-option"}, "see: binosplat render --help"},
      {{"-o", "a.jpg"}, "written as .png or .exr"},
      {{"--shader-dir", "/no/such/folder"}, "/no/such/folder"},
      {{"--reference-until", "lunch"}, "see: binosplat render --help"},
  };
  for (const auto& c : cases) {
    std::vector<std::string> arguments = c.arguments;
    if (arguments[0] != "-o") arguments.insert(arguments.end(), {"-o", out});
    expect(arguments, c.said);
  }
}

TEST_F(RenderErrors, Outputs) {
  write_text(folder / "file", "in the way");
  std::filesystem::create_directories(folder / "taken.png");
  expect({"-o", folder / "file"}, "is a file where a folder is needed");
  expect({"-o", folder / "file/deep/out"}, "is a file where a folder is needed");
  expect({"-o", folder / "file/a.png"}, "is a file where a folder is needed");
  expect({"-o", folder / "taken.png"}, "it is a folder");
  expect({"-o", out, "--json", folder / "file/r.json"}, "is a file where a folder is needed");
  expect({"-o", "/proc/nowhere"}, "cannot write /proc/nowhere");
}

TEST_F(RenderErrors, AFullDisk) {
  test::Surroundings small;
  small.limits[RLIMIT_FSIZE] = 3000;
  expect({"-o", out}, "cannot write " + out + "/front_left.png: File too large", 2, small);
  expect({"-o", folder / "a.exr"}, "a.exr", 2, small);
}

TEST_F(RenderErrors, NoUsableOpenGl) {
  test::Surroundings bare;
  bare.variables["__EGL_VENDOR_LIBRARY_FILENAMES"] = "/no/such/vendor.json";
  test::write_text(folder / "libOSMesa.so.8", "no library");
  bare.variables["LD_LIBRARY_PATH"] = folder.path().string();
  expect({"-o", out}, "no usable OpenGL", 3, bare);
  expect({"-o", out, "--backend", "osmesa"}, "apt install libosmesa6", 3, bare);
}

TEST_F(RenderErrors, AnInterruptLeavesNoHalfFile) {
  const auto before = folder.files();
  test::Program program({"render", model, "-o", out, "--frames", "100000"});
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (program.said().find("drawing with") == std::string::npos && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  program.send(SIGINT);
  EXPECT_EQ(program.wait().code, -SIGINT);
  EXPECT_EQ(folder.files(), before);
}

}  // namespace
}  // namespace binosplat
