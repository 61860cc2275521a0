// Every option of every command either changes what a run leaves, or is refused. A new option fails here
// until it has a sample.

#include <functional>
#include <regex>

#include "app/options/table.h"
#include "app/scene.h"

namespace binosplat {
namespace {

/// What a run leaves: its exit code, its words without numbers, and its files.
struct Traces {
  int code = 0;
  std::string words;
  std::map<std::string, std::string> files;

  bool operator==(const Traces&) const = default;
};

/// Removes results that differ from run to run, and those that repeat the command line.
void forget_times(json& value) {
  static const std::regex varies(
      "(^|_)(ms|ns|seconds|s|speed|command|date|options|details|missed|advice|p99|share|bound|reason|waited|"
      "pareto)("
      "$|_)");
  if (value.is_object()) {
    Words gone;
    for (const auto& [name, inner] : value.items()) {
      if (std::regex_search(name, varies)) gone.push_back(name);
    }
    for (const std::string& name : gone) value.erase(name);
  }
  for (auto& inner : value) {
    if (inner.is_structured()) forget_times(inner);
  }
}

/// `words`: what of its output does not depend on time. `pictured`: whether a page's first picture does not.
Traces traces_of(const Outcome& outcome, const std::string& words, bool pictured, const fs::path& folder) {
  static const std::regex number(R"([-+]?\d[\d.,e+-]*)"), page(R"(\.(html|csv)$|trace\.json$)"),
      progress(R"([^\n]*ing[a-z ]* # %[^\n]*\n)");
  const std::string bare = std::regex_replace(words, number, "#");
  Traces traces{outcome.code, std::regex_replace(bare, progress, ""), contents_of(folder)};
  for (auto& [name, content] : traces.files) {
    if (std::regex_search(name, page)) {
      const std::size_t picture = pictured ? std::min(content.find("iVBOR"), content.size()) : content.size();
      content = content.substr(picture, content.find('"', picture) - picture);
    } else if (name.ends_with(".json")) {
      json results = json::parse(content);
      forget_times(results);
      content = results.dump();
    }
  }
  return traces;
}

/// The first difference of two runs, for messages.
std::string difference(const Traces& a, const Traces& b) {
  if (a.code != b.code || a.words != b.words) return a.words + "\n" + b.words;
  for (const auto& [name, content] : a.files) {
    if (!b.files.contains(name) || b.files.at(name) != content)
      return name + ": " + content + "\n" + (b.files.contains(name) ? b.files.at(name) : "");
  }
  return "files";
}

/// Words that give an option a value, and other words that it needs for an effect.
struct Sample {
  std::string option;
  Words value;
  Words beside = {};
  unsigned commands = app::in::all;
  std::string model = "../model.ply";
};

/// Returns `words` without the options that `more` has too, and then `more`. "!--option" only removes it.
Words over(Words words, Words more) {
  for (const std::string& option : more) {
    const auto at = std::ranges::find(words, option.substr(option.starts_with("!") ? 1 : 0));
    if (!(option.starts_with("-") || option.starts_with("!")) || at == words.end()) continue;
    words.erase(at,
                std::find_if(at + 1, words.end(), [](const auto& word) { return word.starts_with("-"); }));
  }
  std::erase_if(more, [](const std::string& word) { return word.starts_with("!"); });
  return joined(std::move(words), more);
}

using Runner = std::function<Traces(const Words& words)>;

/// Returns the options of a command that have no sample, and those that change nothing and are not refused.
Words without_effect(unsigned command, const Words& base, const std::vector<Sample>& samples,
                     const Runner& run) {
  app::Options unused;
  std::map<Words, Traces> plain;
  Words found;
  for (const app::Row& row : app::option_table(unused)) {
    if ((row.commands & command) == 0 || !row.name.starts_with("-")) continue;
    const auto sample = std::ranges::find_if(samples, [&](const Sample& each) {
      return each.option == row.word() && (each.commands & command) != 0;
    });
    if (sample == samples.end()) {
      found.push_back(row.word() + " has no sample");
      continue;
    }
    Words beside = over(base, sample->beside);
    std::ranges::replace(beside, "MODEL", sample->model);
    const auto [known, is_new] = plain.try_emplace(beside);
    if (is_new) {
      known->second = run(beside);
      // What varies by itself would pass as an effect.
      if (const Traces again = run(beside); plain.size() == 1 && again != known->second)
        found.push_back("nothing: " + difference(again, known->second));
    }
    if (run(over(beside, joined({row.word()}, sample->value))) == known->second) found.push_back(row.word());
  }
  return found;
}

namespace in = app::in;

const std::vector<Sample> samples = {
    // Scene
    {"--format", {"splat"}},
    {"--lod", {"1"}},
    {"--detail", {"5px"}},
    {"--gpu-memory", {"100"}},
    {"--axes", {"rub"}},
    {"--antialias", {}},
    {"--no-antialias", {}, {}, in::all, "../mip.ply"},
    {"--eps2d", {"2"}},
    {"--appearance", {"1"}},
    {"--seed", {"2"}},
    {"--count", {"20000"}},
    {"--repeat", {"2x1", "--spacing", "1"}},
    {"--spacing", {"1"}},
    {"--place", {"../place.json"}},
    // Cameras
    {"--cameras", {"../others.json"}},
    {"--view", {"side"}},
    {"--views", {}, {}, in::info},
    {"--views", {"2"}},
    {"--validation", {"side"}},
    {"--test", {"side"}},
    {"--test-every", {"2"}},
    {"--path", {"../path.json", "!--view"}},
    {"--eye", {"0,0,-1", "--at", "0,0,4", "!--view"}},
    {"--at", {"0,0,4"}},
    {"--up", {"1,0,0"}, {"!--view", "--eye", "0,0,-1", "--at", "0,0,4"}},
    {"--fov", {"30"}, {"!--view", "--eye", "0,0,-1", "--at", "0,0,4"}},
    {"--orbit", {"2"}},
    {"--frame", {"middle", "!--view"}},
    {"--size", {"40x30"}},
    {"--preset", {"headset", "--size", "32x28"}},
    {"--near", {"4"}},
    {"--vr180", {"--size", "32x32"}},
    {"--tour", {"calm", "--seconds", "0.03", "!--view"}, {}, in::render | in::profile},
    {"--tour", {"calm"}},
    {"--keys", {}, {"--path", "../path.json"}},
    {"--seconds", {"0.05"}, {"!--view", "--tour", "fast"}},
    // Both eyes
    {"--mono", {}},
    {"--only", {"left"}},
    {"--ipd", {"0.3"}},
    {"--units-per-metre", {"3"}},
    {"--convergence", {"1"}},
    {"--cant", {"5"}},
    // Drawing
    {"--tiles", {"aabb"}},
    {"--threshold", {"squared"}, {"--tolerance", "0.1"}},
    {"--tolerance", {"0.1"}},
    {"--quality", {"30"}},
    {"--max-drop", {"1", "--photos", "../photos"}},
    {"--calibration", {"../calibration.json"}},
    {"--transmittance", {"last"}, {"--tolerance", "0.1", "--frames", "3"}, in::render},
    {"--transmittance", {"last"}, {"--tolerance", "0.1"}},
    {"--order", {"distance"}},
    {"--projection", {"affine"}, {}, in::refit},
    {"--projection", {"tangent"}},
    {"--precision", {"half"}},
    {"--reference-until", {"bin"}},
    {"--frames", {"3"}},
    {"--foveate", {"inset=20deg"}},
    {"--backend", {"osmesa"}},
    {"--device", {"999"}},
    {"--shader-dir", {".."}},
    // Measuring
    {"--suite", {"../other_suite.json"}},
    {"--motion", {"still"}},
    {"--detail", {"5px"}},
    {"--rule", {"squared,one"}},
    {"--ppd", {"20"}},
    {"--compare", {"../older.json"}},
    {"--fail-if-slower", {"0"}},
    {"--no-clock", {}},
    {"--bins", {"5"}},
    {"--far", {"9"}},
    {"--against", {"exact"}, {"!--against", "!--size", "--photos", "../photos"}},
    {"--rounds", {"1"}},
    {"--refit", {}},
    {"--levels", {"2"}},
    {"--chunk", {"64"}},
    {"--min-psnr", {"90"}},
    {"--foveate-at", {"20,20,90"}},
    // Outputs
    {"--output", {"other.png"}},
    {"--to", {"spz"}},
    {"--sh-bits", {"4"}, {"-o", "x.spz"}},
    {"--layout", {"cross-eyed"}, {"-o", "pair.png"}},
    {"--show", {"depth"}},
    {"--background", {"1,0,0"}},
    {"--fps", {"10"}, {"--tour", "fast", "--seconds", "0.2"}, in::render},
    {"--fps", {"0"}},
    {"--bits", {"16"}},
    {"--png-level", {"9"}},
    {"--exr", {"half"}},
    {"--exr-encoding", {"display"}, {"--exr", "half"}},
    {"--exr-depth", {"median"}, {"--exr", "half"}},
    {"--exr-compression", {"zip"}, {"--exr", "half"}},
    {"--photos", {"../photos"}, {"--mono"}, in::render},
    {"--photos", {"../photos"}},
    {"--exposure", {"../exposures.json"}, {"--mono", "--photos", "../photos"}, in::render},
    {"--exposure", {"../exposures.json"}, {"--mono", "--photos", "../photos"}, in::bench},
    {"--exposure", {"../exposures.json"}, {"!--against", "!--size", "--photos", "../photos"}, in::refit},
    {"--exposure",
     {"../exposures.json"},
     {"!--quality", "!--size", "--photos", "../photos", "--max-drop", "0.1"}},
    {"--json", {"other.json"}},
    {"--difference", {"difference.png"}},
    {"--shard", {"1/2"}, {"--view", "all"}},
    {"--resume", {}},
    {"--max-memory", {"1"}, {"--view", "all"}, in::render},
    {"--max-memory", {"1"}, {}, in::compare},
    {"--max-memory", {"0"}},  // a value that is allowed changes only damaged files (SpzErrors)
    {"--quiet", {}, {"-o", "x.spz"}, in::convert},
    {"--quiet", {}},
};

struct OptionEffects : SceneTest {
  OptionEffects() {
    fs::create_directories(folder / "photos");
    json cameras, others, path, exposures;
    for (const std::string name : {"front", "side", "c", "d", "e", "f", "g", "h"}) {
      const auto k = static_cast<double>(cameras.size());
      cameras.push_back(camera_json(name, 0.1 * k));
      others.push_back(camera_json(name, 3.0 - 0.1 * k));
      path.push_back(camera_json(name, 0.2 * k));
      path.back()["time"] = 0.12 * k;
      exposures[name] = {{0.5, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0.1}};
      Image photo(72, 48, 3);
      for (std::size_t i = 0; i < photo.data.size(); ++i) photo.data[i] = static_cast<float>(i % 97) / 97.0f;
      save_png(folder / "photos" / (name + ".png"), photo);
    }
    save("cameras.json", cameras);
    save("others.json", others);
    save("path.json", path);
    save("exposures.json", exposures);
    save("place.json",
         {{{"model", "model.ply"}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.4, 0, 0, 1}}}});
    const json suite = {{"views", 1}, {"frames", 2}, {"repeats", 1}, {"sizes", {"24x16"}}, {"eyes", {2}}};
    save("suite.json",
         joined_json(suite, {{{"tiles", "ellipse"}}, {{"threshold", "adagscale"}, {"tolerance", 0.1}}}));
    save("other_suite.json", joined_json(suite, {{{"tiles", "snug"}}}));
    save("calibration.json", json::object());
    save("older.json", json::object());
    PlyFile mip = small_model();
    mip.comments = "comment SplatRenderMode: mip\n";
    write_text(folder / "mip.ply", to_bytes(mip));
    save_png(folder / "a.png", Image(120, 80, 3));
    save_png(folder / "b.png", Image(120, 80, 4));
  }

