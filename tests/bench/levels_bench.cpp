// levels_bench measures frame times of a headset's stereo pair along a path through a streamed SOG while its
// levels are read, for several values of --detail, and the PSNR against the finest levels.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

#include "base/clock.h"
#include "base/error.h"
#include "base/statistics.h"
#include "formats/cameras_file.h"
#include "formats/model_file.h"
#include "render/squared_error.h"
#include "stereo/rig.h"
#include "stream/stream.h"

namespace binosplat {
namespace {

using Json = nlohmann::ordered_json;
using Views = std::array<shared::View, 2>;

struct Plan {
  std::string scene, keys, json, timeline;
  std::vector<std::string> details = {"2", "8", "40dB"};
  int frames = 480;    // number of frames along the path
  double rate = 90.0;  // frames per second
  int judged = 8;      // number of evenly spaced frames to compare with the finest levels
  int shrink = 1;
  std::size_t most = any_number;
  std::size_t finest_up_to = few_gaussians;
  render::FrameSettings settings;
};

// Returns the views along straight lines between successive keys, with equal times between keys.
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

std::uint32_t pixels_of(const Views& views) { return 2 * views[0].width * views[0].height; }

// Draws windows of several columns in turn, because the splats of a hundred million Gaussians do not fit one
// buffer. Columns divide the splats most evenly, as most of them are at the horizon.
void draw_in_windows(render::Frame& frame, const Views& views, render::SquaredError& pictures) {
  constexpr std::uint32_t windows = 16;
  const std::uint32_t across = views[0].width, height = views[0].height;
  const std::uint32_t columns = (across / windows + BLEND_CELL - 1) / BLEND_CELL * BLEND_CELL;
  for (std::uint32_t v = 0; v < views.size(); ++v) {
    for (std::uint32_t left = 0; left < across; left += columns) {
      render::ViewRegion window;
      window.corner = {left, 0};
      window.size = {std::min(columns, across - left), height};
      frame.draw({&views[v], 1}, {.regions = {window}});
      pictures.add_window(frame.colours(), window.size, v * across * height + left, across);
    }
  }
}

// Returns the pictures of the finest levels for each frame to compare, and for the last one.
std::deque<render::SquaredError> judge(gl::Context& context, const Plan& plan,
                                       const std::vector<Views>& path) {
  std::deque<render::SquaredError> pictures;
  if (plan.judged == 0) return pictures;
  const Model finest = load_model(plan.scene, {.lod = 0});
  render::Frame frame(context, finest);
  const auto count = static_cast<std::size_t>(plan.judged);
  for (std::size_t k = 0; k < count; ++k)
    draw_in_windows(frame, path[path.size() * k / count], pictures.emplace_back(context));
  draw_in_windows(frame, path.back(), pictures.emplace_back(context));
  return pictures;
}

// Draws for a second: a GPU's clock falls while a model is read, and needs time to rise (less than half a
// second on an H200).
void wake(render::Frame& frame, const Views& views) {
  const auto start = Clock::now();
  while (ms_since(start) < 1000) frame.draw(views);
}

struct Numbers {
  std::vector<double> gaussians, read_gaussians, look_ms, take_ms, frame_ms, all_ms, finest_db, late_s,
      quiet_ms, reported_db, off_db, jump_db, gpu_bytes;
  double rest_db = 0.0;
};

StreamSettings stream_settings(const Plan& plan, const std::string& detail) {
  StreamSettings settings{.finest_up_to = plan.finest_up_to, .reserve = std::size_t{1} << 22};
  char* end = nullptr;
  const double number = std::strtod(detail.c_str(), &end);
  if (end != detail.c_str() && std::string_view(end) == "dB") {
    settings.detail.db = number;
  } else if (end != detail.c_str() && *end == '\0') {
    settings.detail.spacing_px = number;
  } else if (detail == "shared") {
    settings.shares_quality = true;
  } else {
    fail("--detail {}: expected px, or dB as in 40dB, or shared", detail);
  }
  settings.detail.most = plan.most;
  return settings;
}

// Draws the path in real time, as for a headset. Each frame begins when it is due, and draws the levels that
// are loaded by then without waiting. While a frame is compared, the path's clock stops, but levels go on
// loading.
class Flight {
 public:
  Flight(gl::Context& context, const Plan& plan, const std::vector<Views>& path, const std::string& detail)
      : context_(context),
        plan_(plan),
        path_(path),
        stream_(plan.scene, stream_settings(plan, detail)),
        others_(context.allocated_bytes()),
        gpu_model_(stream_.gpu_model(context, plan.settings.precision)),
        frame_(gpu_model_),
        before_(context) {}

