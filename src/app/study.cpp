// binosplat study: its options, and which study they choose.

#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "app/analyses.h"
#include "app/blind.h"
#include "app/command.h"
#include "app/option_checks.h"
#include "app/output_options.h"
#include "app/report.h"
#include "app/resume.h"
#include "app/shots.h"
#include "app/study_parts.h"
#include "base/error.h"

namespace binosplat::app {

namespace {

using nlohmann::ordered_json;

enum class Study { analyses, motion, turn, levels };
constexpr const char* study_names[] = {"the analyses", "--motion", "--turn", "--levels"};

/// The options that not every study takes.
const struct {
  const char* option;
  std::vector<Study> studies;
} options_of_some[] = {{"--test", {Study::analyses}},
                       {"--photos", {Study::analyses, Study::turn}},
                       {"--exposure", {Study::analyses, Study::turn}},
                       {"--view", {Study::analyses, Study::turn, Study::levels}},
                       {"--frames", {Study::analyses, Study::motion, Study::levels}},
                       {"--mono", {Study::motion, Study::turn, Study::levels}},
                       {"--json", {Study::motion, Study::turn, Study::levels}},
                       {"--path", {Study::motion}},
                       {"--motions", {Study::motion}},
                       {"--rule", {Study::analyses, Study::motion}},
                       {"--segments", {Study::motion}},
                       {"--lead", {Study::motion}},
                       {"--stop", {Study::motion}},
                       {"--rounds", {Study::motion}},
                       {"--no-equal", {Study::motion}},
                       {"--target", {Study::motion}},
                       {"--quality", {Study::motion}},
                       {"--rays", {Study::turn}},
                       {"--detail", {Study::levels}}};

constexpr auto cases_are_tests =
    "its cases are tests now (docs/stability.md), and `study --motion` compares rules on a scene of yours";
constexpr auto rule_is_named = "`study --motion --rule TH,SOURCE` names a rule";
constexpr auto rules_are_compared =
    "`bench` times rules where cameras stand still, and `study --motion --motions still` compares them at "
    "one quality";

/// Options of earlier versions, and what to do instead.
constexpr struct {
  const char* option;
  bool has_value;
  const char* instead;
} removed_options[] = {
    {"--stability", false, cases_are_tests},
    {"--case", true, cases_are_tests},
    {"--rules", false, rules_are_compared},
    {"--th", true, rule_is_named},
    {"--transmittance", true, rule_is_named},
    {"--tolerance,--loss", true, "`bench --axes FILE` measures rules at tolerances of yours"}};

void add_removed_options(CLI::App& sub) {
  for (const auto& removed : removed_options) {
    const auto refuse = [&removed] { fail("study: {} was removed: {}", removed.option, removed.instead); };
    CLI::Option* option = removed.has_value ? sub.add_option_function<std::string>(
                                                  removed.option, [refuse](const std::string&) { refuse(); })
                                            : sub.add_flag_callback(removed.option, refuse);
    option->group("");  // no help or completion names it
  }
}

/// The one that the options choose. Throws Error for two, and for an option that it does not take.
Study chosen_study(const StudyOptions& options, const CLI::App& sub) {
  if (int{options.motion.chosen} + int{options.turn} + int{options.levels} > 1)
    fail("study: --motion, --turn and --levels are studies of their own");
  const Study study = options.motion.chosen ? Study::motion
                      : options.turn        ? Study::turn
                      : options.levels      ? Study::levels
                                            : Study::analyses;
  for (const auto& [option, studies] : options_of_some) {
    if (sub.count(option) == 0 || std::ranges::find(studies, study) != studies.end()) continue;
    std::vector<std::string> names;
    for (const Study one : studies) names.emplace_back(study_names[static_cast<std::size_t>(one)]);
    fail("study: {} goes with {}", option, fmt::join(names, " or "));
  }
  return study;
}

Studied open_studied(const StudyOptions& options) {
  OpenScene scene = open_scene(options.scene, options.camera, options.rig, [&](const CameraList& list) {
    if (options.photos.empty()) return;
    check_photos(options.photos, photographed_cameras(photos_of_a_turn, options.photos, {}, list));
  });
  std::vector<Shot> shots = make_shots(options.camera.views, options.camera.lens, no_rig, scene.list,
                                       scene.near_plane, scene.model.axes);
  if (shots.size() > 1) fail("--view all: a study is of one view");
  return {std::make_shared<const Model>(std::move(scene.model)), std::move(scene.list), scene.near_plane,
          std::move(shots)};
}

ExitCode study_scene(const StudyOptions& options, Study study) {
  if (options.scenes.size() > 1 && study != Study::levels)
    fail("study {}: expected one scene; only --levels takes more", fmt::join(options.scenes, " "));
  if (study == Study::analyses)
    return analyse_scene(options, options.test, options.frames.value_or(24),
                         options.output.empty() ? "out/study" : options.output);
  if (!options.output.empty()) check_output(std::filesystem::path(options.output) / "study.json");
  if (!options.json.empty()) check_output(options.json);
  if (study == Study::motion) study_motion(options);
  if (study == Study::levels) study_levels(options);
  if (study == Study::turn) {
    if (options.camera.views.size() > 1) fail("--view: this study is of one view");
    if (options.rays && std::int64_t{options.rays->x} * options.rays->y > 1'000'000)
      fail("--rays {}x{}: at most a million", options.rays->x, options.rays->y);
    const Studied studied = open_studied(options);
    const auto context = open_context_for_all("study", false, options.context);
    refuse_blind("study", *context, *studied.model, studied.shots, studied.near_plane);
    study_turn(*context, options, studied);
  }
  return ExitCode::done;
}

/// What is studied and where that goes.
void add_studied_options(CLI::App& sub, StudyOptions& o) {
  sub.add_option("--cameras", o.camera.file, "cameras.json; default: the one beside the model")
      ->type_name("FILE");
  sub.add_option("--view", o.camera.views,
                 "Views to calibrate on; default: 16 others than the test's, evenly spread.\n"
                 "With --turn: the one to turn in (the first); with --levels: those to draw;\n"
                 "default: 8, evenly spread")
      ->type_name("NAME...");
  sub.add_option("--test", o.test, "Views to test on; default: 8, evenly spread")->type_name("NAME...");
  add_photos_options(
      sub, o,
      "DIR/NAME.jpg or .png of the views: tolerances for 0.1 to 0.5 dB;\nwith --turn what each "
      "order and projection loses");
  sub.add_option("-o,--output", o.output,
                 "Folder for report.html and study.json (out/study; of other studies none)")
      ->type_name("DIR");
  add_size_option(sub, o.camera.lens, "Of an eye's picture");
  add_preset_option(sub, o.camera.lens,
                    "preview: 1280 x 720 an eye; headset: 3660 x 3200 an eye, 100 degrees");
  sub.add_flag("--mono", o.rig.mono, "With --motion, --turn and --levels: the cameras themselves, no rig");
  add_measured_options(sub, o);
  add_ipd_option(sub, o.rig);
  sub.add_option("--units-per-metre", o.rig.units_per_metre, "World units that make a metre (1)")
      ->type_name("U")
      ->check(positive);
  sub.add_option("--json", o.json, "Write everything as JSON")->type_name("FILE");
}

}  // namespace

void print_table(const lab::Table& table) {
  fmt::print("| {} |\n|", fmt::join(table.columns, " | "));
  for (std::size_t k = 0; k < table.columns.size(); ++k) fmt::print("---|");
  fmt::print("\n");
  for (const std::vector<lab::Cell>& row : table.rows) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::string& column = table.columns[k];
      const int digits = column.ends_with("dB") ? 2 : column.ends_with("%") ? 1 : 3;
      const auto* const number = std::get_if<double>(&row[k].value);
      const auto* const text = std::get_if<std::string>(&row[k].value);
      fmt::print("{} {}", k == 0 ? "|" : " |",
                 number != nullptr ? fmt::format("{:.{}f}", *number, digits)
                 : text != nullptr ? *text
                                   : "");
    }
    fmt::print(" |\n");
  }
}

