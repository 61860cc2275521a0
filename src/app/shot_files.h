#pragma once
// What becomes of a shot's pictures while the next shots are drawn: they are judged, encoded and written on
// all cores.

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/photos.h"
#include "app/render_outputs.h"
#include "app/render_report.h"
#include "base/job_queue.h"

namespace binosplat::app {

/// A shot's pictures, and what is shown of them.
struct ShotPictures {
  std::vector<Picture> pictures;
  std::optional<stereo::DebugPictures> shown;  // none: the pictures
};

class ShotFiles {
 public:
  /// `photos`: to compare with, where there is a folder of them. `shots`: those to come. Pictures that are
  /// drawn and not written yet take a quarter of the machine's memory at most, or what --max-memory allows if
  /// that is less; those of three shots in any case. There are as many threads as cores where memory allows
  /// that. A video gets its frames one by one, in order.
  ShotFiles(const RenderOptions& options, const OutputPlan& plan, const PhotoSource& photos,
            const std::vector<Shot>& shots);

  /// Takes a shot, whose pictures `take` hands out on another thread; until finish() its files, comfort and
  /// PSNR of `drawn` are to come, which must stay where it is. Waits while there is no memory for more.
  /// Throws Error for a file of this or an earlier shot that could not be written; then no other is begun.
  void add(Drawn& drawn, std::function<ShotPictures()> take);

  /// Waits until all is written. Throws as add() does.
  void finish();

  /// Whether no picture shows anything.
  bool all_empty() const { return all_empty_; }

  /// Seconds of all threads together that encoding, and writing, have taken.
  double encoding_seconds() const { return 1e-9 * static_cast<double>(encoding_ns_.load()); }
  double writing_seconds() const { return 1e-9 * static_cast<double>(writing_ns_.load()); }
  int threads() const { return threads_; }
  bool is_video() const { return video_ != nullptr; }

 private:
  void look_at(Drawn& drawn, const std::vector<Picture>& pictures);
  std::vector<std::uint8_t> frame_for_video(const ShotPictures& of);
  void add_to_video(const std::vector<std::uint8_t>& frame);
  void write_files(Drawn& drawn, const ShotPictures& of);

  const RenderOptions& options_;
  const OutputPlan& plan_;
  const PhotoSource& photos_;
  std::unique_ptr<Video> video_;
  std::atomic<bool> all_empty_ = true;
  std::atomic<std::int64_t> encoding_ns_ = 0, writing_ns_ = 0;
  int threads_ = 1;
  std::unique_ptr<JobQueue> queue_;  // last: its jobs end first
};

}  // namespace binosplat::app
