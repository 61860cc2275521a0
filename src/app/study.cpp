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
                       {"--hold-out", {Study::analyses}},
                       {"--far", {Study::analyses}},
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
  if (shots.size() > 1)
    fail("--view {}: this study is of one view", fmt::join(options.camera.views, " --view "));
  return {std::make_shared<const Model>(std::move(scene.model)), std::move(scene.list), scene.near_plane,
          std::move(shots)};
}

ExitCode study_scene(StudyOptions options, Study study) {
  if (options.scenes.size() > 1 && study != Study::levels && study != Study::analyses)
    fail("study {}: {} is a study of one scene", fmt::join(options.scenes, " "),
         study_names[static_cast<std::size_t>(study)]);
  if (study == Study::analyses) {
    AnalysesOptions analyses = options.analyses;
    analyses.frames = options.frames.value_or(analyses.frames);
    if (!options.output.empty()) analyses.folder = options.output;
    return analyse_scenes(options, options.scenes, analyses);
  }
  if (options.photos == photos_beside)
    options.photos = photos_folder(options.photos, listed_cameras(options.scene, options.camera));
  if (!options.output.empty()) check_output(std::filesystem::path(options.output) / "study.json");
  if (!options.json.empty()) check_output(options.json);
  if (study == Study::motion) study_motion(options);
  if (study == Study::levels) study_levels(options);
  if (study == Study::turn) {
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
  add_names_option(sub, "--view", o.camera.views,
                   "Views to calibrate on; default: 16 of those for training, evenly spread.\n"
                   "With --turn: the one to turn in (the first); with --levels: those to draw;\n"
                   "default: 8, evenly spread");
  add_names_option(sub, "--test", o.analyses.test, "Views to test on; default: those held out, at most 24");
  add_hold_out_option(sub, o.analyses.hold_out);
  add_value(sub, "--far", "DEPTH", o.analyses.far, positive,
            "Where the table by depth of AdaGScale's own protocol ends, world units (100)");
  add_photos_options(
      sub, o,
      "DIR/NAME.jpg or .png of the views: tolerances for 0.1 to 0.5 dB;\nwith --turn what each "
      "order and projection loses",
      true);
  sub.add_option("-o,--output", o.output,
                 "Folder for report.html and study.json (out/study; of other studies none)")
      ->type_name("DIR");
  add_size_option(sub, o.camera.lens, "Of an eye's picture");
  add_preset_option(sub, o.camera.lens,
                    "preview: 1280 x 720 an eye; headset: 3660 x 3200 an eye, 100 degrees");
  sub.add_flag("--mono", o.rig.mono, "With --motion, --turn and --levels: the cameras themselves, no rig");
  add_measured_options(sub, o);
  add_ipd_option(sub, o.rig);
  add_value(sub, "--units-per-metre", "U", o.rig.units_per_metre, positive,
            "World units that make a metre (1)");
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
  sub->add_option("SCENE", o.scenes, "A model, or demo:room or demo:city; of --motion and --turn one")
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
  add_value(
      *sub, "--frames", "N", o.frames, range(1, 10000),
      "Timed of each setting in each of three rounds (24);\nwith --motion: that move, of a segment (60)");
  sub->add_option("--path", o.camera.path,
                  "With --motion: along the cameras of this file, through keys 90 frames a second")
      ->type_name("FILE");
  sub->add_option("--target", o.target, "With --motion: dB at which rules are compared (40)")
      ->excludes(sub->get_option("--no-equal"))
      ->type_name("DB")
      ->check(quality_range);
  add_value(*sub, "--quality", "DB", o.quality, quality_range,
            "With --motion: dB that every rule is asked for (40)");
  add_studied_options(*sub, o);
  sub->footer(
      "By itself it makes AdaGScale's figures and tables on the scene, by the paper's protocol\n"
      "(docs/adagscale.md); started again with the same options it goes on where it was ended.\n"
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