  static json joined_json(json suite, const json& settings) {
    suite["settings"] = settings;
    return suite;
  }

  /// Runs in an empty folder. Names outputs, if the words do not.
  Runner runner(unsigned command, const std::string& output) const {
    return [this, command, output](Words words) {
      const fs::path here = folder / "here";
      fs::remove_all(here);
      fs::create_directories(here);
      const auto lacks = [&](const char* a, const char* b) {
        return std::ranges::count(words, a) + std::ranges::count(words, b) == 0;
      };
      if (!output.empty() && lacks("-o", "--output")) words.insert(words.end(), {"-o", output});
      if ((command & takes_json) != 0 && lacks("--json", "--resume"))
        words.insert(words.end(), {"--json", "r.json"});
      const Outcome outcome = run_program(words, {.folder = here});
      constexpr unsigned timeless = in::convert | in::levels | in::info | in::compare | in::devices;
      const std::string out = (command & timeless) != 0 ? outcome.out : "";
      return traces_of(outcome, out + outcome.err, command == in::profile, here);
    };
  }
  static constexpr unsigned takes_json =
      in::render | in::fits | in::convert | in::info | in::compare | in::devices;

  void walk(unsigned command, const Words& base, const std::string& output) const {
    EXPECT_EQ(without_effect(command, base, samples, runner(command, output)), Words());
  }
};

