// The results of cmake --install and cpack: libraries that another program can find, link and draw with.

#include <algorithm>
#include <cmath>
#include <regex>
#include <span>
#include <sstream>

#include "app/scene.h"
#include "formats/models/model_file.h"
#include "render/frame.h"
#include "stereo/eyes.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr const char* sanitize = "-fsanitize=address,undefined";
#else
constexpr const char* sanitize = "";
#endif
constexpr const char* leaks = "ASAN_OPTIONS=detect_leaks=0 ";  // for leaks in drivers

/// Folders to install into and to build another program in.
struct Install : testing::Test {
  const TempFolder folder;
  const std::string prefix = folder / "prefix", build = folder / "build",
                    documents = prefix + "/share/doc/binosplat", model = folder / "model.ply";

  /// Whether a shell command succeeds. The failure shows its output.
  testing::AssertionResult succeeds(const std::string& command) const {
    const fs::path said = folder / "said";
    const int code = std::system((command + " > " + said.string() + " 2>&1").c_str());
    if (code == 0) return testing::AssertionSuccess();
    return testing::AssertionFailure() << command << ": " << code << "\n" << read_text(said);
  }
  testing::AssertionResult is_installed(const std::string& to) const {
    return succeeds(std::string("cmake --install ") + BINOSPLAT_BUILD_DIR + " --prefix " + to);
  }
  /// Whether the program in `source` builds with the installed files.
  testing::AssertionResult is_built(const std::string& source) const {
    return succeeds("cmake -G Ninja -S " + source + " -B " + build + " -DCMAKE_PREFIX_PATH=" + prefix +
                    " -DCMAKE_CXX_COMPILER=" + BINOSPLAT_CXX + " -DCMAKE_CXX_FLAGS='" + BINOSPLAT_CXX_FLAGS +
                    " " + sanitize + "' && cmake --build " + build);
  }

  void check_mesh_example(const std::string& source) const;
  Words faults_of_headers(const fs::path& include, std::size_t by) const;
};

/// Returns both eyes as examples/embed.cpp draws them, or with swapped lenses.
std::vector<Image> expected_eyes(const fs::path& file, bool swapped = false) {
  const auto context = gl::Context::open(gl::Backend::surfaceless);
  const auto model = std::make_shared<const Model>(load_model(file));
  std::array<Fov, 2> fov = {Fov{-0.855, 0.646, 0.7, -0.7}, Fov{-0.646, 0.855, 0.7, -0.7}};
  if (swapped) std::swap(fov[0], fov[1]);
  const std::array<Eye, 2> eyes = {Eye{.position = {-0.0315, 1.6, 0}, .fov = fov[0]},
                                   Eye{.position = {0.0315, 1.6, 0}, .fov = fov[1]}};
  const Placement placement = SplatModel(model).framing({-0.855, 0.646, 0.7, -0.7}, {0.0, 1.6, 0.0});
  render::Frame frame(*context, *model);
  frame.draw(stereo::views_from_xr(eyes, placement, std::array{glm::ivec2(320, 300), glm::ivec2(320, 300)}));
  std::vector<Image> images;
  for (const Picture& picture : frame.read_pictures()) images.push_back(composite(picture, glm::vec3(0.0f)));
  return images;
}

