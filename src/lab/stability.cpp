#include "lab/stability.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "measure/depth_table.h"
#include "render/frame.h"

namespace binosplat::lab {

namespace {

constexpr double settled_within_db = 1.0;

struct Exact {
  std::vector<std::vector<Picture>> pictures;  // by frame
  std::vector<double> pairs;
  render::DepthTable table;
};

bool equal_eyes(const stereo::EyePair& a, const stereo::EyePair& b) {
  return a.cameras[0].position == b.cameras[0].position && a.cameras[0].rotation == b.cameras[0].rotation;
}

// A still camera's exact frame is drawn once.
Exact exact_frames(render::Frame& frame, const StabilityCase& one) {
  Exact exact;
  for (std::size_t n = 0; n < one.frames.size(); ++n) {
    if (n > 0 && equal_eyes(one.frames[n], one.frames[n - 1])) {
      exact.pairs.push_back(exact.pairs.back());
      continue;
    }
    exact.pairs.push_back(static_cast<double>(frame.draw(one.frames[n].views).pairs));
    exact.pictures.push_back(frame.read_pictures());
  }
  std::vector<shared::View> first(one.frames[0].views.begin(), one.frames[0].views.end());
  exact.table = measure::measure_depth_table(frame, first);
  return exact;
}

double median(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  return quantile({values.begin() + static_cast<std::ptrdiff_t>(begin),
                   values.begin() + static_cast<std::ptrdiff_t>(end)},
                  0.5);
}

std::string verdict_of(const StabilityResult& r, const StabilityBounds& bounds) {
  std::vector<std::string> broken;
  if (r.worst_db < bounds.worst_db) broken.emplace_back("dips");
  if (r.settled_db < bounds.settled_db) broken.emplace_back("wrong");
  if (r.drift_db < -bounds.drift_db) broken.emplace_back("drifts");
  if (r.settling > bounds.settling) broken.emplace_back("slow");
  if (r.signed_mean < -bounds.darkening) broken.emplace_back("darkens");
  if (r.signed_mean > bounds.darkening) broken.emplace_back("brightens");
  if (r.disagreement_db < bounds.disagreement_db) broken.emplace_back("rivalry");
  return broken.empty() ? "holds" : fmt::format("{}", fmt::join(broken, ", "));
}

StabilityResult summary(const std::vector<FrameErrors>& frames, std::size_t event, bool still,
                        const StabilityBounds& bounds) {
  StabilityResult r;
  std::vector<double> db;
  r.disagreement_db = std::numeric_limits<double>::infinity();
  for (const FrameErrors& errors : frames) {
    db.push_back(errors.psnr);
    r.largest = std::max(r.largest, errors.largest);
    r.p99 = std::max(r.p99, errors.p99);
    r.edges = std::max(r.edges, errors.edges);
    if (std::abs(errors.signed_mean) > std::abs(r.signed_mean)) r.signed_mean = errors.signed_mean;
    // Not a number where the eyes have no depth in common.
    if (errors.disagreement < r.disagreement_db) r.disagreement_db = errors.disagreement;
  }
  const auto worst = std::min_element(db.begin(), db.end());
  r.worst_db = *worst;
  r.worst_frame = static_cast<std::size_t>(worst - db.begin());
  const std::size_t third = std::max<std::size_t>(1, db.size() / 3);
  r.settled_db = median(db, db.size() - third, db.size());
  if (still && db.size() >= 3 && std::isfinite(r.settled_db))
    r.drift_db = r.settled_db - median(db, db.size() - 2 * third, db.size() - third);
  for (std::size_t n = event; n < db.size(); ++n) {
    if (db[n] < std::min(r.settled_db - settled_within_db, bounds.settled_db)) r.settling = n + 1 - event;
  }
  r.verdict = verdict_of(r, bounds);
  return r;
}

StabilityResult run_variant(render::Frame& frame, const StabilityCase& one, const Exact& exact,
                            const Variant& variant, const StabilityBounds& bounds) {
  render::FrameSettings settings = variant.settings();
  settings.depth_table = exact.table;
  // Of a still camera the frames that do not measure show what the next one shows: nothing new.
  if (exact.pictures.size() == 1) settings.record_every = 1;
  frame.forget();
  std::vector<FrameErrors> errors;
  double pairs = 0.0, exact_pairs = 0.0;
  std::size_t at = 0;
  for (std::size_t n = 0; n < one.frames.size(); ++n) {
    if (n > 0 && !equal_eyes(one.frames[n], one.frames[n - 1])) ++at;
    pairs += static_cast<double>(frame.draw(one.frames[n].views, settings).pairs);
    exact_pairs += exact.pairs[n];
    errors.push_back(
        judge(one.frames[n].views, exact.pictures[at], frame.read_pictures(), settings.tile_size));
  }
  StabilityResult result = summary(errors, one.event, at == 0, bounds);
  result.removed = 1.0 - pairs / exact_pairs;
  return result;
}

}  // namespace

render::FrameSettings Variant::settings() const {
  return {.th = th, .transmittance = transmittance, .tolerance = tolerance};
}

std::string Variant::name() const {
  if (render::is_exact(th)) return th_choices[th].name;
  return fmt::format("{}, {}", th_choices[th].name, transmittance_choices[transmittance].name);
}

std::vector<Variant> all_variants() {
  std::vector<Variant> variants;
  for (int th = 0; th < std::ssize(th_choices); ++th) {
    for (int source = 0; source < std::ssize(transmittance_choices); ++source) {
      if (render::takes(th, source)) variants.push_back({th, source});
    }
  }
  return variants;
}

std::vector<StabilityResult> run_case(gl::Context& context, const StabilityCase& one,
                                      const std::vector<Variant>& variants, const StabilityBounds& bounds,
                                      const std::function<void()>& progress) {
  render::Frame frame(context, *one.model);
  const Exact exact = exact_frames(frame, one);
  std::vector<StabilityResult> results;
  for (const Variant& variant : variants) {
    results.push_back(run_variant(frame, one, exact, variant, bounds));
    progress();
  }
  return results;
}

}  // namespace binosplat::lab