TEST_F(OptionEffects, EveryOptionOfRenderHasEffect) { walk(in::render, {"render", "MODEL"}, "out"); }
TEST_F(OptionEffects, EveryOptionOfProfileHasEffect) {
  walk(in::profile, {"profile", "MODEL", "--view", "front", "--size", "32x24", "--seconds", "0.03"}, "out");
}
TEST_F(OptionEffects, EveryOptionOfBenchHasEffect) {
  walk(in::bench, {"bench", "MODEL", "--suite", "../suite.json"}, "out");
}
TEST_F(OptionEffects, EveryOptionOfCalibrateHasEffect) {
  walk(in::calibrate, {"calibrate", "MODEL", "--quality", "35", "--views", "1", "--size", "24x16"}, "c.json");
}
TEST_F(OptionEffects, EveryOptionOfTrimHasEffect) {
  walk(in::trim, {"trim", "MODEL", "--quality", "35", "--views", "1", "--size", "24x16"}, "t.ply");
}
TEST_F(OptionEffects, EveryOptionOfRefitHasEffect) {
  walk(in::refit,
       {"refit", "MODEL", "--against", "exact", "--projection", "tangent", "--rounds", "2", "--views", "1",
        "--size", "24x16"},
       "t.ply");
}
TEST_F(OptionEffects, EveryOptionOfConvertHasEffect) { walk(in::convert, {"convert", "MODEL"}, "t.ply"); }
TEST_F(OptionEffects, EveryOptionOfLevelsHasEffect) {
  walk(in::levels, {"levels", "MODEL", "--levels", "3"}, "levels");
}
TEST_F(OptionEffects, EveryOptionOfInfoHasEffect) {
  walk(in::info, {"info", "MODEL", "--cameras", "../cameras.json"}, "");
}
TEST_F(OptionEffects, EveryOptionOfCompareHasEffect) {
  walk(in::compare, {"compare", "../a.png", "../b.png"}, "");
}
TEST_F(OptionEffects, EveryOptionOfDevicesHasEffect) { walk(in::devices, {"devices"}, ""); }

