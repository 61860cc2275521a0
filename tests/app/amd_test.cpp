// Tests Mesa's driver for AMD without an AMD GPU. Its drm-shim makes the driver compile for a GPU that a
// variable names, and execute nothing. So pictures are black and all numbers read back are 0. The tests check
// that every program compiles without messages from OpenGL.

#include <fmt/format.h>

#include <algorithm>

#include "app/scene.h"
#include "shared/choices.h"
#include "support/scaffold_files.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

/// One GPU of each generation with a different compiler, by its name in Mesa's shim.
constexpr const char* amd_names[] = {"navi31", "navi21", "navi10", "vega10", "polaris10", "gfx1150"};

/// Returns the shim's path on Debian, or an empty path if it is not installed.
fs::path amd_shim() {
  const char* const name = "libamdgpu_noop_drm_shim.so";
  for (const fs::path libraries : {"/usr/lib", "/usr/lib64", "/usr/local/lib"}) {
    std::error_code none;
    if (fs::exists(libraries / name, none)) return libraries / name;
    for (const auto& entry : fs::directory_iterator(libraries, none))
      if (fs::exists(entry.path() / name, none)) return entry.path() / name;
  }
  return {};
}

/// Mesa's EGL as Debian installs it. Without this, another driver's EGL may come first.
constexpr const char* amd_egl = "/usr/share/glvnd/egl_vendor.d/50_mesa.json";

/// A command line, and its exit code if nothing is drawn: 1 if a black picture misses a bound.
struct AmdRun {
  const char* line;
  int code = 0;
};

/// Returns the kinds of drawing of `render`, for the models and cameras of AmdTest.
Words amd_drawings() {
  Words all = {
      "",
      "--mono --antialias",
      "--order distance",
      "--precision half",
      "--precision half --projection tangent",
      "--precision half --tiles snug",
      ("--frames 3 --threshold squared --tolerance 0.1 --transmittance last --projection tangent "
       "--precision half"),
      "--frames 5 --quality 40",
      "--frames 5 --quality 40 --threshold adagscale --transmittance depth",
      "--frames 5 --quality 40 --transmittance last",
      "--frames 5 --quality 40 --projection tangent --precision half",
      "--foveate inset=20deg,context=0.4",
      ("--foveate inset=20deg,context=0.4 --threshold squared --tolerance 0.1 --transmittance last "
       "--precision half"),
      "--foveate inset=20deg,context=0.4 --projection tangent --order distance",
      "--show alphas --projection tangent --threshold squared --tolerance 0.1",
      "--exr float --exr-depth mean --background none",
      "--exr half --exr-depth median --projection tangent",
      "--vr180 --size 64x64",
      "--reference-until order",
  };
  for (const auto& tiles : tiles_choices) {
    for (const char* more :
         {"", "--projection tangent --order distance", "--frames 3 --threshold squared --tolerance 0.1"})
      all.push_back(fmt::format("--tiles {} {}", tiles.name, more));
  }
  for (const auto& threshold : threshold_choices) {
    if (&threshold == &threshold_choices[THRESHOLD_EXACT]) continue;  // exact
    for (const auto& from : transmittance_choices)
      all.push_back(fmt::format("--frames 3 --tolerance 0.1 --threshold {} --transmittance {}",
                                threshold.name, from.name));
  }
  for (const auto& view : show_choices) {
    for (const char* more : {"", "--threshold squared --tolerance 0.1"})
      all.push_back(fmt::format("--show {} {}", view.name, more));
  }
  return all;
}

constexpr AmdRun amd_runs[] = {
    {"render trained -o out.png"},
    {"render trained -o out.png --appearance 2"},
    {"render trained -o out.png --precision half --projection tangent --mono"},
    {"render trained -o out.png --frames 3 --threshold squared --tolerance 0.1 --transmittance last"},
    {"levels model.ply -o levels --chunk 64 --levels 3"},
    {"render levels -o out.png --detail 2"},
    {"render levels -o out.png --detail 40dB"},
    {"render levels -o out.png --gpu-memory 30 --precision half"},
    {"calibrate model.ply --quality 40 --views 2 -o calibration.json"},
    {"render model.ply --calibration calibration.json -o out.png"},
    {"trim model.ply --quality 40 --views 1 -o trimmed.ply"},
    {"refit model.ply --against exact --projection tangent --views 1 --rounds 1 -o fitted.ply", 1},
    {"bench model.ply --motion still --frames 2 --rule squared,one --size 36x24 -o motion"},
    {"bench model.ply --suite axes.json -o bench", 1},
};

