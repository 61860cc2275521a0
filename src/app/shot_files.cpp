#include "app/shot_files.h"

#include <algorithm>
#include <utility>

#include "app/command_line.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "measure/comparison.h"

namespace binosplat::app {

namespace {

bool is_empty(const Picture& picture) {
  return std::all_of(picture.colour.begin(), picture.colour.end(),
                     [](const glm::vec4& c) { return c.a == 1.0f; });
}

// PSNR of the picture as 8 bits would keep it against the photo, where there is a folder of them.
std::optional<double> photo_psnr(const PhotoSource& photos, const glm::vec3& background, const Shot& shot,
                                 const Picture& picture) {
  if (photos.folder.empty()) return std::nullopt;
  const auto file = find_view_photo(photos.folder, shot.eyes.front().camera);
  if (!file) {
    log_info("no photo of {} in {}", shot.name, photos.folder);
    return std::nullopt;
  }
  const Image photo = load_view_photo(*file, shot.eyes.front().camera, background);
  return measure::photo_psnr(composite(picture, background), exposure_of(photos.exposures, shot.name), photo);
}

// Memory of a shot from the GPU to the file: twice its colours and depths, and what they are encoded to.
double bytes_of(const Shot& shot) {
  constexpr double bytes_a_pixel = 2 * 20 + 24;
  double pixels = 0.0;
  for (const Eye& eye : shot.eyes) pixels += double{1} * eye.camera.width * eye.camera.height;
  return bytes_a_pixel * pixels;
}

// Adds the time for which it lives.
class Timed {
 public:
  explicit Timed(std::atomic<std::int64_t>& ns) : ns_(ns) {}
  ~Timed() { ns_ += static_cast<std::int64_t>(1e6 * ms_since(start_)); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  std::atomic<std::int64_t>& ns_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

ShotFiles::ShotFiles(const RenderOptions& options, const OutputPlan& plan, const PhotoSource& photos,
                     const std::vector<Shot>& shots)
    : options_(options), plan_(plan), photos_(photos), video_(open_video(plan, shots)) {
  double most = 1.0;
  for (const Shot& shot : shots) most = std::max(most, bytes_of(shot));
  const double budget = std::min(0.25 * memory_bytes(), picture_memory_allowed.load());
  // Besides one that waits and one that is on its way from the GPU.
  const double fit = budget / most - 2.0;
  const double useful = std::min<double>(core_count(), static_cast<double>(shots.size()));
  threads_ = static_cast<int>(std::clamp(fit, 1.0, std::max(1.0, useful)));
  queue_ = std::make_unique<JobQueue>(threads_, 1);
}

void ShotFiles::add(Drawn& drawn, std::function<ShotPictures()> take) {
  const auto taken = [this, &drawn, take = std::move(take)] {
    ShotPictures of = take();
    look_at(drawn, of.pictures);
    if (!of.shown) of.shown = {std::move(of.pictures), std::nullopt};
    return of;
  };
  if (!video_) return queue_->add([this, &drawn, taken] { write_files(drawn, taken()); });
  drawn.files = {plan_.video.string()};
  const auto frame = std::make_shared<std::vector<std::uint8_t>>();
  queue_->add([this, taken, frame] { *frame = frame_for_video(taken()); },
              [this, frame] { add_to_video(*frame); });
}

void ShotFiles::look_at(Drawn& drawn, const std::vector<Picture>& pictures) {
  if (!std::all_of(pictures.begin(), pictures.end(), is_empty)) all_empty_ = false;
  if (!plan_.vr180) drawn.comfort = comfort_of(drawn.shot, options_.camera.lens.headset(), pictures[0]);
  drawn.photo_psnr = photo_psnr(photos_, options_.output.backdrop(), drawn.shot, pictures[0]);
}

std::vector<std::uint8_t> ShotFiles::frame_for_video(const ShotPictures& of) {
  const Timed timed(encoding_ns_);
  return Video::bytes_of(frame_of(plan_, options_.output.background, of.shown->pictures));
}

void ShotFiles::add_to_video(const std::vector<std::uint8_t>& frame) {
  const Timed timed(writing_ns_);
  video_->add(frame);
}

void ShotFiles::write_files(Drawn& drawn, const ShotPictures& of) {
  std::vector<EncodedFile> files;
  {
    const Timed timed(encoding_ns_);
    const std::string& model = drawn.shot.model.empty() ? options_.scene.name : drawn.shot.model;
    files = encode_outputs(model, options_.output, plan_, drawn.shot, *of.shown);
  }
  const Timed timed(writing_ns_);
  for (const EncodedFile& file : files) {
    write_file(file.name, file.bytes);
    drawn.files.push_back(file.name);
  }
}

void ShotFiles::finish() {
  queue_->finish();
  if (video_) video_->finish();
}

}  // namespace binosplat::app