  Numbers run(std::deque<render::SquaredError>& finest) {
    const auto start = Clock::now();
    settle(path_.front());
    numbers_.late_s.push_back(1e-3 * ms_since(start));
    wake(frame_, path_.front());
    auto due = Clock::now();
    const auto period =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / plan_.rate));
    for (std::size_t n = 0; n < path_.size(); ++n) {
      std::this_thread::sleep_until(due);
      const auto begin = Clock::now();
      draw(path_[n]);
      note_whether_late(begin);
      due = judge(n, finest) ? Clock::now() : std::max(due + period, begin);
    }
    if (!plan_.timeline.empty()) std::ofstream(plan_.timeline, std::ios::app) << timeline_.dump() << "\n";
    end(finest);
    return std::move(numbers_);
  }

 private:
  render::FrameSettings settings() const {
    render::FrameSettings of_frame = plan_.settings;
    of_frame.quality = static_cast<float>(stream_.frame_quality(of_frame.quality));
    return of_frame;
  }

  bool follow(const Views& views) {
    return stream_.begin_frame(views, plan_.settings, time_for_levels(1e3 / plan_.rate, report_.total_ms));
  }

  void settle(const Views& views) {
    do follow(views);
    while (!stream_.settled());
  }

  void draw(const Views& views) {
    const auto begin = Clock::now();
    const double gaussians = static_cast<double>(stream_.gaussians());
    const bool changed = follow(views);
    const double levels_ms = ms_since(begin);
    const bool looked = !changed && levels_ms > 0.1;  // a visibility pass
    if (looked) numbers_.look_ms.push_back(levels_ms);
    if (!looked) numbers_.take_ms.push_back(levels_ms);
    report_ = frame_.draw(views, settings());
    const double drawn_ms = report_.total_ms;
    numbers_.frame_ms.push_back(drawn_ms);
    if (!changed && !looked) numbers_.quiet_ms.push_back(drawn_ms);
    numbers_.all_ms.push_back(ms_since(begin));
    numbers_.gpu_bytes.push_back(static_cast<double>(context_.allocated_bytes() - others_));
    numbers_.gaussians.push_back(static_cast<double>(stream_.gaussians()));
    const double more = numbers_.gaussians.back() - gaussians;
    if (changed) numbers_.read_gaussians.push_back(more);
    timeline_.push_back({{"look_ms", looked ? levels_ms : 0.0},
                         {"take_ms", looked ? 0.0 : levels_ms},
                         {"new", more},
                         {"gpu_ms", drawn_ms},
                         {"all_ms", numbers_.all_ms.back()}});
  }

  void note_whether_late(Clock::time_point now) {
    if (stream_.settled()) {
      unsettled_.reset();
    } else {
      if (!unsettled_) unsettled_ = now;
      numbers_.late_s.push_back(1e-3 * ms_since(*unsettled_));
    }
  }

  // Compares frame n with the finest levels if it is one of the frames to compare. Returns whether it is.
  bool judge(std::size_t n, std::deque<render::SquaredError>& finest) {
    bool judged = false;
    for (std::size_t k = 0; k + 1 < finest.size(); ++k) {
      if (n != path_.size() * k / (finest.size() - 1)) continue;
      judged = true;
      const double true_db = finest[k].psnr(frame_.colours());
      numbers_.finest_db.push_back(true_db);
      if (const auto reported = reported_db()) {
        numbers_.reported_db.push_back(*reported);
        numbers_.off_db.push_back(*reported - true_db);
        timeline_.back()["reported_db"] = *reported;
      }
      timeline_.back()["true_db"] = true_db;
      jump(path_[n]);
      frame_.draw(path_[n], settings());  // This brings the GPU back to the state before the comparison.
    }
    return judged;
  }

  // Returns the reported PSNR of the last frame, from its levels and from the splats that it skipped.
  std::optional<double> reported_db() const {
    const std::optional<double> of_levels = stream_.reported_db();
    if (plan_.settings.quality == 0.0f) return of_levels;
    return of_levels ? psnr_of_both(*of_levels, report_.quality) : report_.quality;
  }

