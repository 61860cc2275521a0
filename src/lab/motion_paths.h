#pragma once
// The head's path along which rules are measured: segments, each after a camera cut and with a stop at its
// end.

#include <cstddef>
#include <string>
#include <vector>

#include "shared/types.h"

namespace binosplat::lab {

/// Successive frames after a camera cut: the lead, in which a rule finds its tolerance, then the moving
/// frames, which count, then the stop at the last pose.
struct MotionSegment {
  std::vector<std::vector<shared::View>> frames;  // the views of each
  std::size_t lead = 0;                           // frames
  std::size_t stop = 0;                           // frames

  std::size_t moving() const { return frames.size() - lead - stop; }
};

struct MotionPath {
  std::string name;
  std::string motion;  // how fast it goes, for readers: "0.3 m/s, 12 degrees a second"
  std::vector<MotionSegment> segments;
};

/// How long segments are, in frames.
struct SegmentLengths {
  std::size_t lead = 0, moving = 60, stop = 15;
};

/// Where `count` stretches of `length` frames begin that are spread evenly over `total` frames, first and
/// last included: fewer where so many would overlap, one at 0 where not even one fits.
std::vector<std::size_t> stretch_starts(std::size_t total, std::size_t length, std::size_t count);

/// The segment that these frames make, with a stop after them. At least half of them move: the lead is
/// shorter where there are few.
MotionSegment segment_of(std::vector<std::vector<shared::View>> frames, const SegmentLengths& lengths);

/// A head that stands still: a lead and the frames that count, no stop.
MotionSegment still_segment(const std::vector<shared::View>& views, const SegmentLengths& lengths);

}  // namespace binosplat::lab
