#pragma once
// What bench has measured, and the file of it, one JSON object:
//
//   {"format": "binosplat bench", "version": 1, "plan": {...}, "points": [...]}
//
// A point has the names of its chart (scene, eyes, size) and of its settings (settings, name, family), what
// Bench measured of it, or a "problem"; a point of the plan that is not measured yet has neither. Keys are
// the members of BenchPoint with their units: stages_ms, gpu_bytes and the like. Where a picture is equal to
// the exact one its psnr_db is null in the file, and not finite here.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gl/dispatch.h"
#include "lab/floors.h"
#include "lab/page.h"
#include "lab/settings.h"

namespace binosplat::lab {

/// One view against exact, and against its photo where there is one; its disagreement where it has two eyes.
struct ViewNumbers {
  std::string name;
  double psnr_db = NAN, ssim = NAN, flip = NAN;
  double signed_mean = NAN;  // picture minus exact: below 0 is darker
  std::optional<double> disagreement_db;
  std::optional<double> photo_psnr_db, drop_db, photo_ssim, photo_flip;  // drop: lost against the photo
  std::uint64_t pairs = 0, visible = 0;                                  // of a frame
  double alphas = NAN, alphas_visible = NAN;                             // evaluated and blended a pixel
};

/// Means over the views, and the worst of them.
struct ExactNumbers {
  double psnr_db = NAN, worst_psnr_db = NAN;
  std::string worst_view;
  double ssim = NAN, flip = NAN, signed_mean = NAN, disagreement_db = NAN;
};

/// Means over the views that have photos.
struct PhotoNumbers {
  std::size_t views = 0;
  double psnr_db = NAN, drop_db = NAN, ssim = NAN, flip = NAN;
};

/// Pixels between two distances from where an eye looks.
struct RingNumbers {
  double from_degrees = 0, to_degrees = 0;
  double share = 0;                     // of all pixels
  double psnr_db = NAN, visible = NAN;  // against exact; share of them whose difference can be seen
};

/// What eyes that look along their axes see of the differences (measure/foveated.h), over all views.
struct SeenNumbers {
  double visible = NAN;  // share of the pixels
  std::vector<RingNumbers> rings;
};

/// What Bench measures of a point.
struct BenchNumbers {
  std::string device;              // empty: not measured yet
  std::string problem;             // why it was not timed; empty: it was
  double frame_ms = NAN;           // the views' medians, in the mean
  double p99_ms = NAN;             // of all frames
  double noise_ms = NAN;           // half the spread of the repeats; not a number for a single one
  std::vector<double> repeats_ms;  // frame_ms of each repeat
  bool settled = false;            // the clock did
  std::size_t frames = 0;          // timed
  std::int64_t gpu_bytes = 0;
  double submit_ms = NAN;  // CPU
  std::vector<gl::StageTime> stages;
  double pairs = NAN, visible = NAN, alphas = NAN, alphas_visible = NAN;  // of a view, in the mean
  std::optional<std::vector<StageFloor>> profile;
  ExactNumbers exact;
  std::optional<SeenNumbers> seen;  // where a setting of the run is foveated
  std::optional<PhotoNumbers> photos;
  std::vector<ViewNumbers> views;
  std::optional<Image> picture;  // of the first view's first eye, for_page(); not in the JSON

  bool measured() const { return !std::isnan(frame_ms); }  // without a problem
  double psnr_db() const { return std::isnan(exact.psnr_db) ? equal_db : std::min(exact.psnr_db, equal_db); }
};

/// A point of the plan, and what was measured of it.
struct BenchPoint : BenchNumbers {
  std::string scene;
  int eyes = 1;
  std::string size, name, family;
  NamedSettings settings;

  /// What the points of a chart have in common: "fox, both eyes, size own".
  std::string chart(const char* before_size = "size ") const;

  /// Whether it was measured, or tried to be; whether its times are numbers above 0, as those measured are.
  bool is_there() const { return measured() || !device.empty(); }
  bool has_times() const;
};

/// How far times scatter by chance, relative to themselves, as the repeats of points tell.
class TimeNoise {
 public:
  void add(const BenchPoint& point);  // which has times
  bool is_known() const { return freedom_ > 0; }
  /// By how much two times may differ without a cause: in one case of a hundred, one of so many pairs differs
  /// more.
  double between(const BenchPoint& a, const BenchPoint& b, std::size_t pairs) const;

 private:
  double deviation() const { return freedom_ > 0 ? std::sqrt(squares_ / freedom_) : 0.0; }

  double squares_ = 0.0;
  int freedom_ = 0;
};

struct BenchResults {
  std::string axes, program;  // of the plan: their name, its version
  std::vector<BenchPoint> points;
};

void to_json(nlohmann::ordered_json& json, const BenchNumbers& numbers);
void from_json(const nlohmann::ordered_json& json, BenchNumbers& numbers);
void to_json(nlohmann::ordered_json& json, const BenchPoint& point);
void from_json(const nlohmann::ordered_json& json, BenchPoint& point);

/// For each point whether it is on the Pareto front of its chart (same scene, eyes and size): none is both
/// quicker, by more than noise, and nearer to exact.
std::vector<bool> pareto_front(const std::vector<BenchPoint>& points);

/// A line a point, a column a number; empty where it was not measured.
std::string csv(const std::vector<BenchPoint>& points);

/// The charts, by scene, eyes and size.
Page bench_page(const BenchResults& results);

}  // namespace binosplat::lab
