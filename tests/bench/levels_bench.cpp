// levels_bench: frame times of a headset pair along a path through a streamed SOG whose levels are read
// meanwhile, for several --detail, and what the levels cost against the finest.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

#include "base/clock.h"
#include "base/error.h"
#include "base/statistics.h"
#include "formats/cameras_file.h"
#include "formats/level_stream.h"
#include "formats/model_file.h"
#include "render/sight.h"
#include "stereo/rig.h"
#include "study/squared_error.h"

namespace binosplat {
namespace {

using Json = nlohmann::ordered_json;
using Views = std::array<shared::View, 2>;

struct Plan {
  std::string scene, keys, json, timeline;
  std::vector<std::string> details = {"2", "8", "40dB"};
  int frames = 480;    // along the path
  double rate = 90.0;  // a second
  int judged = 8;      // of the frames, evenly spread, against the finest
  int shrink = 1;
  std::size_t gaussians_a_frame = 1 << 14;
  std::size_t most = std::numeric_limits<std::size_t>::max();
  render::FrameSettings settings;
};

// Heads on straight lines from key to key, each at its time or as far from the next as all others.
std::vector<Views> path_of(const Plan& plan) {
  const std::vector<Camera> keys = load_cameras(plan.keys);
  if (keys.size() < 2) fail("{}: a path needs two cameras", plan.keys);
  std::vector<Views> path;
  for (int n = 0; n < plan.frames; ++n) {
    const double at = static_cast<double>(n) * static_cast<double>(keys.size() - 1) / plan.frames;
    const Camera &a = keys[static_cast<std::size_t>(at)], &b = keys[static_cast<std::size_t>(at) + 1];
    const double t = at - std::floor(at);
    const glm::dvec3 eye = glm::mix(a.position, b.position, t);
    const glm::dvec3 ahead = glm::mix(a.rotation[2], b.rotation[2], t),
                     up = -glm::mix(a.rotation[1], b.rotation[1], t);
    const Camera head = stereo::apply_preset(look_at(eye, eye + ahead, up, 60, 1280, 720), "headset");
    path.push_back(
        stereo::make_rig(resized(head, head.width / plan.shrink, head.height / plan.shrink), {}).views);
  }
  return path;
}

// The pictures of the finest levels at the frames that are judged, and at the last.
std::deque<study::SquaredError> judge(gl::Context& context, const Plan& plan,
                                      const std::vector<Views>& path) {
  std::deque<study::SquaredError> pictures;
  if (plan.judged == 0) return pictures;
  const Model finest = load_model(plan.scene, {.lod = 0});
  render::Frame frame(context, finest);
  for (int k = 0; k < plan.judged; ++k) {
    frame.draw(path[path.size() * static_cast<std::size_t>(k) / static_cast<std::size_t>(plan.judged)]);
    pictures.emplace_back(context, frame.read_pictures());
  }
  frame.draw(path.back());
  pictures.emplace_back(context, frame.read_pictures());
  return pictures;
}

// Draws for a while: a GPU's clock falls while a model is read, and takes its time to rise again (an H200
// less than half a second).
void wake(render::Frame& frame, const Views& views) {
  const auto start = Clock::now();
  while (ms_since(start) < 1000) frame.draw(views);
}

struct Numbers {
  std::vector<double> gaussians, read_gaussians, look_ms, take_ms, frame_ms, all_ms, finest_db, late_s,
      quiet_ms, told_db, off_db, gpu_bytes;
  double rest_db = 0.0;
};

DetailNeed need_of(const std::string& detail) {
  char* end = nullptr;
  const double number = std::strtod(detail.c_str(), &end);
  if (end != detail.c_str() && std::string_view(end) == "dB") return {.db = number};
  if (end != detail.c_str() && *end == '\0') return {number};
  fail("--detail {}: expected px, or dB as in 40dB", detail);
}

// Along the path in real time, as a headset would: a frame begins when it is due, draws with the levels that
// have come by then, and nothing waits for those that have not. Judging takes time of its own: then the clock
// stands still, but for what is read meanwhile.
Numbers run(gl::Context& context, const Plan& plan, const std::vector<Views>& path, const std::string& detail,
            std::deque<study::SquaredError>& finest) {
  Numbers numbers;
  DetailNeed need = need_of(detail);
  need.most = plan.most;
  LevelStream levels(plan.scene, [&](const StreamedSog&, std::span<const shared::View>) { return need; });
  Model model = levels.coarsest(path[0]);
  const std::int64_t others = context.allocated_bytes();
  const auto gpu_model = std::make_shared<render::GpuModel>(context, model);
  render::Frame frame(gpu_model);
  render::Sight sight(gpu_model);
  const auto want = [&](const Views& views) {
    levels.want(views, [&](const shared::View& view, Band band, const ModelParts& parts) {
      const auto begin = Clock::now();
      auto seen = sight.look({&view, 1}, plan.settings, parts, render::Sight::shrink_usual, band).front();
      numbers.look_ms.push_back(ms_since(begin));
      return seen;
    });
  };
  const auto start = Clock::now();
  do {
    want(path[0]);
    gpu_model->reload(levels.take(model, plan.gaussians_a_frame));
  } while (!levels.settled());
  numbers.late_s.push_back(1e-3 * ms_since(start));
  wake(frame, path[0]);
  auto due = Clock::now();
  const std::chrono::duration<double> period(1.0 / plan.rate);
  std::optional<Clock::time_point> unsettled;
  Json timeline = Json::array();
  for (std::size_t n = 0; n < path.size(); ++n) {
    std::this_thread::sleep_until(due);
    const auto begin = Clock::now();
    const std::size_t looks = numbers.look_ms.size();
    want(path[n]);
    const auto taking = Clock::now();
    const ModelParts::Changes changes = levels.take(model, plan.gaussians_a_frame);
    gpu_model->reload(changes);
    numbers.take_ms.push_back(ms_since(taking));
    const double drawn_ms = frame.draw(path[n], plan.settings).total_ms;
    numbers.frame_ms.push_back(drawn_ms);
    if (changes.empty() && looks == numbers.look_ms.size()) numbers.quiet_ms.push_back(drawn_ms);
    numbers.all_ms.push_back(ms_since(begin));
    numbers.gpu_bytes.push_back(static_cast<double>(context.allocated_bytes() - others));
    numbers.gaussians.push_back(static_cast<double>(levels.gaussians()));
    std::size_t filled = 0;
    for (const ModelParts::Range& range : changes.filled) filled += range.count;
    timeline.push_back({{"look_ms", looks == numbers.look_ms.size() ? 0.0 : numbers.look_ms.back()},
                        {"take_ms", numbers.take_ms.back()},
                        {"new", filled},
                        {"gpu_ms", drawn_ms},
                        {"all_ms", numbers.all_ms.back()}});
    if (filled > 0) numbers.read_gaussians.push_back(static_cast<double>(filled));
    if (levels.settled()) {
      unsettled.reset();
    } else {
      if (!unsettled) unsettled = begin;
      numbers.late_s.push_back(1e-3 * ms_since(*unsettled));
    }
    due = std::max(due + std::chrono::duration_cast<Clock::duration>(period), begin);
    for (std::size_t k = 0; k + 1 < finest.size(); ++k) {
      if (n != path.size() * k / (finest.size() - 1)) continue;
      const double true_db = finest[k].psnr(frame.colours());
      numbers.finest_db.push_back(true_db);
      if (const auto told = levels.predicted_psnr()) {
        numbers.told_db.push_back(*told);
        numbers.off_db.push_back(*told - true_db);
      }
      due = Clock::now();
    }
  }
  if (!plan.timeline.empty()) std::ofstream(plan.timeline, std::ios::app) << timeline.dump() << "\n";
  // Once all is there, and whether that is what a GPU gets which gets it whole.
  do {
    want(path.back());
    gpu_model->reload(levels.take(model, plan.gaussians_a_frame));
  } while (!levels.settled());
  frame.draw(path.back(), plan.settings);
  if (!finest.empty()) numbers.rest_db = finest.back().psnr(frame.colours());
  study::SquaredError drawn(context, frame.read_pictures());
  render::Frame whole(context, model);
  whole.draw(path.back(), plan.settings);
  if (drawn.mean(whole.colours()) != 0.0) fail("the model on the GPU is not the one that was read");
  return numbers;
}

Json row_of(const std::string& detail, const Numbers& n) {
  const auto at = [](const std::vector<double>& values, double share) {
    return values.empty() ? Json() : Json(quantile(values, share));
  };
  return {{"detail", detail},
          {"gaussians", at(n.gaussians, 0.5)},
          {"gaussians_most", at(n.gaussians, 1.0)},
          {"start_s", n.late_s.front()},
          {"frames_with_new", n.read_gaussians.size()},
          {"new_median", at(n.read_gaussians, 0.5)},
          {"new_most", at(n.read_gaussians, 1.0)},
          {"behind_most_s", at({n.late_s.begin() + 1, n.late_s.end()}, 1.0)},
          {"look_median_ms", at(n.look_ms, 0.5)},
          {"look_max_ms", at(n.look_ms, 1.0)},
          {"take_p99_ms", at(n.take_ms, 0.99)},
          {"take_max_ms", at(n.take_ms, 1.0)},
          {"gpu_median_ms", at(n.frame_ms, 0.5)},
          {"gpu_p99_ms", at(n.frame_ms, 0.99)},
          {"gpu_max_ms", at(n.frame_ms, 1.0)},
          {"all_median_ms", at(n.all_ms, 0.5)},
          {"all_p99_ms", at(n.all_ms, 0.99)},
          {"all_max_ms", at(n.all_ms, 1.0)},
          {"gpu_most_mb", 1e-6 * quantile(n.gpu_bytes, 1.0)},
          {"quiet_p99_ms", at(n.quiet_ms, 0.99)},
          {"told_median_db", at(n.told_db, 0.5)},
          {"told_worst_db", at(n.told_db, 0.0)},
          {"told_too_good_db", at(n.off_db, 1.0)},
          {"told_too_bad_db", at(n.off_db, 0.0)},
          {"finest_median_db", at(n.finest_db, 0.5)},
          {"finest_worst_db", at(n.finest_db, 0.0)},
          {"rest_db", n.rest_db}};
}

void print_row(const Json& row) {
  fmt::print("|");
  for (const auto& [key, value] : row.items()) {
    if (value.is_string()) {
      fmt::print(" {} |", value.get<std::string>());
      continue;
    }
    const bool fine = key.ends_with("_db") || key.ends_with("_ms") || key.ends_with("_s");
    fmt::print(" {} |", value.is_null() ? "-" : fmt::format("{:.{}f}", value.get<double>(), fine ? 2 : 0));
  }
  fmt::print("\n");
  std::fflush(stdout);
}

void run_all(const Plan& plan) {
  const auto context = gl::Context::open();
  const std::vector<Views> path = path_of(plan);
  fmt::print("{}, {} frames of 2 x {} x {} px, {}\n\n", context->renderer(), path.size(), path[0][0].width,
             path[0][0].height, plan.scene);
  fmt::print(
      "| detail | Gaussians | at most | start s | frames with new ones | of these | at most | behind s, at "
      "most | look ms | max | take ms, p99 | max | "
      "GPU ms | p99 | max | with upload and CPU ms | p99 | max | dB to the finest | worst | at rest |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
      "\n");
  std::deque<study::SquaredError> finest = judge(*context, plan, path);
  for (const std::string& detail : plan.details) {
    const Json row = row_of(detail, run(*context, plan, path, detail, finest));
    print_row(row);
    if (!plan.json.empty()) std::ofstream(plan.json, std::ios::app) << row.dump() << "\n";
  }
}

}  // namespace
}  // namespace binosplat