TEST_F(OptionEffects, DetectIgnoredOption) {
  const Runner run = runner(in::compare, "");
  const Runner ignores = [&](const Words& words) {
    Words kept = words;
    if (const auto at = std::ranges::find(kept, "--ppd"); at != kept.end()) kept.erase(at, at + 2);
    return run(kept);
  };
  EXPECT_EQ(without_effect(in::compare, {"compare", "../a.png", "../b.png"}, samples, ignores),
            Words{"--ppd"});
}

/// Runs a command with the first of these options, and with the second one if there is one.
Outcome run_with(const fs::path& here, const std::string& command, unsigned bit, const Words& options) {
  Words words = {command};
  const Words scene = bit == in::compare ? Words{"../a.png", "../b.png"} : Words{"../model.ply"};
  words = joined(words, scene);
  for (const std::string& option : options) {
    const auto sample = std::ranges::find_if(
        samples, [&](const Sample& each) { return each.option == option && (each.commands & bit) != 0; });
    words.push_back(option);
    // Flags have no value; other values are the first word.
    if (!sample->value.empty() && !sample->value[0].starts_with("-") && !sample->value[0].starts_with("!"))
      words.push_back(sample->value[0]);
  }
  if ((bit & (in::calibrate | in::fits | in::convert | in::levels)) != 0)
    words.insert(words.end(), {"-o", "to.ply"});
  return run_program(words, {.folder = here});
}

TEST_F(OptionEffects, RejectConflictsAndMissingNeeds) {
  const std::pair<const char*, unsigned> commands[] = {{"render", in::render},       {"profile", in::profile},
                                                       {"bench", in::bench},         {"trim", in::trim},
                                                       {"calibrate", in::calibrate}, {"levels", in::levels}};
  app::Options unused;
  const std::vector<app::Row> rows = app::option_table(unused);
  const auto takes = [&](unsigned command, const std::string& option) {
    return std::ranges::any_of(
        rows, [&](const app::Row& row) { return row.word() == option && (row.commands & command) != 0; });
  };
  for (const auto& [name, bit] : commands) {
    const auto expect = [&, name = std::string(name), bit = bit](const Words& options,
                                                                 const std::string& said) {
      EXPECT_TRUE(ended(run_with(folder.path() / "photos", name, bit, options), 2, said));
    };
    for (const app::Conflict& row : app::conflicts()) {
      for (const std::string& other : row.others) {
        if (!takes(bit, row.option) || !takes(bit, other)) continue;
        expect({row.option, other}, row.option + " with " + other + ": " + row.why);
      }
    }
    for (const app::Conflict& row : app::needs()) {
      if ((row.commands & bit) == 0 || !takes(bit, row.option)) continue;
      expect({row.option}, row.option + " needs " + row.others[0] + ": " + row.why);
    }
  }
}

}  // namespace
}  // namespace binosplat
