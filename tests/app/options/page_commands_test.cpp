// The commands on the pages are well formed. Each runs without OpenGL, with small models, cameras and photos
// that have the names in the command.

#include <fmt/format.h>

#include <regex>
#include <set>

#include "app/scene.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

const fs::path source = BINOSPLAT_SOURCE_DIR;

/// Returns the lines of a page's code blocks, without prompts. A line that ends in a backslash continues.
Words lines_of_blocks(const std::string& page) {
  Words lines;
  bool is_code = false, continues = false;
  std::istringstream in(page);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) {
      is_code = !is_code;
      continues = false;
    } else if (is_code) {
      if (line.starts_with("$ ")) line.erase(0, 2);
      if (continues) {
        lines.back() += line;
      } else {
        lines.push_back(line);
      }
      continues = line.ends_with('\\');
      if (continues) lines.back().pop_back();
    }
  }
  return lines;
}

/// Returns the program's commands on a page: lines of code blocks, and inline code with a sub-command and a
/// scene.
Words commands_of(const std::string& page) {
  static const std::regex line(
      R"(\s*((?:[A-Z_]+=\S+\s+)*)(?:build/release/|\./|binosplat-env/bin/)?binosplat\s([^&;|]*).*)");
  static const std::regex code(R"(`(?:build/release/)?binosplat\s([a-z]+\s[^-`][^`]*)`)");
  Words commands;
  std::smatch found;
  for (const std::string& text : lines_of_blocks(page)) {
    if (std::regex_match(text, found, line))
      commands.push_back(found[1].str() + "binosplat " + found[2].str());
  }
  for (std::sregex_iterator at(page.begin(), page.end(), code), end; at != end; ++at)
    commands.push_back("binosplat " + std::regex_replace((*at)[1].str(), std::regex("\n"), " "));
  return commands;
}

struct PageCommands : SceneTest {
  /// Writes the models, cameras and photos that the command names into a folder.
  void prepare(const std::string& command, const fs::path& here) const {
    const std::regex models(R"(\s(\w+\.ply|\w+/)(?=\s))"), photos(R"(--photos\s(\S+))"),
        names(R"(--(?:view|test|validation)\s([\w,]+))");
    const auto each = [&](const std::regex& what, auto&& found) {
      for (std::sregex_iterator at(command.begin(), command.end(), what), end; at != end; ++at)
        found((*at)[1].str());
    };
    std::set<std::string> views = {"front", "side"};
    each(names, [&](const std::string& list) {
      std::istringstream in(list);
      for (std::string name; std::getline(in, name, ',');) views.insert(name);
    });
    json cameras;
    for (const std::string& name : views)
      cameras.push_back(camera_json(name, 0.1 * static_cast<double>(cameras.size())));
    fs::create_directories(here);
    write_text(here / "cameras.json", cameras.dump());
    each(models, [&](const std::string& name) {
      fs::create_directories((here / name).parent_path());
      for (const char* file : {"1.ply", "2.ply"})
        fs::copy_file(model, name.ends_with('/') ? here / name / file : here / name,
                      fs::copy_options::overwrite_existing);
    });
    each(photos, [&](const std::string& name) {
      fs::create_directories(here / name);
      for (const std::string& view : views) write_text(here / name / (view + ".png"), photo);
    });
  }

  /// Returns the error with which the program refuses a command. It is empty if the command is accepted, or
  /// lacks only a file.
  std::string refusal(std::string command) {
    // demo:room takes a second to build, a small model no time.
    command = std::regex_replace(command, std::regex("demo:room"), "built_in.ply");
    command = std::regex_replace(command, std::regex("/data/"), "");
    const fs::path here = folder / fmt::format("{}", ++count);
    prepare(command, here);
    const std::string bin = folder / "bin";
    if (!fs::exists(bin)) {
      fs::create_directories(bin);
      fs::create_symlink(test::built_program(), bin + "/binosplat");
      for (const char* library : {"libEGL.so.1", "libOSMesa.so.8", "libopenxr_loader.so.1"})
        write_text(folder / "bin" / library, "no library");
    }
    const Outcome outcome = run_program(
        {"-c", "PATH=" + bin + ":$PATH LD_LIBRARY_PATH=" + bin + "; export LD_LIBRARY_PATH; " + command},
        {.folder = here,
         .variables = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}, {"i", "1"}},
         .limits = {},
         .program = "/bin/sh"});
    static const std::regex no_file("[Nn]o such file|has no levels of detail");
    const bool lacks_file = outcome.code == 2 && std::regex_search(outcome.err, no_file);
    const bool runs = outcome.code == 0 || outcome.code == 1 || outcome.code == 3;
    return runs || lacks_file ? "" : fmt::format("{}\nexit code {}: {}", command, outcome.code, outcome.err);
  }

  const std::string photo = png_bytes(Image(72, 48, 3));
  int count = 0;
};

