// binosplat bench: the chart of speed against accuracy.

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>

#include "app/bench_plan.h"
#include "app/blind.h"
#include "app/command.h"
#include "app/load_scene.h"
#include "app/option_checks.h"
#include "app/output_options.h"
#include "app/photos.h"
#include "base/log.h"
#include "base/progress.h"
#include "lab/bench.h"
#include "lab/bench_compare.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

/// The shots of a case: as many as the axes want, evenly spread, or all that --view names. Where photos can
/// be compared, only shots that have one count.
std::vector<Shot> choose_shots(const BenchOptions& options, std::size_t wanted, bool photos,
                               std::vector<Shot> shots) {
  if (photos) {
    std::erase_if(shots,
                  [&](const Shot& shot) { return !find_view_photo(options.photos, shot.eyes[0].camera); });
    if (shots.empty()) fail("--photos {}: there is no photo of any view", options.photos);
  }
  if (!options.camera.views.empty()) return shots;
  std::vector<Shot> chosen;
  for (const std::size_t i : lab::spread_evenly(shots.size(), wanted)) chosen.push_back(shots[i]);
  return chosen;
}

/// The views of a case, and a small one to compare with the reference.
lab::Bench open_case(gl::Context& context, const BenchOptions& options, const BenchPlan& plan,
                     const BenchCase& which, const Model& model, const std::optional<lab::Peaks>& peaks) {
  const BenchScene& scene = plan.scenes[which.scene];
  const CameraList list = scene.list.listed
                              ? scene.list
                              : made_up_cameras(scene.options, options.camera, scene.list.known, model);
  const double near_plane = near_plane_of(options.camera, list);
  const bool photos = !options.photos.empty() && which.eyes == 1 && which.size == "own";
  std::vector<Shot> shots = choose_shots(options, static_cast<std::size_t>(plan.axes.views), photos,
                                         make_shots(views_or_all(options.camera.views), lens_of(which),
                                                    rig_of(which), list, near_plane, model.axes));
  leave_out_blind("bench", context, model, near_plane, shots);
  std::vector<lab::BenchView> views;
  for (const Shot& shot : shots) {
    lab::BenchView& view = views.emplace_back(lab::BenchView{shot.name, views_of(shot), {}});
    if (!photos) continue;
    const Camera& of = shot.eyes.front().camera;
    view.photo = load_view_photo(*find_view_photo(options.photos, of), of);
    view.exposure = exposure_of(plan.photos.exposures, shot.name);
  }
  const Camera& camera = shots.front().eyes.front().camera;
  const bool foveated = std::ranges::any_of(
      plan.axes.settings, [](const lab::BenchSettings& settings) { return settings.foveation.has_value(); });
  constexpr int small_width = 160;
  const int width = std::min(small_width, camera.width);
  const int height = std::max(1, static_cast<int>(std::int64_t{camera.height} * width / camera.width));
  return {context,
          model,
          std::move(views),
          make_view(resized(camera, width, height), near_plane),
          {plan.axes.frames, plan.axes.repeats, options.ppd, peaks, foveated, options.far}};
}

/// Where the CPU draws: how long that takes, before it does.
void tell_work(double seconds) {
  constexpr double worth_telling_s = 60.0;
  if (seconds < worth_telling_s) return;
  log_info(
      "without a GPU this takes about {}. For less, give --axes a file such as {{\"views\": 1, \"frames\": "
      "3, "
      "\"repeats\": 2, \"sizes\": [\"240x135\"], \"settings\": [{{\"tiles\": [\"obb\", \"ellipse\"]}}]}}",
      spoken_time(seconds));
}

void measure_all(const BenchOptions& options, const BenchPlan& plan, const BenchFolder& folder) {
  std::vector<std::size_t> missing(plan.points.size());
  std::iota(missing.begin(), missing.end(), std::size_t{0});
  take_share(options.shard, missing);
  const std::size_t of_shard = missing.size();
  std::erase_if(missing, [&](std::size_t point) { return folder.has(point); });
  log_info("{} points to measure{}", missing.size(),
           missing.size() == of_shard
               ? ""
               : fmt::format("; {} are in {}", of_shard - missing.size(), options.output));
  if (missing.empty()) return;
  const auto context = open_context(options.context);

  std::optional<lab::Peaks> peaks;
  if (options.profile) {
    peaks = lab::measure_peaks(*context);
    log_info("at best {:.4g} TB/s, {:.4g} T alphas/s, {:.4g} T multiply-adds/s", 1e-12 * peaks->bytes,
             1e-12 * peaks->alphas, 1e-12 * peaks->fmas);
  }

  Progress progress("measuring", missing.size());
  std::optional<Model> model;
  std::optional<std::size_t> loaded;
  std::size_t done = 0;
  for (const BenchCase& which : plan.cases) {
    std::optional<lab::Bench> bench;
    for (std::size_t s = 0; s < plan.axes.settings.size(); ++s) {
      if (done == missing.size() || missing[done] != which.first + s) continue;
      if (loaded != which.scene) {
        bench.reset();
        model.reset();
        model = load_scene(plan.scenes[which.scene].options, {}, plan.scenes[which.scene].list.cameras);
        loaded = which.scene;
      }
      if (!bench) bench.emplace(open_case(*context, options, plan, which, *model, peaks));
      if (done == 0 && context->software())
        tell_work(1e-3 * bench->work_ms(plan.axes.settings[s], missing.size()));
      folder.save(missing[done], bench->measure(plan.axes.settings[s]));
      progress.update(++done);
    }
  }
}

