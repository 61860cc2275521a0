// binosplat study: which one the options ask for, and what a memory of the last frame is worth along a path.

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <span>

#include "app/analyses.h"
#include "app/blind.h"
#include "app/command.h"
#include "app/option_checks.h"
#include "app/output_options.h"
#include "app/report.h"
#include "app/shots.h"
#include "app/study_parts.h"
#include "app/tour.h"
#include "base/log.h"
#include "base/progress.h"
#include "lab/along_path.h"
#include "lab/fields.h"
#include "lab/rules.h"
#include "render/stage.h"

namespace binosplat::app {

namespace {

using lab::Variant;
using nlohmann::ordered_json;

Studied open_studied(const StudyOptions& options) {
  // A case takes a head along paths of its own, and makes the eyes itself; a head that turns has one.
  const RigOptions& rig = options.stability || options.turn ? no_rig : options.rig;
  OpenScene scene = open_scene(options.scene, options.camera, options.rig, [&](const CameraList& list) {
    if (options.photos.empty()) return;
    check_photos(options.photos, photographed_cameras(photos_of_a_turn, options.photos, {}, list));
  });
  if (!options.camera.path.empty())
    scene.list = go_along_path(options.camera, headset_fps, true, std::move(scene.list));
  std::vector<Shot> shots = make_shots(options.camera.views, options.camera.lens, rig, scene.list,
                                       scene.near_plane, scene.model.axes);
  if (options.camera.path.empty() && shots.size() > 1) fail("--view all: a study is of one view");
  return {std::make_shared<const Model>(std::move(scene.model)), std::move(scene.list), scene.near_plane,
          std::move(shots)};
}

ordered_json along_path(gl::Context& context, const StudyOptions& options, const Studied& studied) {
  Variant variant{options.th, options.transmittance, options.tolerance.value_or(0.0f)};
  std::vector<std::vector<shared::View>> frames;
  for (const Shot& shot : studied.shots) frames.push_back(views_of(shot));
  if (frames.size() < 2) fail("--path {}: a path has two cameras or more", options.camera.path);
  const float quality = options.quality.value_or(0.0f);
  render::FrameSettings asked = variant.settings();
  asked.quality = quality;
  render::check_choice(asked, "--");
  if (quality == 0.0f && !options.tolerance)
    variant.tolerance = lab::tolerance_along_path(context, *studied.model, frames, variant, options.target);
  Progress progress("frames", frames.size());
  std::size_t done = 0;
  const auto results = lab::draw_along_path(context, *studied.model, frames, variant, quality,
                                            [&] { progress.update(++done); });
  fmt::print("{} along {}, {}\n\n", variant.name(), options.camera.path,
             quality > 0 ? fmt::format("steered to {} dB", quality)
                         : fmt::format("tolerance {:.4g}", variant.tolerance));
  fmt::print(
      "| frame | dB | removed | signed | `one` with as many pairs, dB | gain |\n|---|---|---|---|---|---|\n");
  ordered_json json = {{"variant", variant.name()}, {"tolerance", variant.tolerance}, {"quality", quality}};
  for (std::size_t n = 0; n < results.size(); ++n) {
    const lab::PathFrame& r = results[n];
    const std::string note = !r.fell_back   ? ""
                             : quality > 0  ? " (fell back)"
                             : r.equals_one ? " (fell back: equals `one`)"
                                            : " (fell back, and differs from `one`)";
    fmt::print("| {}{} | {:.2f} | {:.1f} % | {:+.4f} | {} | {} |\n", n, note, r.db, 100.0 * r.removed,
               r.signed_mean, quality > 0 ? "" : fmt::format("{:.2f}", r.one_db),
               quality > 0 ? "" : fmt::format("{:+.2f}", r.db - r.one_db));
    json["frames"].push_back(lab::object(
        "db", r.db, "pairs", r.pairs, "removed", r.removed, "mean_signed_error", r.signed_mean, "fell_back",
        r.fell_back, "equals_one", r.equals_one, "one_db", r.one_db, "one_pairs", r.one_pairs));
  }
  return json;
}

void print_rules(const std::vector<lab::RuleResult>& results) {
  const auto shown = std::span(render::stage_names).subspan(1, render::stages_with_twins - 1);  // no decode
  fmt::print(
      "| rule | tolerance | dB | disagreement dB | pairs, M | removed | frame ms | {} | rest | of exact | of "
      "`one` "
      "| |\n",
      fmt::join(shown, " | "));
  fmt::print("|");
  for (std::size_t k = 0; k < shown.size() + 11; ++k) fmt::print("---|");
  fmt::print("\n");
  for (const lab::RuleResult& r : results) {
    // One eye disagrees with none.
    const std::string disagreement =
        std::isnan(r.disagreement_db) ? "-" : fmt::format("{:.2f}", r.disagreement_db);
    fmt::print("| {} | {:.4g} | {:.2f} | {} | {:.3f} | {:.1f} % | {:.3f} |", r.variant.name(),
               r.variant.tolerance, r.db, disagreement, 1e-6 * r.pairs, 100.0 * r.removed, r.frame_ms);
    std::map<std::string, double> ms;
    for (const gl::StageTime& stage : r.stages) ms[stage.name] = stage.ms;
    for (const char* name : shown) {
      fmt::print(" {:.3f} |", ms[name]);
      ms.erase(name);
    }
    double rest = 0.0;
    for (const auto& [name, stage_ms] : ms) rest += stage_ms;
    fmt::print(" {:.3f} | {:.3f} | {:.3f} | {} |\n", rest, r.of_exact, r.of_one, r.problem);
  }
}

ordered_json rules(gl::Context& context, const StudyOptions& options, const Studied& studied) {
  const int frames = options.frames.value_or(96);
  const Shot& shot = studied.shots.front();
  lab::FixedCamera camera(context, *studied.model, views_of(shot));
  std::vector<Variant> variants = lab::all_variants();
  std::size_t done = 0;
  {
    Progress progress("tolerances", variants.size());
    lab::find_tolerances(camera, variants, options.target, [&] { progress.update(++done); });
  }
  Progress progress("timing", lab::rule_rounds * variants.size());
  done = 0;
  const auto results =
      lab::measure_rules(camera, variants, options.target, frames, [&] { progress.update(++done); });
  const shared::View& view = camera.views().front();
  fmt::print("{}: {}, {}, {} x {} x {} px, {} dB\n\n", context.renderer(), options.scene.name, shot.name,
             camera.views().size(), view.width, view.height, options.target);
  print_rules(results);
  ordered_json json = lab::object("renderer", context.renderer(), "scene", options.scene.name, "gaussians",
                                  studied.model->count(), "view", shot.name, "eyes", camera.views().size(),
                                  "width", view.width, "height", view.height, "target_db", options.target,
                                  "frames", frames, "rounds", lab::rule_rounds);
  for (const lab::RuleResult& result : results) json["rules"].push_back(to_json(result));
  return json;
}

/// Which study the options ask for, beside the analyses.
enum class StudyKind { analyses, stability, rules, motion, turn, levels, path };

StudyKind kind_of(const StudyOptions& o) {
  const bool path = !o.camera.path.empty() && !o.motion.chosen;  // --motion goes along one, too
  if (int{o.stability} + int{o.rules} + int{o.motion.chosen} + int{o.turn} + int{o.levels} + int{path} > 1)
    fail("study: --stability, --rules, --motion, --turn, --levels and --path FILE are studies of their own");
  return o.stability       ? StudyKind::stability
         : o.rules         ? StudyKind::rules
         : o.motion.chosen ? StudyKind::motion
         : o.turn          ? StudyKind::turn
         : o.levels        ? StudyKind::levels
         : path            ? StudyKind::path
                           : StudyKind::analyses;
}

void check_study(const StudyOptions& options, StudyKind kind) {
  const bool of_page = kind == StudyKind::stability || kind == StudyKind::motion || kind == StudyKind::turn ||
                       kind == StudyKind::levels;
  if (!options.test.empty() || (!options.photos.empty() && kind != StudyKind::turn))
    fail(
        "study: --test and --photos are for the analyses, and --photos for --turn, without --stability, "
        "--rules, --motion, --levels and --path");
  if (options.frames && kind != StudyKind::rules && kind != StudyKind::motion && kind != StudyKind::levels)
    fail("--frames goes with --rules, --motion and --levels, or with the analyses");
  if (options.rays && kind != StudyKind::turn) fail("--rays goes with --turn");
  if (options.rays && std::int64_t{options.rays->x} * options.rays->y > 1'000'000)
    fail("--rays {}x{}: at most a million", options.rays->x, options.rays->y);
  if (options.camera.views.size() > 1 && kind != StudyKind::levels) fail("--view: this study is of one view");
  if (kind == StudyKind::motion && !options.camera.views.empty())
    fail("--view: --motion goes through all cameras");
  if (!options.output.empty() && !of_page)
    fail(
        "study: -o is for the analyses, --stability, --motion, --turn and --levels: --json keeps the numbers "
        "of the others");
}

ExitCode study_scene(const StudyOptions& options) {
  const StudyKind kind = kind_of(options);
  if (options.scenes.size() > 1 && kind != StudyKind::levels)
    fail("study {}: expected one scene; only --levels takes more", fmt::join(options.scenes, " "));
  if (kind == StudyKind::analyses) {
    if (!options.not_for_analyses.empty())
      fail("study: {} {} with --stability, --rules, --motion, --turn, --levels or --path FILE",
           fmt::join(options.not_for_analyses, ", "), options.not_for_analyses.size() > 1 ? "go" : "goes");
    return analyse_scene(options, options.test, options.frames.value_or(24),
                         options.output.empty() ? "out/study" : options.output);
  }
  check_study(options, kind);
  if (!options.output.empty()) check_output(std::filesystem::path(options.output) / "study.json");
  if (!options.json.empty()) check_output(options.json);
  if (kind == StudyKind::motion || kind == StudyKind::levels) {  // which open their scenes themselves
    if (kind == StudyKind::motion) study_motion(options);
    if (kind == StudyKind::levels) study_levels(options);
    return ExitCode::done;
  }
  const Studied studied = open_studied(options);
  const auto context = open_context_for_all("study", kind == StudyKind::rules, options.context);
  refuse_blind("study", *context, *studied.model, studied.shots, studied.near_plane);
  if (kind == StudyKind::stability) study_stability(*context, options, studied);
  if (kind == StudyKind::turn) study_turn(*context, options, studied);
  if (kind == StudyKind::rules) save(options, rules(*context, options, studied), {});
  if (kind == StudyKind::path) save(options, along_path(*context, options, studied), {});
  return ExitCode::done;
}

/// What is studied and where that goes.
void add_studied_options(CLI::App& sub, StudyOptions& o) {
  sub.add_option("--cameras", o.camera.file, "cameras.json; default: the one beside the model")
      ->type_name("FILE");
  sub.add_option("--view", o.camera.views,
                 "The camera to study from; default: the first. With --levels: those to draw;\n"
                 "default: 8, evenly spread. Without --stability, --rules, --motion, --turn,\n"
                 "--levels and --path: those to calibrate on; default: 16 others than the\n"
                 "test's, evenly spread")
      ->type_name("NAME...");
  sub.add_option("--test", o.test, "Views to test on; default: 8, evenly spread")->type_name("NAME...");
  add_photos_option(sub, o.photos,
                    "DIR/NAME.jpg or .png of the views: tolerances for 0.1 to 0.5 dB;\nwith --turn what each "
                    "order and projection loses");
  sub.add_option("-o,--output", o.output,
                 "Folder for report.html and study.json (out/study);\nwith --stability, --motion, --turn and "
                 "--levels, too")
      ->type_name("DIR");
  add_size_option(sub, o.camera.lens, "Of an eye's picture");
  add_preset_option(sub, o.camera.lens,
                    "preview: 1280 x 720 an eye; headset: 3660 x 3200 an eye, 100 degrees");
  sub.add_flag("--mono", o.rig.mono,
               "With --path, --rules, --motion, --turn and --levels: the cameras themselves, no rig");
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
  sub->add_flag("--stability", o.stability, "Every rule and source on every failure case");
  auto* rules =
      sub->add_flag("--rules", o.rules, "Every rule and source at one error on a still pair, timed");
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
  CLI::Option* motion = add_motion_options(*sub, o.motion);
  CLI::Option* levels = add_levels_options(*sub, o);
  sub->add_option(
         "--frames", o.frames,
         "Timed of each setting in each of three rounds (24; --rules 96);\nwith --motion: that move, of a "
         "segment (60)")
      ->type_name("N")
      ->check(range(1, 10000));
  sub->add_option("--case", o.cases, "Only these cases")->type_name("NAME")->excludes(rules, motion, levels);
  sub->add_option(
         "--path", o.camera.path,
         "Carry one rule along the cameras of this file instead, through keys\n90 frames a second; with "
         "--motion: measure along it")
      ->type_name("FILE");
  sub->add_option("--target", o.target,
                  "dB that tolerances are chosen for (40);\nwith --motion: at which rules are compared")
      ->excludes(sub->get_option("--no-equal"), levels)
      ->type_name("DB")
      ->check(quality_range);
  sub->add_option("--tolerance,--loss", o.tolerance, "Of the rule carried, instead")
      ->excludes(rules, motion, levels)
      ->type_name("X")
      ->check(not_negative);
  sub->add_option("--quality", o.quality,
                  "Steer the rule carried to so many dB;\nwith --motion: every rule (40)")
      ->excludes(rules, levels)
      ->type_name("DB")
      ->check(quality_range);
  const auto of_rule = [&](const char* name, int& into, std::span<const Choice> choices) {
    choose(*sub, name, into, fmt::format("Of the rule carried ({})", choices[into].name), words_of(choices))
        ->excludes(rules, motion, levels);
  };
  of_rule("--th", o.th, th_choices);
  of_rule("--transmittance", o.transmittance, transmittance_choices);
  add_studied_options(*sub, o);
  sub->footer(
      "By itself it repeats AdaGScale's analyses on the scene, as a page with plots.\n"
      "Examples:\n"
      "  binosplat study garden.ply --photos images -o out/garden\n"
      "  binosplat study garden.ply --rules --preset headset\n"
      "  binosplat study garden.ply --motion --rule squared,one --rule squared,last --size 1280x1120\n"
      "  binosplat study garden.ply --turn --preset headset\n"
      "  binosplat study garden-levels --levels --cameras cameras.json --preset headset -o out/levels\n"
      "  binosplat study garden.ply --stability --size 320x320");
  sub->callback([options, sub, &command] {
    for (const char* name : {"--case", "--target", "--tolerance", "--quality", "--th", "--transmittance",
                             "--mono", "--json", "--rays"}) {
      if (sub->count(name) > 0) options->not_for_analyses.emplace_back(name);
    }
    options->scene.name = options->scenes.front();
    options->motion.lengths.moving = static_cast<std::size_t>(options->frames.value_or(60));
    command = [options] { return study_scene(*options); };
  });
}

}  // namespace binosplat::app