// Programs that this driver never receives: those for subgroups of 32 invocations, which AMD lacks in OpenGL,
// llvmpipe's blend, and those of windows and headsets.
constexpr const char* amd_never[] = {"blend_software.comp", "blend_subgroups.comp", "marks.frag",
                                     "marks.vert",          "marks_behind.comp",    "present.comp",
                                     "present_depth.frag",  "subgroups_check.comp", "fullscreen.vert"};

struct AmdTest : SceneTest, testing::WithParamInterface<const char*> {
  void SetUp() override {
    if (!test::switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "some minutes: set BINOSPLAT_LONG=1";
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "the shim stands before system calls, as AddressSanitizer does";
#endif
    if (amd_shim().empty())
      GTEST_SKIP() << "no libamdgpu_noop_drm_shim.so: on Debian 13, apt install mesa-drm-shim";
    add_cameras();
    fs::create_directories(folder / "trained");
    test::write_scaffold(folder / "trained", test::random_scaffold(1, {.anchors = 100, .appearances = 3}));
    fs::copy(folder / "cameras.json", folder / "trained/cameras.json");
    write_text(folder / "axes.json",
               R"({"views": 1, "frames": 1, "repeats": 1, "eyes": [2], "sizes": ["36x24"], "settings": [
        {"tiles": ["aabb", "obb", "snug", "ellipse"], "precision": ["full", "half"]},
        {"threshold": ["adagscale", "squared"], "transmittance": ["one", "last"],
         "precision": ["full", "half"], "tolerance": 0.1}]})");
    write_text(folder / "one.json",
               R"({"views": 1, "frames": 1, "repeats": 1, "eyes": [2], "settings": [{}]})");
  }

  /// Runs a program on this AMD GPU. Compiled programs are cached below `cache`, which is new: Mesa and its
  /// compiler for the GPU compile each program once.
  Outcome run(const Words& arguments, const fs::path& program = BINOSPLAT_PROGRAM) const {
    return run_program(arguments, {.folder = folder.path(),
                                   .variables = {{"LD_PRELOAD", amd_shim().string()},
                                                 {"AMDGPU_GPU_ID", GetParam()},
                                                 {"__EGL_VENDOR_LIBRARY_FILENAMES", amd_egl},
                                                 {"MESA_SHADER_CACHE_DISABLE", "false"},
                                                 {"MESA_SHADER_CACHE_DIR", folder / "cache"},
                                                 {"XDG_CACHE_HOME", folder / "cache"}},
                                   .program = program});
  }

  Outcome run(const std::string& line) const {
    std::istringstream in(line);
    Words words;
    for (std::string word; in >> word;) words.push_back(word);
    return run(words);
  }

  /// Returns what is wrong with a run, or "" if it ended as expected. On standard error, lines of the program
  /// begin with its name, and lines of the shim name an unsupported ioctl; all others are from the driver's
  /// compiler.
  static std::string failure_of(const Outcome& outcome, int code) {
    const std::string said = outcome.out + outcome.err;
    std::string wrong;
    if (outcome.code != code)
      wrong += fmt::format("exit code {}, expected {}: {}", outcome.code, code, outcome.err);
    if (said.find(fmt::format("(radeonsi, {},", GetParam())) == std::string::npos)
      wrong += fmt::format("not drawn by the driver for {}\n", GetParam());
    std::string lines = outcome.err;
    std::replace(lines.begin(), lines.end(), '\r', '\n');  // progress lines
    std::istringstream in(lines);
    for (std::string line; std::getline(in, line);) {
      const bool own = line.starts_with("binosplat: ") && line.find("OpenGL:") == std::string::npos;
      if (!own && !line.empty() && !line.starts_with("DRM_IOCTL_")) wrong += line + "\n";
    }
    return wrong;
  }

  void expect_devices_list_gpu() const {
    EXPECT_EQ(failure_of(run("devices --json devices.json"), 0), "");
    const auto list = json::parse(read_text(folder / "devices.json"));
    const auto& device = list.at(0);
    EXPECT_EQ(device.at("options"), "--backend device --device 0");
    EXPECT_TRUE(has(device.at("renderer").get<std::string>(), "AMD")) << device;
    EXPECT_FALSE(device.at("software").get<bool>());
    EXPECT_GT(device.at("limits").at("program_binaries").get<int>(), 0);
    // This driver's subgroups are not used for drawing.
    EXPECT_FALSE(device.at("limits").at("subgroups").get<bool>());
    EXPECT_EQ(device.at("limits").at("why_no_subgroups"), "its subgroups have 64 invocations");
    EXPECT_TRUE(has(device.at("lacks").dump(), "64 invocations")) << device;
  }

  /// Returns a shader's longest sequence of lines without #include, which a program's source contains
  /// unchanged.
  static std::string longest_part(const std::string& shader) {
    std::istringstream in(shader);
    std::string longest, part;
    for (std::string line; std::getline(in, line);) {
      part = line.starts_with("#include") ? "" : part + line + "\n";
      if (part.size() > longest.size()) longest = part;
    }
    return longest;
  }

  /// Returns the programs of shaders/ that no run compiled. The cache stores each program with its complete
  /// source.
  Words never_compiled() const {
    Words kept, missing;
    for (const auto& entry : fs::recursive_directory_iterator(folder / "cache/binosplat"))
      if (entry.is_regular_file()) kept.push_back(read_text(entry.path()));
    const fs::path shaders = fs::path(BINOSPLAT_SOURCE_DIR) / "shaders";
    for (const auto& entry : fs::recursive_directory_iterator(shaders)) {
      if (entry.path().extension() != ".comp" && entry.path().extension() != ".frag") continue;
      const std::string part = longest_part(read_text(entry.path()));
      const bool found = std::any_of(kept.begin(), kept.end(), [&](const std::string& binary) {
        return binary.find(part) != std::string::npos;
      });
      if (!found) missing.push_back(entry.path().lexically_relative(shaders).generic_string());
    }
    std::sort(missing.begin(), missing.end());
    return missing;
  }
};