void print_profile(const std::vector<lab::StageFloor>& stages) {
  for (const lab::StageFloor& stage : stages) {
    if (std::isnan(stage.share)) continue;
    fmt::print("      {:<30}{:>11.3f}  {:.1f} MB{}; floor {:.3f} ms, {:.0f} %\n", stage.stage, stage.ms,
               1e-6 * stage.bytes,
               std::isnan(stage.operations)
                   ? ""
                   : fmt::format(", {:.1f} million operations", 1e-6 * stage.operations),
               stage.floor_ms, 100.0 * stage.share);
  }
}

void print_points(const std::vector<lab::BenchPoint>& points) {
  const std::vector<bool> front = lab::pareto_front(points);
  const bool is_seen =
      std::ranges::any_of(points, [](const lab::BenchPoint& p) { return p.seen.has_value(); });
  std::string chart;
  for (std::size_t i = 0; i < front.size(); ++i) {
    const lab::BenchPoint& p = points[i];
    if (p.chart() != chart)
      fmt::print("\n{}\n{:<36}{:>11}{:>9}{:>9}{:>9}{:>12}{}\n", p.chart(), "  (* on the Pareto front)",
                 "frame ms", "PSNR dB", "SSIM", "FLIP", "pairs", is_seen ? "   seen %" : "");
    chart = p.chart();
    const std::string setting = fmt::format("{} {}", front[i] ? "*" : " ", p.name);
    if (!p.measured()) {
      fmt::print("{:<36}  {}\n", setting, p.problem.empty() ? "not measured yet" : p.problem);
      continue;
    }
    const auto number = [](double value, int digits, const char* none) {
      return std::isnan(value) ? none : fmt::format("{:.{}f}", value, digits);
    };
    fmt::print("{:<36}{:>11.3f}{:>9}{:>9}{:>9}{:>12.0f}{}\n", setting, p.frame_ms,
               number(p.exact.psnr_db, 2, "equal"), number(p.exact.ssim, 4, "-"),
               number(p.exact.flip, 4, "-"), p.pairs,
               p.seen ? fmt::format("{:>9.2f}", 100.0 * p.seen->visible) : "");
    if (p.profile) print_profile(*p.profile);
  }
}

void compare_with_older(const BenchOptions& options, const lab::BenchResults& results) {
  const lab::BenchComparison found = lab::compare_results(load_points(options.compare), results.points);
  fmt::print("\nSince {}:\n{}\n", options.compare, fmt::join(found.lines, "\n"));
  if (!options.fail_if_slower) return;
  if (found.matched == 0)
    fail("--fail-if-slower: no point of this run is in {}: compare runs of the same scenes and axes",
         options.compare);
  if (found.slower_percent > *options.fail_if_slower) {
    throw Error(ExitCode::fell_short,
                fmt::format("{} is {:.1f} % slower than in {}, more than --fail-if-slower {:g}",
                            found.slowest, found.slower_percent, options.compare, *options.fail_if_slower));
  }
  if (found.timed < found.matched) {
    throw Error(ExitCode::fell_short,
                fmt::format("--fail-if-slower: the times of {} of {} points could not be compared with {}",
                            found.matched - found.timed, found.matched, options.compare));
  }
}

ExitCode finish(const BenchOptions& options, const BenchFolder& folder) {
  const lab::BenchResults results = folder.results();
  folder.save_results(results);
  print_points(results.points);
  fmt::print("\n{}: report.html, results.csv, results.json\n", folder.path().string());
  if (!options.compare.empty()) compare_with_older(options, results);
  const auto problems = std::count_if(results.points.begin(), results.points.end(),
                                      [](const lab::BenchPoint& p) { return !p.problem.empty(); });
  if (problems > 0)
    throw Error(ExitCode::fell_short, fmt::format("{} of {} points failed verification and were not timed",
                                                  problems, results.points.size()));
  return ExitCode::done;
}

BenchFolder merge(const BenchOptions& options) {
  const std::vector<std::string> folders =
      separated(options.merge, [](const std::string& text) { return fs::exists(text); });
  const BenchFolder first(folders.front());
  BenchFolder into(options.output, first.plan());
  for (const std::string& name : folders) {
    const BenchFolder from(name);
    if (!from.same_plan(first))
      fail("--merge: {} and {} are shards of different runs (see their plan.json)", folders.front(), name);
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (from.has(i) && !into.has(i)) into.save(i, from.load(i));
    }
  }
  return into;
}