void save(const StudyOptions& options, const ordered_json& numbers, const lab::Page& page) {
  if (!options.json.empty()) save_json(options.json, numbers);
  if (!options.output.empty()) save_report(options.output, "study.json", numbers, page);
}

void add_study(CLI::App& program, Command& command) {
  CLI::App* sub = program.add_subcommand(
      "study", "What thresholds gain on a scene, where they fail, and what levels of detail lose");
  const auto options = std::make_shared<StudyOptions>();
  StudyOptions& o = *options;
  sub->add_option("SCENE", o.scenes, "A model, or demo:room or demo:city; with --levels one or more")
      ->required();
  sub->add_flag("--turn", o.turn,
                "What turning the head changes along the same rays, by order and projection,\n"
                "and what these are worth to two eyes, in motion and against photos:\n"
                "best with pictures of 100 degrees (--preset headset)");
  sub->add_option_function<std::string>(
         "--rays",
         [&o](const std::string& text) {
           o.rays = parse_two("--rays", text, "rays across and down as NxN, for one 96x72");
         },
         "With --turn: rays across and down (48x36; where the CPU draws 16x12)")
      ->type_name("NxN");
  add_rule_option(*sub, o.rules);
  add_motion_options(*sub, o.motion);
  add_levels_options(*sub, o);
  sub->add_option(
         "--frames", o.frames,
         "Timed of each setting in each of three rounds (24);\nwith --motion: that move, of a segment (60)")
      ->type_name("N")
      ->check(range(1, 10000));
  sub->add_option("--path", o.camera.path,
                  "With --motion: along the cameras of this file, through keys 90 frames a second")
      ->type_name("FILE");
  sub->add_option("--target", o.target, "With --motion: dB at which rules are compared (40)")
      ->excludes(sub->get_option("--no-equal"))
      ->type_name("DB")
      ->check(quality_range);
  sub->add_option("--quality", o.quality, "With --motion: dB that every rule is asked for (40)")
      ->type_name("DB")
      ->check(quality_range);
  add_studied_options(*sub, o);
  add_removed_options(*sub);
  sub->footer(
      "By itself it repeats AdaGScale's analyses on the scene, as a page with plots; started again with\n"
      "the same options, these go on where they were ended.\n"
      "Examples:\n"
      "  binosplat study garden.ply --photos images -o out/garden\n"
      "  binosplat study garden.ply --motion --rule squared,one --rule squared,last --size 1280x1120\n"
      "  binosplat study garden.ply --turn --preset headset\n"
      "  binosplat study garden-levels --levels --cameras cameras.json --preset headset -o out/levels");
  sub->callback([options, sub, &command] {
    options->scene.name = options->scenes.front();
    options->motion.lengths.moving = static_cast<std::size_t>(options->frames.value_or(60));
    const Study study = chosen_study(*options, *sub);
    options->given = options_given(*sub);
    command = [options, study] { return study_scene(*options, study); };
  });
}

}  // namespace binosplat::app