/// Writes two walls of small opaque Gaussians across the view's axis, z: a green one that ends at x = 0, and
/// a blue one far behind it.
void write_walls(const fs::path& path) {
  const auto count = [](double high, double low, double step) {
    return std::lround((high - low) / step) + 1;
  };
  struct Wall {
    double left, right, half_height, z, step;
    glm::dvec3 colour;
  };
  PlyFile file = test::inria_file(0, 1);
  const std::vector<double> empty(file.columns.size(), 0.0);
  file.rows.clear();
  for (const Wall& wall :
       {Wall{-0.8, 0.0, 0.8, 2.5, 0.04, {0, 1, 0}}, Wall{-2.0, 2.0, 2.0, 6.0, 0.1, {0, 0, 1}}}) {
    const auto columns = count(wall.right, wall.left, wall.step),
               rows = count(wall.half_height, -wall.half_height, wall.step);
    for (std::int64_t at = 0; at < columns * rows; ++at) {
      const std::int64_t nth = at / columns;
      const std::size_t row = file.rows.size();
      file.rows.push_back(empty);
      file.at(row, "x") = wall.left + wall.step * static_cast<double>(at % columns);
      file.at(row, "y") = -wall.half_height + wall.step * static_cast<double>(nth);
      file.at(row, "z") = wall.z;
      for (int c = 0; c < 3; ++c) {
        file.at(row, fmt::format("f_dc_{}", c)) = (wall.colour[c] - 0.5) / test::sh_c0;
        file.at(row, fmt::format("scale_{}", c)) = std::log(0.7 * wall.step);
      }
      file.at(row, "opacity") = 10.0;
      file.at(row, "rot_0") = 1.0;
    }
  }
  write_text(path, to_bytes(file));
}

/// Converts linear light to the value in an sRGB texture.
float encoded(double light) { return static_cast<float>(1.055 * std::pow(light, 1.0 / 2.4) - 0.055); }

/// Returns what is wrong with a picture of examples/mesh.cpp. Its cube is 4 units ahead, between the walls.
/// The view's axis passes through the cube at column `axis`.
Words faults_of_mesh(const fs::path& picture, int axis) {
  const Image image = load_image(picture);
  Words faults;
  const auto expect = [&](const char* what, int column, int row, const glm::vec3& colour) {
    const std::size_t at = 3 * (static_cast<std::size_t>(row) * image.width + column);
    const glm::vec3 seen(image.data[at], image.data[at + 1], image.data[at + 2]);
    for (int c = 0; c < 3; ++c) {
      if (!(std::abs(seen[c] - colour[c]) < 0.02f)) {
        faults.push_back(fmt::format("{}: {} {} {}", what, seen.x, seen.y, seen.z));
        return;
      }
    }
  };
  expect("the wall before the cube", axis - 20, 225, {0, 1, 0});
  expect("the cube", axis + 20, 225, {encoded(0.3 * 0.9), encoded(0.3 * 0.25), encoded(0.3 * 0.03)});
  expect("the wall behind the cube", axis + 20, 150, {0, 0, 1});
  expect("what was cleared", axis - 200, 10, glm::vec3(encoded(0.2)));
  return faults;
}

/// Builds and runs examples/mesh.cpp, first as installed, then with an injected fault.
void Install::check_mesh_example(const std::string& source) const {
  write_walls(folder / "walls.ply");
  const std::string run = leaks + build + "/mesh ";
  const std::string drawing = run + (folder / "walls.ply").string() + " " + (folder / "out").string();
  ASSERT_TRUE(succeeds(drawing + " 1 0 0 0 0 0 4"));
  EXPECT_EQ(faults_of_mesh(folder / "out/left.png", 286), Words());
  EXPECT_EQ(faults_of_mesh(folder / "out/right.png", 194), Words());
  ASSERT_TRUE(succeeds(drawing)) << "a place of its own choice";
  EXPECT_FALSE(succeeds(drawing + " 1 2 3"));
  EXPECT_FALSE(succeeds(run + "/no/such.ply " + (folder / "out").string()));

  const std::string call = "renderer.submit(", forgets = "for (auto& view : views) view.mesh_depth.reset();";
  std::string text = read_text(source + "/mesh.cpp");
  ASSERT_NE(text.find(call), std::string::npos);
  write_text(source + "/mesh.cpp", text.insert(text.find(call), forgets));
  ASSERT_TRUE(succeeds("cmake --build " + build + " --target mesh"));
  ASSERT_TRUE(succeeds(drawing + " 1 0 0 0 0 0 4"));
  EXPECT_EQ(faults_of_mesh(folder / "out/left.png", 286).size(), 2u) << "forgotten depths go unnoticed";
}