void check_bench(const BenchOptions& options) {
  if (options.merge.empty() == options.scenes.empty())
    fail("bench needs scenes to measure, or --merge and the folders of shards");
  if (!options.merge.empty() && !options.shard.all())
    fail("--shard measures and --merge does not: choose one");
  if (options.scenes.size() > 1 &&
      (!options.camera.file.empty() || !options.photos.empty() || !options.calibration.empty()))
    fail("--cameras, --photos and --calibration are of one scene: bench the scenes one by one");
  if (options.fail_if_slower && options.compare.empty())
    fail("--fail-if-slower goes with --compare: name the results.json of the run that it is to keep up with");
  check(options.context, "auto");
}

/// Photos are of single views in their own size.
void check_photos_of(const BenchPlan& plan, const BenchOptions& options) {
  const ViewChoice choice{options.camera.views, static_cast<std::size_t>(plan.axes.views)};
  for (const BenchCase& which : plan.cases) {
    const CameraList& list = plan.scenes[which.scene].list;
    check_cameras_of(options.photos, list);
    if (!options.photos.empty() && which.eyes == 1 && which.size == "own" && list.listed)
      check_photos(options.photos, photographed_cameras(choice, options.photos, {}, list));
  }
}

ExitCode bench(const BenchOptions& options) {
  check_bench(options);
  check_output(fs::path(options.output) / "results.json");
  if (!options.compare.empty()) load_points(options.compare);  // while nothing is lost
  if (!options.merge.empty()) return finish(options, merge(options));
  const BenchPlan plan = make_plan(options);
  check_photos_of(plan, options);
  const BenchFolder folder(options.output, plan.json);
  measure_all(options, plan, folder);
  return finish(options, folder);
}

}  // namespace

void add_bench(CLI::App& program, Command& command) {
  CLI::App* sub = program.add_subcommand("bench", "Chart speed against accuracy on this GPU");
  const auto o = std::make_shared<BenchOptions>();
  std::string presets;
  for (const std::string& name : lab::axes_presets()) presets += (presets.empty() ? "" : ", ") + name;
  sub->add_option("SCENE", o->scenes, "Models (.ply), demo:room or demo:city");
  sub->add_option("-o,--output", o->output, "Folder for report.html, results.csv and .json (out/bench)")
      ->type_name("DIR");
  sub->add_option("--axes", o->axes,
                  "What is measured: " + presets + ", or a file like those in\nsrc/lab/presets (quick)")
      ->type_name("NAME|FILE");
  sub->add_option("--calibration", o->calibration,
                  "Measure the settings of a file of binosplat calibrate, too")
      ->type_name("FILE");
  sub->add_option("--cameras", o->camera.file, "Cameras, where they are not beside the model")
      ->type_name("FILE");
  add_names_option(*sub, "--view", o->camera.views, "Views by name, instead of the axes' number of them");
  add_photos_options(*sub, *o, "Compare with DIR/NAME.jpg or .png as well");
  add_value(
      *sub, "--far", "DEPTH", o->far, positive,
      "Where the table of --transmittance depth ends, world units; AdaGScale's\nis 100 (fits the scene)");
  add_value(*sub, "--ppd", "N", o->ppd, between(1.0, 1000.0, "a number from 1 to 1000"),
            "For FLIP: pixels per degree that the viewer has (67)");
  sub->add_flag("--profile", o->profile,
                "Set each stage beside what it must move and compute at least, at this GPU's best rates");
  add_measured_options(*sub, *o);
  add_shard_option(*sub, o->shard, "Measure every Nth point from the Ith on: one job of N");
  add_names_option(*sub, "--merge", o->merge, "Join the folders of shards in -o", "DIR");
  sub->add_option("--compare", o->compare, "Print what changed beyond noise since an older results.json")
      ->type_name("FILE");
  add_value(*sub, "--fail-if-slower", "PERCENT", o->fail_if_slower, not_negative,
            "With --compare: end with exit code 1 if a frame time has risen\nbeyond noise, and by more than "
            "PERCENT");
  sub->footer(
      "A run that was ended goes on where it was when it is started again with the same options.\n"
      "Examples:\n"
      "  binosplat bench fox.ply garden.ply -o out/chart\n"
      "  binosplat bench garden.ply --axes headset --compare last/results.json -o out/headset\n"
      "  binosplat bench fox.ply --compare main/results.json --fail-if-slower 3 -o out/ci\n"
      "  binosplat bench fox.ply --axes paper --shard $I/8 -o out/shard$I     # on 8 machines\n"
      "  binosplat bench --merge out/shard1,out/shard2 -o out/chart");
  sub->callback([o, &command] { command = [o] { return bench(*o); }; });
}

}  // namespace binosplat::app