TEST_P(AmdTest, EveryModeCompiles) {
  expect_devices_list_gpu();
  for (const std::string& more : amd_drawings()) {
    const std::string size = more.find("--size") == std::string::npos ? " --size 48x32 " : " ";
    EXPECT_EQ(failure_of(run("render model.ply --backend device -o out.png" + size + more), 0), "") << more;
  }
  for (const AmdRun& one : amd_runs) EXPECT_EQ(failure_of(run(one.line), one.code), "") << one.line;
  EXPECT_EQ(never_compiled(), Words(std::begin(amd_never), std::end(amd_never)));
}

INSTANTIATE_TEST_SUITE_P(Names, AmdTest, testing::ValuesIn(amd_names),
                         [](const auto& one) { return std::string(one.param); });

struct AmdFault : AmdTest {};

TEST_P(AmdFault, IsDetected) {
  const std::string good = fmt::format("binosplat: drawing with AMD (radeonsi, {}, LLVM)\n", GetParam());
  EXPECT_EQ(failure_of({.err = good}, 0), "");
  EXPECT_NE(failure_of({.code = 3, .err = good}, 0), "");
  EXPECT_NE(failure_of({.err = "binosplat: drawing with llvmpipe\n"}, 0), "");
  EXPECT_NE(failure_of({.err = good + "binosplat: warning: OpenGL: GL_INVALID_VALUE\n"}, 0), "");
  EXPECT_NE(failure_of({.err = good + "radeonsi: can't compile a main shader part\n"}, 0), "");

  fs::copy(fs::path(BINOSPLAT_SOURCE_DIR) / "shaders", folder / "shaders", fs::copy_options::recursive);
  const char* const line = "render model.ply --backend device -o out.png --shader-dir shaders";
  ASSERT_EQ(failure_of(run(line), 0), "");
  // A program that is compiled only without subgroups of 32.
  const char* const name = "project_compact_count.comp";
  write_text(folder / "shaders" / name, read_text(folder / "shaders" / name) + "float injected = missing;\n");
  const std::string found = failure_of(run(line), 0);
  EXPECT_TRUE(has(found, std::string("shader ") + name + " failed to compile"));
  fs::remove_all(folder / "cache");
  EXPECT_FALSE(run(line).code == 0 || never_compiled().size() < 20) << "programs never compiled go unnoticed";
}

INSTANTIATE_TEST_SUITE_P(Names, AmdFault, testing::Values("navi31"));

}  // namespace
}  // namespace binosplat