TEST_F(Install, LibraryDrawsInOtherProgram) {
  write_text(model, to_bytes(small_model()));
  fs::create_directory(folder / "out");
  // The installed folder is moved, because no file in it may depend on its path.
  ASSERT_TRUE(is_installed(folder / "first"));
  fs::rename(folder / "first", prefix);
  for (const auto& [name, text] : contents_of(prefix + "/lib/cmake"))
    EXPECT_EQ(text.find(BINOSPLAT_SOURCE_DIR), std::string::npos) << name;
  ASSERT_TRUE(is_built(documents + "/examples"));
  ASSERT_TRUE(succeeds(leaks + build + "/embed " + model + " " + (folder / "out").string()));
  const auto eyes = expected_eyes(model), others = expected_eyes(model, true);
  for (std::size_t k = 0; k < 2; ++k) {
    const Image drawn = load_image(folder / (k == 0 ? "out/left.png" : "out/right.png"));
    EXPECT_GE(measure::psnr(drawn, quantised(eyes[k])), 39.0) << "AdaGScale's K is for 40 dB";
    EXPECT_GT(measure::largest_difference(drawn, quantised(eyes[k])).max, 0.0) << "it draws exactly";
    EXPECT_GT(measure::largest_difference(drawn, quantised(others[k])).max, 0.1)
        << "swapped lenses go unnoticed";
  }
  EXPECT_FALSE(succeeds(leaks + build + "/embed /no/such.ply /tmp"));
  ASSERT_TRUE(succeeds(leaks + build + "/world " + model + " " + (folder / "out").string() + " 1"));
  check_mesh_example(documents + "/examples");
}

/// Returns the broken links of Markdown files below a folder.
Words dangling(const fs::path& folder) {
  Words out;
  static const std::regex link(R"(\]\(([^)#]+)(#[^)]*)?\))");
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".md") continue;
    const std::string text = read_text(entry.path());
    for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at) {
      const std::string to = (*at)[1];
      if (to.find("://") == std::string::npos && !fs::exists(entry.path().parent_path() / to))
        out.push_back(entry.path().string() + ": " + to);
    }
  }
  return out;
}

/// Returns the lines of C++ in docs/embedding.md that no example contains.
Words lines_without_example(const fs::path& documents) {
  const auto trimmed = [](const std::string& line) {
    const auto begin = line.find_first_not_of(' ');
    return begin == std::string::npos ? "" : line.substr(begin);
  };
  std::set<std::string> known;
  for (const auto& entry : fs::directory_iterator(documents / "examples")) {
    std::istringstream lines(read_text(entry.path()));
    for (std::string line; std::getline(lines, line);) known.insert(trimmed(line));
  }
  Words out;
  bool is_code = false;
  std::istringstream lines(read_text(documents / "docs/embedding.md"));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) {
      is_code = line == "```cpp";
    } else if (is_code && !known.contains(trimmed(line))) {
      out.push_back(line);
    }
  }
  return out;
}

TEST_F(Install, DocumentsMatchExamples) {
  ASSERT_TRUE(is_installed(prefix));
  EXPECT_EQ(lines_without_example(documents), Words());
  EXPECT_EQ(dangling(documents), Words());
  EXPECT_TRUE(has(read_text(prefix + "/share/man/man1/binosplat.1"), ".SH binosplat render"));
  fs::remove(documents + "/examples/mesh.cpp");
  EXPECT_GT(lines_without_example(documents).size(), 10u) << "lines of no example go unnoticed";
  fs::remove(documents + "/docs/measuring.md");
  EXPECT_GE(dangling(documents).size(), 3u) << "a missing file goes unnoticed";
}

/// Returns the compiler of this build, and clang if that is another one and installed. Each uses C++20, and
/// in the long check also the next standard.
const Words& compilers() {
  static const Words found = [] {
    Words commands;
    for (const std::string compiler : {BINOSPLAT_CXX, "clang++"}) {
      if (std::system((compiler + " --version > /dev/null 2>&1").c_str()) != 0) continue;
      commands.push_back(compiler + " -std=c++20");
      if (test::switched_on("BINOSPLAT_LONG")) commands.push_back(compiler + " -std=c++2b");
    }
    return commands;
  }();
  return found;
}

