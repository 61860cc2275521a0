#include "lab/motion_numbers.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/statistics.h"
#include "lab/fields.h"
#include "lab/settings.h"

namespace binosplat::lab {

namespace {

using nlohmann::ordered_json;

// Requests beyond these are no pictures, or exact ones.
constexpr double request_min = 5.0, request_max = 90.0;
constexpr double step_max = 8.0;  // dB

// Between two requests whose values lie on either side of the target: where a line meets it, not too near to
// an end, so that the bracket shrinks whatever the values do.
double between(const FoundRequest& low, const FoundRequest& high, double target) {
  const double share = (target - low.value) / (high.value - low.value);
  return std::lerp(low.request, high.request, std::isfinite(share) ? std::clamp(share, 0.1, 0.9) : 0.5);
}

}  // namespace

double MovedFrame::true_db() const {
  return std::min(equal_db, *std::min_element(view_db.begin(), view_db.end()));
}

double MovedFrame::reported() const { return std::min(equal_db, reported_db); }

std::vector<MovedFrame> frames_of(const MotionPath& path, const MovedFrames& frames, MotionPart part) {
  std::vector<MovedFrame> chosen;
  for (std::size_t s = 0; s < path.segments.size(); ++s) {
    const auto lead = static_cast<std::ptrdiff_t>(path.segments[s].lead);
    const auto stop = static_cast<std::ptrdiff_t>(path.segments[s].stop);
    const auto begin = frames.at(s).begin() + (part == MotionPart::lead     ? 0
                                               : part == MotionPart::moving ? lead
                                                                            : std::ssize(frames[s]) - stop);
    const auto end = part == MotionPart::lead     ? frames[s].begin() + lead
                     : part == MotionPart::moving ? frames[s].end() - stop
                                                  : frames[s].end();
    chosen.insert(chosen.end(), begin, end);
  }
  return chosen;
}

MotionSummary summary_of(std::span<const MovedFrame> frames) {
  MotionSummary summary{.frames = frames.size()};
  if (frames.empty()) return summary;
  std::vector<double> db, beyond, pairs, exact_pairs, drawn, ms, once;
  for (const MovedFrame& frame : frames) {
    db.push_back(frame.true_db());
    beyond.push_back(frame.reported() - frame.true_db());
    pairs.push_back(frame.pairs);
    exact_pairs.push_back(frame.exact_pairs);
    ms.push_back(frame.ms);
    if (frame.drawn == 1) once.push_back(frame.ms);
    summary.equal +=
        std::all_of(frame.view_db.begin(), frame.view_db.end(), [](double d) { return std::isinf(d); });
    drawn.push_back(frame.drawn);
  }
  summary.true_db = mean(db);
  summary.tenth_db = quantile(db, 0.1);
  summary.worst_db = *std::min_element(db.begin(), db.end());
  summary.reported_beyond = mean(beyond);
  summary.reported_worst = *std::max_element(beyond.begin(), beyond.end(),
                                             [](double a, double b) { return std::abs(a) < std::abs(b); });
  summary.pairs = mean(pairs);
  summary.removed = 1.0 - mean(pairs) / mean(exact_pairs);
  summary.drawn = mean(drawn);
  summary.ms = mean(ms);
  if (!once.empty()) summary.once_ms = mean(once);
  summary.most_ms = *std::max_element(ms.begin(), ms.end());
  return summary;
}

ordered_json to_json(const MotionSummary& s) {
  return object("frames", s.frames, "true_db", s.true_db, "tenth_percentile_db", s.tenth_db, "worst_db",
                s.worst_db, "told_minus_true_db", s.reported_beyond, "told_minus_true_farthest_db",
                s.reported_worst, "pairs", s.pairs, "pairs_removed", s.removed, "drawn", s.drawn, "frame_ms",
                s.ms, "drawn_once_ms", s.once_ms, "most_ms", s.most_ms, "equal_frames", s.equal);
}

ordered_json to_json(const MovedFrames& frames) {
  ordered_json json = ordered_json::array();
  for (const std::vector<MovedFrame>& segment : frames) {
    ordered_json& one = json.emplace_back(ordered_json::object());
    for (const MovedFrame& frame : segment) {
      ordered_json views = ordered_json::array();
      for (const double db : frame.view_db) views.push_back(std::min(equal_db, db));
      one["true_db"].push_back(frame.true_db());
      one["view_db"].push_back(std::move(views));
      one["told_db"].push_back(frame.reported());
      one["pairs"].push_back(frame.pairs);
      one["pairs_removed"].push_back(1.0 - frame.pairs / frame.exact_pairs);
      one["tolerance"].push_back(frame.tolerance);
      one["frame_ms"].push_back(frame.ms);
      one["drawn"].push_back(frame.drawn);
    }
  }
  return json;
}

FoundRequest find_request(const std::function<double(double)>& value, const RequestSearch& search) {
  FoundRequest best{search.start, search.start_value};
  FoundRequest last = best;
  std::optional<FoundRequest> low, high;
  const auto off = [&](const FoundRequest& f) { return std::abs(f.value - search.target); };
  double slope = 1.0;  // of the value over the request
  int evaluations = 0;
  for (;;) {
    (last.value < search.target ? low : high) = last;
    if (off(last) < off(best)) best = last;
    if (off(best) <= search.within || evaluations == search.evaluations) break;
    const double step = std::clamp((search.target - last.value) / slope, -step_max, step_max);
    const double next = low && high ? between(*low, *high, search.target)
                                    : std::clamp(last.request + step, request_min, request_max);
    if (next == last.request) break;  // at an end
    const FoundRequest now{next, value(next)};
    ++evaluations;
    slope = std::clamp((now.value - last.value) / (now.request - last.request), 0.3, 3.0);
    last = now;
  }
  best.evaluations = evaluations;
  best.reached = off(best) <= search.within;
  return best;
}

}  // namespace binosplat::lab
