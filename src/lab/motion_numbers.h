#pragma once
// What is reported and measured of frames that follow one another, and what many of them come to.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "lab/motion_paths.h"

namespace binosplat::lab {

/// One frame of a rule beside the exact one.
struct MovedFrame {
  std::vector<double> view_db;  // each eye's, of 8-bit pictures; infinite for equal ones
  double reported_db = 0.0;     // what the frame said of itself
  double pairs = 0.0;           // its probe's included
  double exact_pairs = 0.0;
  double tolerance = 0.0;
  double ms = 0.0;  // GPU time, by itself: the median of the rounds; 0 before any
  int drawn = 1;    // times, until it held what it was asked for: ms are of all, the rest is of the last

  /// The worse eye's; for equal pictures equal_db of settings.h, which is in no case exceeded.
  double true_db() const;
  double reported() const;  // likewise
};

/// By segment.
using MovedFrames = std::vector<std::vector<MovedFrame>>;

/// Means over frames unless said otherwise.
struct MotionSummary {
  std::size_t frames = 0;
  double true_db = 0.0;
  double tenth_db = 0.0;  // a tenth of the frames are no better
  double worst_db = 0.0;
  double reported_beyond = 0.0;  // reported minus true
  double reported_worst = 0.0;   // the one of these that is farthest from 0
  double pairs = 0.0;
  double removed = 0.0;  // share of the exact frames' pairs, all frames together
  double drawn = 0.0;    // times
  double ms = 0.0;
  double once_ms = 0.0;   // of the frames that were drawn once; 0 for none
  double most_ms = 0.0;   // the frame that took longest
  std::size_t equal = 0;  // frames whose pictures are equal
};

enum class MotionPart { lead, moving, stop };

/// The frames of that part of every segment, in their order.
std::vector<MovedFrame> frames_of(const MotionPath& path, const MovedFrames& frames, MotionPart part);

/// All 0 for no frames.
MotionSummary summary_of(std::span<const MovedFrame> frames);

nlohmann::ordered_json to_json(const MotionSummary& summary);

/// Each number as a list over the frames of a segment.
nlohmann::ordered_json to_json(const MovedFrames& frames);

/// A request in dB, and what came of it.
struct FoundRequest {
  double request = 0.0;
  double value = 0.0;
  int evaluations = 0;
  bool reached = false;  // as near as asked
};

struct RequestSearch {
  double target = 40.0;
  double start = 40.0;        // asked before the search
  double start_value = 40.0;  // what came of it
  double within = 0.1;
  int evaluations = 8;
};

/// The request whose value(request) is the target, as near as asked; where none is found, the nearest
/// that was asked. `value` is to rise with the request, and need not do so quite steadily.
FoundRequest find_request(const std::function<double(double)>& value, const RequestSearch& search);

}  // namespace binosplat::lab
