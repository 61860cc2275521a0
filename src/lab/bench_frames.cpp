// Measures a point along successive frames: true quality, reported quality and time of each.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/log.h"
#include "base/statistics.h"
#include "lab/bench.h"
#include "lab/bench_drawer.h"
#include "lab/times.h"
#include "measure/flip.h"

namespace binosplat::lab {

namespace {

constexpr std::int64_t exact_bytes = std::int64_t{8} << 30;  // memory for exact frames on the GPU

bool is_exact(const Row& frame) { return frame.contains("exact"); }
bool is_moving(const Row& frame) { return text(frame, "phase") == "moving"; }

/// Stores a summary of the moving frames and of the frames at rest after them. Of a setting that draws some
/// frames exactly, the dB are those of the other frames.
void put_summary(const std::vector<Row>& frames, double exact_pairs, Row& row) {
  std::vector<Row> moving, stop;
  for (const Row& frame : frames) (is_moving(frame) ? moving : stop).push_back(frame);
  for (const char* name : {"pairs", "visible", "gaussians"}) put(row, name, mean_number(moving, name));
  const double all_pairs = mean_number(moving, "pairs");
  if (moving.front().contains("reported_db")) {
    const auto percent = [&](const char* reason) {
      const auto exact = std::ranges::count(moving, reason, [](const Row& f) { return text(f, "exact"); });
      return 100.0 * static_cast<double>(exact) / static_cast<double>(moving.size());
    };
    put(row, "exact_frames", 100.0 - percent(""), "unmeasured", percent(name_of(ExactReason::unmeasured)),
        "no_gain", percent(name_of(ExactReason::no_gain)));
    if (std::ranges::any_of(moving, std::not_fn(is_exact))) std::erase_if(moving, is_exact);
  }
  put(row, "reported_db", mean_number(moving, "reported_db"));
  if (!moving.front().contains("psnr_db")) return;  // no exact frames to compare with
  const std::vector<double> db = numbers(moving, "psnr_db");
  const Row& worst = *std::ranges::min_element(moving, {}, [](const Row& f) { return number(f, "psnr_db"); });
  put(row, "pairs_removed", 100.0 * (1.0 - all_pairs / exact_pairs), "psnr_db", mean(db), "tenth_psnr_db",
      quantile(db, 0.1), "worst_psnr_db", quantile(db, 0.0), "worst_view",
      fmt::format("stretch {}, frame {}", worst["stretch"].get<int>(), worst["frame"].get<int>()),
      "stop_psnr_db", mean_number(stop, "psnr_db"), "equal_frames", std::ranges::count(db, equal_db));
  if (moving.front().contains("reported_db")) {
    std::vector<double> beyond;
    for (const Row& frame : moving) beyond.push_back(number(frame, "reported_db") - number(frame, "psnr_db"));
    put(row, "reported_minus_true_db", mean(beyond), "reported_farthest_db",
        *std::ranges::max_element(beyond, [](double a, double b) { return std::abs(a) < std::abs(b); }));
  }
}

}  // namespace

std::vector<std::size_t> stretch_starts(std::size_t total, std::size_t length, std::size_t count) {
  count =
      std::clamp<std::size_t>(total / std::max<std::size_t>(length, 1), 1, std::max<std::size_t>(count, 1));
  const std::size_t last = total > length ? total - length : 0;
  if (count == 1) return {last / 2};
  std::vector<std::size_t> starts;
  for (std::size_t k = 0; k < count; ++k) starts.push_back(k * last / (count - 1));
  return starts;
}

ExactFrames& Bench::exact_frames(const BenchSettings& settings) {
  const OrderAndProjection seen = order_and_projection(settings);
  if (!exact_frames_ || exact_frames_key_ != seen) {
    exact_frames_.reset();
    exact_frames_ = std::make_unique<ExactFrames>(gpu_model(), settings, what_.stretches, exact_bytes);
    exact_frames_key_ = seen;
  }
  return *exact_frames_;
}

void Bench::measure_frames(const BenchSettings& settings, BenchDrawer& drawer, Point& point) {
  ExactFrames* const exact = has_finest(point.row) ? &exact_frames(settings) : nullptr;
  std::vector<Row>& frames = point.details;
  double exact_pairs = 0.0, moving = 0.0;
  for (std::size_t s = 0; s < what_.stretches.size(); ++s) {
    const Stretch& stretch = what_.stretches[s];
    drawer.frame().start_over();
    for (std::size_t n = 0; n < stretch.frames.size(); ++n) {
      const LoadedLevels levels = drawer.load_levels(stretch.frames[n]);
      const Report report = drawer.draw(stretch.frames[n]);
      Row& row = frames.emplace_back(object("kind", "frame", "stretch", s + 1, "frame", frames.size(),
                                            "phase", n < stretch.moving ? "moving" : "stop"));
      if (exact != nullptr) {
        const std::vector<double> db = exact->psnr(drawer.frame(), s, n);
        put(row, "psnr_db", capped(*std::ranges::min_element(db)));
        if (n < stretch.moving) {
          exact_pairs += exact->pairs(s, n);
          moving += 1.0;
        }
      }
      put(row, "reported_db", levels.predicted_db, "pairs", report.pairs, "visible", report.visible,
          "gaussians", levels.gaussians, "tolerance", report.tolerance);
      if (report.exact != ExactReason::not_exact) put(row, "exact", name_of(report.exact));
      if (settings.quality) put(row, "reported_db", capped(report.quality));
      if (s == 0 && n == 0)
        point.picture = for_page(composite(drawer.read_pictures().front(), glm::vec3(0.0f)));
    }
  }
  time_frames(drawer, point);
  put_summary(frames, exact_pairs / moving, point.row);
}

// Times frames in separate passes, which read no picture back.
void Bench::time_frames(BenchDrawer& drawer, Point& point) {
  std::vector<std::vector<double>> ms(point.details.size());
  std::vector<double> repeats, of_frames;
  std::vector<CpuUse> cpu_repeats;
  std::vector<Typical> turns;
  std::size_t differs = 0;
  bool full_clock = true;
  const Stretch& first = what_.stretches.front();
  gl::raise_clock(context_, 1000.0, [&] { drawer.draw(first.frames.front()); });
  for (int repeat = 0; repeat < effort_.repeats; ++repeat) {
    std::size_t at = 0;
    std::vector<double> moving;
    CpuUse cpu, used;
    for (const Stretch& stretch : what_.stretches) {
      Reports drawn;
      const auto draw = [&] {
        drawer.frame().start_over();
        drawn.clear();
        used = {};
        for (const std::vector<shared::View>& frame : stretch.frames) {
          drawer.load_levels(frame);
          const CpuUse before = CpuUse::now(context_);
          drawn.push_back(drawer.draw(frame));
          if (drawn.size() <= stretch.moving) used += CpuUse::now(context_).since(before);
        }
      };
      full_clock = clock_.measure(draw) && full_clock;
      cpu += used;
      for (const Report& report : drawn) {
        ms[at].push_back(report.gpu_ms);
        differs += static_cast<double>(report.pairs) != number(point.details[at++], "pairs");
      }
      drawn.resize(std::min(drawn.size(), stretch.moving));
      for (const Report& report : drawn) moving.push_back(report.gpu_ms);
      turns.push_back(typical_of(drawn));
    }
    repeats.push_back(mean(moving));
    const auto frames = static_cast<double>(moving.size());
    if (context_.software()) cpu_repeats.push_back({cpu.used / frames, cpu.waited / frames});
  }
  for (std::size_t k = 0; k < ms.size(); ++k) {
    const double median = quantile(ms[k], 0.5);
    put(point.details[k], "frame_ms", median);
    if (is_moving(point.details[k])) of_frames.push_back(median);
  }
  put_clock(full_clock, point.row);
  put_times(repeats, of_frames, point.row);
  put_cpu_times(cpu_repeats, point.row);
  put_stages(mean_of(turns).stages, point.row);
  if (differs > 0) log_warning("{} timed frames have other numbers of pairs than the measured ones", differs);
}

}  // namespace binosplat::lab