int main(int argc, char** argv) {
  using namespace binosplat;
  CLI::App app("Levels of detail along a path, timed on this machine's GPU.");
  Plan plan;
  app.add_option("scene", plan.scene, "A streamed SOG")->required();
  app.add_option("keys", plan.keys, "cameras.json: heads that the path joins, its directions and ups")
      ->required();
  app.add_option("--detail", plan.details, "px, or dB as in 40dB; one row each (2 8 40dB)");
  app.add_option("--frames", plan.frames, "Frames of the path (480)")->check(CLI::Range(2, 100000));
  app.add_option("--judged", plan.judged, "Frames that are compared with the finest levels (8)")
      ->check(CLI::Range(0, 1000));
  app.add_option("--rate", plan.rate, "Frames a second (90)")->check(CLI::Range(1.0, 1000.0));
  app.add_option("--a-frame", plan.gaussians_a_frame, "Gaussians that may be new in a frame (16384)");
  app.add_option("--most", plan.most, "Gaussians of the model, at most");
  app.add_option("--quality", plan.settings.quality, "dB, as of `render`");
  app.add_option("--json", plan.json, "Append the rows to this file, a line each");
  app.add_option("--timeline", plan.timeline,
                 "Append what each frame took to this file, a line for each --detail");
  app.add_option("--shrink", plan.shrink, "Pictures so many times smaller: tries it where there is no GPU");
  CLI11_PARSE(app, argc, argv);
  try {
    run_all(plan);
  } catch (const std::exception& error) {
    fmt::print(stderr, "levels_bench: {}\n", error.what());
    return 2;
  }
  return 0;
}