/// Returns what is wrong with installed headers: their number, their includes, their macros, and whether each
/// compiles alone, without this tree, with the first `by` compilers.
Words Install::faults_of_headers(const fs::path& include, std::size_t by) const {
  Words faults;
  const auto headers = contents_of(include);
  std::ptrdiff_t lines = 0;
  for (const auto& [name, text] : headers) {
    lines += std::count(text.begin(), text.end(), '\n');
    // They may include only the standard library, GLM and each other.
    static const std::regex included(R"(#include (<[^>]*>|"[^"]*"))"),
        allowed(R"(<(binosplat/\w+\.h|glm/.*|\w+)>)");
    for (std::sregex_iterator at(text.begin(), text.end(), included), end; at != end; ++at) {
      if (!std::regex_match((*at)[1].str(), allowed)) faults.push_back(name + " includes " + (*at)[1].str());
    }
    static const std::regex macro(R"(# *define +(?!BINOSPLAT_)(\w+))");
    for (std::sregex_iterator at(text.begin(), text.end(), macro), end; at != end; ++at)
      faults.push_back(name + " defines " + (*at)[1].str());
    write_text(folder / "alone.cpp", "#include <" + name + ">\n");
    for (const std::string& compiler : std::span(compilers()).first(by)) {
      const auto compiles = succeeds(compiler + " -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I" +
                                     include.string() + " " + (folder / "alone.cpp").string());
      if (!compiles) faults.push_back(name + " does not compile: " + compiles.message());
    }
  }
  if (headers.size() > 8)
    faults.push_back(std::to_string(headers.size()) + " headers: at most 8 are to be read");
  if (lines > 1500) faults.push_back(std::to_string(lines) + " lines: at most 1,500 are to be read");
  if (headers.empty()) faults.emplace_back("no headers");
  return faults;
}

TEST_F(Install, HeadersAreSelfContained) {
  ASSERT_TRUE(is_installed(prefix));
  EXPECT_EQ(faults_of_headers(prefix + "/include", compilers().size()), Words());
  const auto noticed = [&](const std::string& text, int headers = 1, std::size_t by = 0) {
    const TempFolder injected;
    fs::create_directory(injected / "binosplat");
    for (int k = 0; k < headers; ++k) write_text(injected / ("binosplat/" + std::to_string(k) + ".h"), text);
    return faults_of_headers(injected.path(), by).size();
  };
  EXPECT_EQ(noticed("#pragma once\n#include <vector>\n", 8), 0u);
  EXPECT_EQ(noticed("#pragma once\n", 9), 1u) << "a ninth header goes unnoticed";
  EXPECT_EQ(noticed("#pragma once\nstruct Injected { std::vector<int> numbers; };\n", 1, 1), 1u)
      << "a header that misses an include goes unnoticed";
  EXPECT_EQ(noticed("#pragma once\n#include <fmt/core.h>\n"), 1u) << "another library's goes unnoticed";
  EXPECT_EQ(noticed("#pragma once\n#define INJECTED 1\n#define BINOSPLAT_INJECTED 1\n"), 1u)
      << "a macro of any name goes unnoticed";
  EXPECT_EQ(noticed(std::string(1501, '\n')), 1u) << "many lines go unnoticed";
}

/// Returns the lines that docs/embedding.md has for a program's CMakeLists.txt.
std::string lines_for_cmake() {
  const std::string text = read_text(std::string(BINOSPLAT_SOURCE_DIR) + "/docs/embedding.md");
  const std::size_t begin = text.find("find_package(binosplat");
  return text.substr(begin, text.find("```", begin) - begin);
}

constexpr const char* project = "cmake_minimum_required(VERSION 3.25)\nproject(other LANGUAGES CXX)\n";

