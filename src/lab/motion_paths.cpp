#include "lab/motion_paths.h"

#include <algorithm>

namespace binosplat::lab {

std::vector<std::size_t> stretch_starts(std::size_t total, std::size_t length, std::size_t count) {
  count =
      std::clamp<std::size_t>(total / std::max<std::size_t>(length, 1), 1, std::max<std::size_t>(count, 1));
  const std::size_t last = total > length ? total - length : 0;
  if (count == 1) return {last / 2};
  std::vector<std::size_t> starts;
  for (std::size_t k = 0; k < count; ++k) starts.push_back(k * last / (count - 1));
  return starts;
}

MotionSegment segment_of(std::vector<std::vector<shared::View>> frames, const SegmentLengths& lengths) {
  MotionSegment segment{std::move(frames), 0, lengths.stop};
  segment.lead = std::min(lengths.lead, segment.frames.size() / 2);
  const std::vector<shared::View> last = segment.frames.back();
  segment.frames.insert(segment.frames.end(), lengths.stop, last);
  return segment;
}

MotionSegment still_segment(const std::vector<shared::View>& views, const SegmentLengths& lengths) {
  return {{lengths.lead + lengths.moving, views}, lengths.lead, 0};
}

}  // namespace binosplat::lab
