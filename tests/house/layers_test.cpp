// Rules for source files: which modules a file may include from, how long it may be, and how it ends. The
// test reads the include lines itself, so it finds faults that compile.

#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/sources.h"

namespace {

using Files = binosplat::test::Sources;
using Texts = std::vector<std::string>;

// Modules that each module may include from, besides itself. formats, gl and reference do not see each other,
// render never sees formats or reference, and measure never sees formats. No module sees app or tests,
// because no list has them.
const std::map<std::string, std::set<std::string>> may_see = {
    {"shared", {}},
    {"base", {"shared"}},
    {"scene", {"base", "shared"}},
    {"demo", {"scene", "base", "shared"}},
    {"formats", {"scene", "base", "shared"}},
    {"gl", {"base", "shared"}},
    {"reference", {"scene", "base", "shared"}},
    {"render", {"gl", "scene", "base", "shared"}},
    {"measure", {"render", "gl", "reference", "scene", "base", "shared"}},
    {"stereo", {"render", "gl", "scene", "base", "shared"}},
    {"stream", {"render", "gl", "formats", "scene", "base", "shared"}},
    {"adagscale", {"measure", "render", "gl", "reference", "formats", "scene", "base", "shared"}},
    {"library", {"adagscale", "stream", "stereo", "formats", "render", "gl", "scene", "base", "shared"}},
    {"lab",
     {"adagscale", "stream", "stereo", "measure", "render", "gl", "reference", "formats", "scene", "base",
      "shared"}},
    {"compact",
     {"adagscale", "lab", "stream", "measure", "render", "gl", "formats", "scene", "base", "shared"}},
    {"preview",
     {"adagscale", "stream", "stereo", "measure", "render", "gl", "formats", "scene", "base", "shared"}},
    {"xr", {"base"}},
    {"python", {"adagscale", "stereo", "measure", "render", "formats", "scene", "base", "shared"}},
    {"app",
     {"adagscale", "demo", "preview", "xr", "compact", "lab", "stream", "stereo", "measure", "render", "gl",
      "reference", "formats", "scene", "base", "shared"}},
};

bool starts_with(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

// Returns the module of a file or of an included name, for paths such as src/MODULE/.., shaders/shared/.. and
// stereo/... The module of other shaders is "shaders", that of tests "tests".
std::string module_of(const std::string& path) {
  const std::string below = starts_with(path, "src/") ? path.substr(4) : path;
  if (starts_with(path, "shaders/shared/")) return "shared";
  return below.substr(0, below.find('/'));
}

// Returns the file that a quoted include names, or "". In shaders, {NAME} stands for the value of a define.
// Any file that matches will do, because all of them are in the same folder.
std::string resolved(const Files& files, const std::string& from, const std::string& name) {
  const std::size_t open = name.find('{'), close = name.find('}');
  if (starts_with(from, "shaders/") && open < close && close != std::string::npos) {
    const std::string start = "shaders/" + name.substr(0, open), end = name.substr(close + 1);
    for (const auto& [path, text] : files) {
      const bool longer = path.size() > start.size() + end.size();
      if (longer && starts_with(path, start) && path.substr(path.size() - end.size()) == end) return path;
    }
    return "";
  }
  Texts places = {"shaders/" + name};
  if (!starts_with(from, "shaders/")) places.insert(places.begin(), {"src/" + name, name});
  if (starts_with(from, "tests/")) places.push_back("tests/" + name);
  for (const std::string& place : places) {
    if (files.count(place)) return place;
  }
  return "";
}

void check_includes(const Files& files, const std::string& path, const std::string& text, Texts& found) {
  static const std::regex include(R"re(^[ \t]*#[ \t]*include[ \t]*"([^"]*)")re");
  const std::string module = module_of(path);
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::smatch match;
    if (!std::regex_search(line, match, include)) continue;
    const std::string place = path + ":" + std::to_string(number) + ": \"" + match.str(1) + "\" ";
    const std::string target = resolved(files, path, match.str(1));
    if (target.empty()) {
      found.push_back(place + "is no file of the tree: name it by its module, as in \"base/error.h\"");
      continue;
    }
    const std::string seen = module_of(target);
    if (module == "tests" || seen == module) continue;
    const bool allowed =
        module == "shaders" ? seen == "shared" : may_see.count(module) && may_see.at(module).count(seen);
    if (!allowed) found.push_back(place + module + " does not see " + seen);
  }
}

// All parallel loops must be in base/parallel, because the thread sanitizer's build replaces TBB's loops
// there.
void check_loops(const std::string& path, const std::string& text, Texts& found) {
  static const std::regex of_tbb("#\\s*include\\s*<(oneapi/)?tbb");
  if (path != "src/base/parallel.cpp" && path != "src/base/parallel_sort.h" &&
      std::regex_search(text, of_tbb))
    found.push_back(path + ": TBB's loops are in base/parallel.h, its sort in base/parallel_sort.h");
}

void check_end(const std::string& path, const std::string& text, Texts& found) {
  if (text.empty() || text.back() != '\n') found.push_back(path + ": does not end with a newline");
}

Texts breaches(const Files& files) {
  Texts found;
  for (const auto& [path, text] : files) {
    const std::string module = module_of(path);
    if (starts_with(path, "src/") && !may_see.count(module))
      found.push_back(path + ": a module without a layer");
    if (!starts_with(path, "cmake/")) check_includes(files, path, text, found);
    check_loops(path, text, found);
    check_end(path, text, found);
  }
  return found;
}

TEST(Layers, SourceTreeFollowsRules) {
  for (const std::string& breach :
       breaches(binosplat::test::sources_of_tree({"include", "src", "stereo", "shaders", "tests", "cmake"},
                                                 {".cpp", ".h", ".comp", ".glsl", ".txt", ".cmake"})))
    ADD_FAILURE() << breach;
}

// Returns the faults of a minimal source tree with one file added.
Texts breaches_with(const std::string& path, const std::string& text) {
  Files files = {{"src/base/error.h", "\n"},
                 {"src/scene/model.h", "#include \"base/error.h\"\n"},
                 {"src/formats/models/ply.h", "\n"},
                 {"src/gl/context.h", "\n"},
                 {"src/reference/render.h", "\n"},
                 {"src/render/frame.h", "#include \"gl/context.h\"\n"},
                 {"src/measure/metrics.h", "\n"},
                 {"src/app/command.h", "\n"},
                 {"stereo/rig.h", "\n"},
                 {"tests/support/scenes.h", "\n"},
                 {"shaders/shared/types.h", "\n"},
                 {"shaders/tiles/ellipse.glsl", "\n"},
                 {"src/gl/fence.h", "#include \"shared/types.h\"\n"}};
  files[path] = text;
  return breaches(files);
}

TEST(Layers, InjectedBreachesAreDetected) {
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"src/base/a.cpp", "scene/model.h"},
      {"src/scene/a.cpp", "formats/models/ply.h"},
      {"src/render/a.cpp", "formats/models/ply.h"},
      {"src/render/a.cpp", "reference/render.h"},
      {"src/gl/a.cpp", "reference/render.h"},
      {"src/gl/a.cpp", "scene/model.h"},
      {"src/reference/a.cpp", "gl/context.h"},
      {"src/formats/a.cpp", "gl/context.h"},
      {"src/measure/a.cpp", "stereo/rig.h"},
      {"src/render/a.cpp", "stereo/rig.h"},
      {"stereo/a.cpp", "app/command.h"},
      {"src/xr/a.cpp", "render/frame.h"},
      {"stereo/a.cpp", "support/scenes.h"},
      {"src/app/a.cpp", "tests/support/scenes.h"},
      {"shaders/shared/a.h", "base/error.h"},
      {"shaders/shared/a.h", "tiles/ellipse.glsl"},
      {"shaders/a.comp", "scene/model.h"},
      {"src/scene/a.cpp", "model.h"},
      {"src/gl/a.cpp", "render/frame.h"},
      {"src/new_module/a.cpp", "base/error.h"},
      {"src/app/a.cpp", "formats/no_such_file.h"},
      {"shaders/a.comp", "tiles/{TILES_NAME}.comp"},
      {"shaders/shared/a.h", "tiles/{TILES_NAME}.glsl"},
  };
  for (const auto& [path, name] : faults) {
    EXPECT_FALSE(breaches_with(path, "  #  include \"" + name + "\"\n").empty())
        << path << " may include " << name;
  }
  EXPECT_FALSE(breaches_with("src/base/a.cpp", "int a;").empty()) << "no newline at the end";
  const std::string of_tbb =
      // The text is in two pieces because this test reads its own file as well.
      std::string("#include <") + "tbb/tbb.h>\n";
  EXPECT_FALSE(breaches_with("src/base/a.cpp", of_tbb).empty()) << "loops that are not seen";
}

TEST(Layers, AllowedIncludesPass) {
  const std::vector<std::pair<std::string, std::string>> good = {
      {"src/measure/a.cpp", "reference/render.h"}, {"src/app/a.cpp", "stereo/rig.h"},
      {"shaders/a.comp", "tiles/ellipse.glsl"},    {"shaders/a.comp", "shared/types.h"},
      {"tests/app/a_test.cpp", "app/command.h"},   {"tests/app/a_test.cpp", "support/scenes.h"},
      {"src/gl/a.cpp", "shared/types.h"},          {"shaders/a.comp", "tiles/{TILES_NAME}.glsl"},
  };
  for (const auto& [path, name] : good) {
    EXPECT_EQ(breaches_with(path, "#include \"" + name + "\"\n"), Texts())
        << path << " may not include " << name;
  }
}

}  // namespace