  // Measures how much a change of levels changes the picture of the same views.
  void jump(const Views& views) {
    const std::int64_t bytes = context_.allocated_bytes();
    before_.clear();
    before_.add(frame_.colours(), pixels_of(views));
    others_ += context_.allocated_bytes() - bytes;
    if (!follow(views)) return;
    frame_.draw(views, settings());
    numbers_.jump_db.push_back(before_.psnr(frame_.colours()));
  }

  // Compares the last frame once all its levels are loaded. Fails if the model on the GPU differs from one
  // that was uploaded whole.
  void end(std::deque<render::SquaredError>& finest) {
    settle(path_.back());
    frame_.draw(path_.back(), settings());
    if (!finest.empty()) numbers_.rest_db = finest.back().psnr(frame_.colours());
    frame_.draw(path_.back());
    render::SquaredError drawn(context_);
    drawn.add(frame_.colours(), pixels_of(path_.back()));
    render::Frame whole(context_, stream_.model());
    whole.draw(path_.back());
    if (drawn.mean(whole.colours()) != 0.0) fail("the model on the GPU is not the one that was read");
  }

  gl::Context& context_;
  const Plan& plan_;
  const std::vector<Views>& path_;
  Stream stream_;
  std::int64_t others_;  // bytes on the GPU that the comparison uses
  std::shared_ptr<render::GpuModel> gpu_model_;
  render::Frame frame_;
  render::FrameReport report_;  // report of the last frame along the path
  render::SquaredError before_;
  Numbers numbers_;
  Json timeline_ = Json::array();
  std::optional<Clock::time_point> unsettled_;
};

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
          {"reported_median_db", at(n.reported_db, 0.5)},
          {"reported_worst_db", at(n.reported_db, 0.0)},
          {"reported_too_good_db", at(n.off_db, 1.0)},
          {"reported_too_bad_db", at(n.off_db, 0.0)},
          {"finest_median_db", at(n.finest_db, 0.5)},
          {"finest_worst_db", at(n.finest_db, 0.0)},
          {"jumps", n.jump_db.size()},
          {"jump_worst_db", at(n.jump_db, 0.0)},
          {"rest_db", n.rest_db}};
}

void print_head(const Json& row) {
  std::string line = "|";
  for (const auto& [key, value] : row.items()) fmt::print("{}{} |", key == "detail" ? "| " : " ", key);
  for (std::size_t k = 0; k < row.size(); ++k) line += "---|";
  fmt::print("\n{}\n", line);
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
  std::deque<render::SquaredError> finest = judge(*context, plan, path);
  for (const std::string& detail : plan.details) {
    const Json row = row_of(detail, Flight(*context, plan, path, detail).run(finest));
    if (&detail == &plan.details.front()) print_head(row);
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
  app.add_option("--detail", plan.details,
                 "px, or dB as in 40dB, or shared: what --quality leaves to levels; one row each (2 8 40dB)");
  app.add_option("--frames", plan.frames, "Frames of the path (480)")->check(CLI::Range(2, 100000));
  app.add_option("--judged", plan.judged, "Frames that are compared with the finest levels (8)")
      ->check(CLI::Range(0, 1000));
  app.add_option("--rate", plan.rate, "Frames a second (90)")->check(CLI::Range(1.0, 1000.0));
  app.add_option("--most", plan.most, "Gaussians of the model, at most");
  app.add_option("--all-up-to", plan.finest_up_to, "By dB: Gaussians of which all are drawn (524288)");
  app.add_option("--quality", plan.settings.quality, "dB, as of `render`");
  app.add_option("--json", plan.json, "Append the rows to this file, a line each");
  app.add_option("--timeline", plan.timeline,
                 "Append what each frame took to this file, a line for each --detail");
  app.add_option("--shrink", plan.shrink, "Pictures so many times smaller: tries it where there is no GPU");
  CLI11_PARSE(app, argc, argv);
  if (plan.settings.quality > 0.0f) plan.settings.th = TH_SQUARED;
  try {
    run_all(plan);
  } catch (const std::exception& error) {
    fmt::print(stderr, "levels_bench: {}\n", error.what());
    return 2;
  }
  return 0;
}