TEST_F(Install, TwoCMakeLinesSuffice) {
  ASSERT_TRUE(is_installed(prefix));
  const std::string lines = lines_for_cmake(), program = folder / "program";
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2) << lines;
  fs::create_directory(program);
  // The project sets no C++ standard, so it gets the compiler's default, C++17.
  write_text(program + "/CMakeLists.txt", project + ("add_executable(your_program main.cpp)\n" + lines));
  write_text(program + "/main.cpp", R"(#include <binosplat/renderer.h>
int main(int count, char** arguments) {
  try {
    binosplat::Renderer(nullptr, binosplat::SplatModel(arguments[count - 1]));
  } catch (const binosplat::Error& error) {
    return static_cast<int>(error.code());
  }
}
)");
  write_text(model, to_bytes(small_model()));
  ASSERT_TRUE(is_built(program));
  // The program links, and exits with an error because it has no loader for GL functions.
  EXPECT_TRUE(succeeds(leaks + build + "/your_program " + model + "; test $? -eq 2"));
}

// Draws levels of detail, an inset and meshes with a budget, with installed files only.
TEST_F(Install, LibraryDrawsLevelsInsetAndMeshes) {
  const std::string city = folder / "city";
  ASSERT_TRUE(is_installed(prefix));
  write_text(folder / "CMakeLists.txt",
             std::string(project) +
                 "find_package(binosplat 0.1 REQUIRED)\nadd_executable(levels " BINOSPLAT_SOURCE_DIR
                 "/tests/install/levels_program.cpp)\n"
                 "target_link_libraries(levels binosplat::binosplat EGL OpenGL)\n");
  ASSERT_TRUE(is_built(folder.path()));
  ASSERT_TRUE(good(run_program({"levels", "demo:city", "--count", "10000", "-o", city})));
  const Outcome drawn =
      run_program({city}, {.variables = {{"ASAN_OPTIONS", "detect_leaks=0"}}, .program = build + "/levels"});
  ASSERT_TRUE(good(drawn));
  std::size_t first = 0, last = 0;
  int open = 0, covered = 0;
  ASSERT_EQ(std::sscanf(drawn.out.c_str(), "%zu %zu %d %d", &first, &last, &open, &covered), 4) << drawn.out;
  EXPECT_GT(last, first);
  EXPECT_GT(open, 500);
  EXPECT_EQ(covered, 0);
}

TEST_F(Install, PackagedProgramRuns) {
  if (std::getenv("BINOSPLAT_LONG") == nullptr) GTEST_SKIP() << "takes a minute: BINOSPLAT_LONG=1";
  if (std::system("dpkg-shlibdeps --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no dpkg here";
  ASSERT_TRUE(succeeds(std::string("cpack --config ") + BINOSPLAT_BUILD_DIR + "/CPackConfig.cmake -B " +
                       (folder / "packages").string()));
  ASSERT_TRUE(succeeds("cd " + folder.path().string() +
                       " && dpkg-deb -x packages/*.deb deb && mkdir tar && tar -xzf "
                       "packages/*.tar.gz --strip-components=1 -C tar"));
  for (const char* program : {"deb/usr/bin/binosplat", "tar/bin/binosplat"}) {
    ASSERT_TRUE(succeeds((folder / program).string() + " --version")) << program;
    EXPECT_EQ(read_text(folder / "said"), "binosplat 0.1.0\n");
  }
#ifdef BINOSPLAT_PYTHON
  ASSERT_TRUE(succeeds("PYTHONPATH=" + folder.path().string() +
                       "/deb/usr/lib/python3/dist-packages " BINOSPLAT_PYTHON
                       " -c 'import binosplat; print(binosplat.__file__)'"));
  EXPECT_TRUE(has(read_text(folder / "said"), "/deb/usr/lib/"));
#endif
  ASSERT_TRUE(succeeds("dpkg-deb -f " + folder.path().string() + "/packages/*.deb Depends"));
  EXPECT_TRUE(has(read_text(folder / "said"), "libopenexr"));
  EXPECT_EQ(read_text(folder / "said").find("mesa"), std::string::npos) << "drags Mesa along";
}

}  // namespace
}  // namespace binosplat
