// levels_bench: frame times of a headset pair along a path through a streamed SOG, for several --detail, and
// what the levels cost against the finest.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/error.h"
#include "base/statistics.h"
#include "formats/cameras_file.h"
#include "formats/model_file.h"
#include "formats/streamed_sog.h"
#include "render/frame.h"
#include "stereo/rig.h"
#include "study/squared_error.h"

namespace binosplat {
namespace {

using Json = nlohmann::ordered_json;
using Views = std::array<shared::View, 2>;

struct Plan {
  std::string scene, keys, json;
  std::vector<double> details = {0, 2, 4, 8, 16};  // px
  int frames = 480;                                // along the path
  int judged = 8;  // of them, evenly spread, against the finest; and as many switches
  int shrink = 1;
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

// The pictures of the finest levels at the frames that are judged.
std::vector<std::vector<Picture>> judge(gl::Context& context, const Plan& plan,
                                        const std::vector<Views>& path) {
  const Model finest = load_model(plan.scene);
  render::Frame frame(context, finest);
  std::vector<std::vector<Picture>> pictures;
  for (int k = 0; k < plan.judged; ++k) {
    frame.draw(path[path.size() * static_cast<std::size_t>(k) / static_cast<std::size_t>(plan.judged)]);
    pictures.push_back(frame.read_pictures());
  }
  return pictures;
}

struct Numbers {
  std::vector<double> gaussians, frame_ms, read_ms, upload_ms, finest_db, switch_db;
};

// Draws for a while: a GPU's clock falls while the model is read. A viewer draws on meanwhile.
void wake(render::Frame& frame, const Views& views) {
  const auto start = Clock::now();
  while (ms_since(start) < 150) frame.draw(views);
}

// Along the path; what a switch changes is seen in the exact pair before and after it.
Numbers run(gl::Context& context, const Plan& plan, const std::vector<Views>& path, double detail,
            const std::vector<std::vector<Picture>>& finest) {
  Numbers numbers;
  StreamedSog scene(plan.scene);
  scene.choose(path[0], {detail});
  Model model = scene.read();
  render::Frame frame(context, model);
  wake(frame, path[0]);
  for (std::size_t n = 0; n < path.size(); ++n) {
    std::optional<study::SquaredError> before;
    const bool switches = scene.choose(path[n], {detail});
    if (switches && numbers.switch_db.size() < static_cast<std::size_t>(plan.judged)) {
      frame.draw(path[n]);
      before.emplace(context, frame.read_pictures());
    }
    if (switches) {
      auto start = Clock::now();
      model = scene.read();
      numbers.read_ms.push_back(ms_since(start));
      start = Clock::now();
      frame.model()->reload();
      numbers.upload_ms.push_back(ms_since(start));
      wake(frame, path[n]);
    }
    numbers.frame_ms.push_back(frame.draw(path[n]).total_ms);
    numbers.gaussians.push_back(static_cast<double>(model.count()));
    if (before) numbers.switch_db.push_back(before->psnr(frame.colours()));
    for (std::size_t k = 0; k < finest.size(); ++k) {
      if (n != path.size() * k / finest.size()) continue;
      numbers.finest_db.push_back(study::SquaredError(context, finest[k]).psnr(frame.colours()));
      wake(frame, path[n]);
    }
  }
  return numbers;
}

Json row_of(double detail, const Numbers& n) {
  const auto at = [](const std::vector<double>& values, double share) {
    return values.empty() ? Json() : Json(quantile(values, share));
  };
  return {{"detail_px", detail},
          {"gaussians", at(n.gaussians, 0.5)},
          {"gaussians_most", at(n.gaussians, 1.0)},
          {"frame_median_ms", at(n.frame_ms, 0.5)},
          {"frame_p99_ms", at(n.frame_ms, 0.99)},
          {"frame_max_ms", at(n.frame_ms, 1.0)},
          {"switches", n.read_ms.size()},
          {"read_median_ms", at(n.read_ms, 0.5)},
          {"read_max_ms", at(n.read_ms, 1.0)},
          {"upload_median_ms", at(n.upload_ms, 0.5)},
          {"upload_max_ms", at(n.upload_ms, 1.0)},
          {"finest_median_db", at(n.finest_db, 0.5)},
          {"finest_worst_db", at(n.finest_db, 0.0)},
          {"switch_median_db", at(n.switch_db, 0.5)},
          {"switch_worst_db", at(n.switch_db, 0.0)}};
}

void print_row(const Json& row) {
  fmt::print("|");
  for (const auto& [key, value] : row.items()) {
    const bool fine = key.ends_with("_db") || key.starts_with("frame") || key == "detail_px";
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
      "| detail px | Gaussians | at most | frame ms | p99 | max | switches | read ms | max | upload ms | max "
      "| "
      "dB to the finest | worst | dB across a switch | worst |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const auto finest = judge(*context, plan, path);
  for (const double detail : plan.details) {
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
  app.add_option("--detail", plan.details, "px, one row each (0 2 4 8 16)");
  app.add_option("--frames", plan.frames, "Frames of the path (480)")->check(CLI::Range(2, 100000));
  app.add_option("--judged", plan.judged, "Frames, and switches, that are compared (8)")
      ->check(CLI::Range(1, 1000));
  app.add_option("--json", plan.json, "Append the rows to this file, a line each");
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
