// binosplat bench: charts speed against accuracy, in views, along motions and turns, and by levels of detail.

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <numeric>

#include "app/bench/bench_plan.h"
#include "app/bench/report.h"
#include "app/command.h"
#include "app/open_context.h"
#include "app/options/checks.h"
#include "app/options/options.h"
#include "app/options/parse.h"
#include "base/inputs.h"
#include "base/log.h"
#include "base/progress.h"
#include "lab/bench.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

/// Logs the expected time of a long run on the CPU.
void log_duration_on_cpu(double seconds) {
  constexpr double min_logged_s = 60.0;
  if (seconds < min_logged_s) return;
  log_info(
      "without a GPU this takes about {}. A smaller --suite file is faster, such as {{\"views\": 1, "
      "\"frames\": 3, \"repeats\": 2, \"sizes\": [\"240x135\"], \"settings\": [{{\"tiles\": [\"obb\", "
      "\"ellipse\"]}}]}}",
      spoken_time(seconds));
}

void measure_all(const Options& options, const BenchPlan& plan, const BenchFolder& folder) {
  std::vector<std::size_t> missing(plan.points.size());
  std::iota(missing.begin(), missing.end(), std::size_t{0});
  std::erase_if(missing, [&](std::size_t point) { return folder.has(point); });
  log_info("{} points to measure{}", missing.size(),
           missing.size() == plan.points.size()
               ? ""
               : fmt::format("; {} are in {}", plan.points.size() - missing.size(), options.output));
  if (missing.empty()) return;
  const auto context = open_context(options.context);

  lab::BenchEffort effort{.frames = plan.suite.frames, .repeats = plan.suite.repeats, .ppd = options.ppd};
  effort.perception = plan.suite.perception;
  effort.own_shaders = !options.context.shader_dir.empty();
  effort.seen = std::ranges::any_of(
      plan.suite.settings, [](const lab::BenchSettings& settings) { return settings.foveation.has_value(); });
  Progress progress("measuring", missing.size());
  std::unique_ptr<MeasuredScene> scene;
  std::size_t of_scene = 0, done = 0;
  for (const CasePlan& which : plan.cases) {
    std::unique_ptr<lab::Bench> bench;
    for (std::size_t point = which.first; point < which.first + which.count; ++point) {
      if (done == missing.size() || missing[done] != point) continue;
      if (!scene || of_scene != which.scene) {
        scene.reset();
        scene = std::make_unique<MeasuredScene>(*context, options, plan, of_scene = which.scene);
      }
      if (!bench) {
        bench = std::make_unique<lab::Bench>(
            *context, [&]() -> const Model& { return scene->model(); }, scene->open(which), effort);
      }
      const lab::BenchSettings* settings = plan.settings_of(which, point);
      if (done == 0 && settings != nullptr && context->software())
        log_duration_on_cpu(1e-3 * bench->work_ms(*settings, missing.size()));
      folder.save(point, settings != nullptr ? bench->measure(*settings) : bench->contributions());
      progress.update(++done);
    }
  }
}

void print_points(const std::vector<lab::Point>& points) {
  std::vector<std::string> charts;
  for (const lab::Point& point : points) {
    if (std::ranges::find(charts, point.chart()) == charts.end()) charts.push_back(point.chart());
  }
  for (const std::string& chart : charts) {
    std::vector<lab::Row> rows;
    std::vector<std::string> others;
    for (const lab::Point& point : points) {
      if (point.chart() != chart || lab::text(point.row, "name") == "contributions") continue;
      const bool has_no_finest = point.row.contains("no_exact") && !point.row.contains("frame_ms");
      const std::string problem = lab::text(point.row, has_no_finest ? "no_exact" : "problem");
      if (point.measured() && !has_no_finest) {
        rows.push_back(point.row);
      } else {
        others.push_back(fmt::format("{}: {}", lab::text(point.row, "name"), problem));
      }
    }
    fmt::print("\n{}\n", chart);
    print_table(rows, lab::terminal_columns());
    for (const std::string& other : others) fmt::print("{}\n", other);
  }
}

ExitCode finish(const Options& options, const BenchFolder& folder, const std::vector<lab::Row>& before) {
  const lab::Results results = folder.results();
  folder.save_results(results);
  print_points(results.points);
  fmt::print("\n{}: report.html, results.csv, details.csv, results.json\n", folder.path().string());
  if (!options.older_results.empty()) {
    std::vector<lab::Row> now;
    for (const lab::Point& point : results.points) now.push_back(point.row);
    print_comparison(options.older_results, lab::compare_runs(before, now), options.fail_if_slower);
  }
  const auto problems = std::ranges::count_if(
      results.points, [](const lab::Point& point) { return point.row.contains("problem"); });
  if (problems > 0)
    throw Error(ExitCode::fell_short, fmt::format("{} of {} points failed verification and were not timed",
                                                  problems, results.points.size()));
  return ExitCode::done;
}

void check_bench(const Options& o) {
  if (o.bench.scenes.size() > 1 &&
      ((!o.photos.empty() && o.photos != photos_beside) || !o.drawing.calibration.empty()))
    fail("--photos DIR and --calibration belong to one scene: bench the scenes one by one");
  if (!o.context.shader_dir.empty()) {  // a resumed run must have the same shaders
    for (const fs::path& file : fs::recursive_directory_iterator(o.context.shader_dir)) {
      const std::string ending = file.extension().string();
      if (ending == ".glsl" || ending == ".comp" || ending == ".h") protect_input(file);
    }
  }
  check(o.context);
}

ExitCode bench(const Options& options) {
  check_bench(options);
  check_output(fs::path(options.output) / "results.json");
  // Reads the older results first, before anything can overwrite them.
  const std::vector<lab::Row> before = rows_to_compare(options.older_results);
  const BenchPlan plan = make_plan(options);
  check_cases(plan, options);
  const BenchFolder folder(options, plan);
  measure_all(options, plan, folder);
  return finish(options, folder, before);
}

}  // namespace

void add_bench(CLI::App& program, Command& command) {
  add_command(
      program, command,
      {"bench", in::bench, "Chart speed against accuracy on this GPU",
       "To resume an interrupted run, start it again with the same options.\n"
       "Examples:\n"
       "  binosplat bench fox.ply garden.ply -o out/chart\n"
       "  binosplat bench garden.ply --suite paper --photos images         # AdaGScale's figures and tables\n"
       "  binosplat bench garden.ply --motion walk --rule squared,one --rule squared,last\n"
       "  binosplat bench garden-levels --detail 30dB,40dB --cameras cameras.json\n"
       "  binosplat bench fox.ply --compare main/results.json --fail-if-slower 3 -o out/ci",
       "out/bench"},
      bench);
}

}  // namespace binosplat::app