TEST_F(PageCommands, AreWellFormed) {
  std::set<std::string> commands;
  std::vector<fs::path> pages = {source / "README.md"};
  for (const auto& entry : fs::directory_iterator(source / "docs")) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  for (const fs::path& page : pages) {
    for (const std::string& command : commands_of(read_text(page))) commands.insert(command);
  }
  EXPECT_GT(commands.size(), 60u) << "the commands were not found";
  for (const std::string& command : commands) EXPECT_EQ(refusal(command), "");
}

TEST_F(PageCommands, InjectedFaultsAreDetected) {
  const Words commands = commands_of(
      "`binosplat render` draws, and `binosplat info\nMODEL.ply --vews`.\n```sh\nmkdir out\n"
      "# binosplat is a comment\nA=b build/release/binosplat render demo:room \\\n  --tolerence 1 -o "
      "out\n```\n"
      "```\n$ ./binosplat rendr demo:room & wait\nbinosplat render a.ply --view A,B --photos p --mono\n"
      "binosplat render demo:room --quality 40 --tolerance 1\nbinosplat view a.ply --layout sideways\n```\n");
  ASSERT_EQ(commands.size(), 6u) << testing::PrintToString(commands);
  EXPECT_TRUE(has(refusal(commands[0]), "did you mean --tolerance?"));
  EXPECT_TRUE(has(refusal(commands[1]), "did you mean render?"));
  EXPECT_EQ(refusal(commands[2]), "");
  EXPECT_TRUE(has(refusal(commands[3]), "--quality 40 with --tolerance 1"));
  EXPECT_EQ(refusal(commands[4]).empty(),
            !fs::exists(test::built_program().parent_path() / "binosplat-view"));
  EXPECT_TRUE(has(refusal(commands[5]), "did you mean --views?"));
}

struct AdaGScaleCommands : PageCommands {
  const Words small = {"--size", "320x180"};

  /// Runs a page's command with another scene, in small pictures.
  static Outcome run(const std::string& command, const Words& scene, const Words& more) {
    std::istringstream in(command);
    Words words;
    in >> words.emplace_back();  // binosplat
    words.clear();
    for (std::string word; in >> word;) {
      if (word.ends_with(".ply")) {
        words.insert(words.end(), scene.begin(), scene.end());
      } else {
        words.push_back(word);
      }
    }
    return run_program(joined(words, more));
  }

  /// Draws the default view exactly and by `command`, whose picture has fewer pairs and at least these dB.
  void expect_fewer_pairs(const std::string& command, const Words& scene, double least_db) const {
    const auto draw = [&](const std::string& words, const std::string& name) {
      const Words more = {"--mono", "-o", folder / name, "--png-level", "0", "--json", folder / "r.json"};
      const Outcome outcome = run(words, scene, joined(small, more));
      EXPECT_EQ(outcome.code, 0) << outcome.err;
      return load_json(folder / "r.json")["views"][0];
    };
    const json exact = draw("binosplat render a.ply", "exact.png"), drawn = draw(command, "drawn.png");
    EXPECT_EQ(drawn["threshold"], "adagscale") << command;
    EXPECT_LE(drawn["pairs"].get<double>(), 0.9 * exact["pairs"].get<double>()) << command;
    EXPECT_GE(psnr_of_files(folder / "exact.png", folder / "drawn.png"), least_db) << command;
  }

  /// Runs the first commands of docs/adagscale.md.
  void expect_pairs_removed(const Words& scene, double least_db, bool finds_k = true) const {
    const std::string page = read_text(source / "docs/adagscale.md"), calibration = folder / "c.json";
    const Words drawing = commands_of(page.substr(page.find("## Drawing")));
    ASSERT_GT(drawing.size(), 2u);
    const auto by_file = [&](const std::string& command) {
      return std::regex_replace(command, std::regex("calibration\\.json"), calibration);
    };
    EXPECT_TRUE(has(drawing[0], "render MODEL.ply --threshold adagscale"));
    if (finds_k) expect_fewer_pairs(drawing[0], scene, least_db);
    const Outcome outcome = run(by_file(drawing[1]), scene, joined(small, {"--views", "4"}));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    for (const json& entry : load_json(calibration)["entries"]) EXPECT_GE(entry["worst_db"], 40.0);
    expect_fewer_pairs(by_file(drawing[2]), scene, least_db);
  }
};

TEST_F(AdaGScaleCommands, RemovesPairsInRoom) { expect_pairs_removed({"demo:room"}, 40.0); }
TEST_F(AdaGScaleCommands, RemovesPairsInCity) {
  expect_pairs_removed({"demo:city", "--count", "50000"}, 40.0);
}
TEST_F(AdaGScaleCommands, RemovesPairsInFox) {
  REQUIRE_SCENE("fox", fox);
  expect_pairs_removed({fox / "fox.ply"}, 36.0, false);  // its default view is none of the four calibrated
}

}  // namespace
}  // namespace binosplat
