// Draws the shots of a run, while threads encode and write the earlier ones.

#include <algorithm>
#include <array>
#include <atomic>
#include <deque>
#include <functional>
#include <future>
#include <utility>

#include "app/models/load_scene.h"
#include "app/render/empty_view.h"
#include "app/render/render_run.h"
#include "app/render/shot_settings.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/output_file.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "measure/comparison.h"
#include "render/frame.h"
#include "render/read_back.h"
#include "stereo/comfort.h"
#include "stereo/debug_view.h"
#include "stereo/drawing.h"
#include "stereo/panorama.h"

namespace binosplat::app {

namespace {

// Returns the distance in m of a screen that suits `first`, which all shards share; none for an empty view.
std::optional<double> find_screen(render::Frame& frame, const render::FrameSettings& settings,
                                  const Shot& first) {
  frame.draw(
      std::array{first.eyes[0].view},
      {{.order = settings.order, .projection = settings.projection}, TILES_ELLIPSE, settings.precision});
  const auto metres = stereo::suitable_convergence({first.eyes[0].camera, first.eyes[1].camera},
                                                   frame.read_pictures()[0], first.units_per_metre);
  frame.start_over();
  if (metres)
    log_info("convergence {:.3g} m, which suits what {} shows (--convergence METRES for another, or inf)",
             *metres, first.name);
  return metres;
}

struct ShotPictures {
  std::vector<Picture> pictures;
  std::optional<stereo::DebugPictures> shown;  // none: shows `pictures`
};

bool has_one_colour(const Picture& picture) {
  return std::ranges::all_of(picture.colour, [first = picture.colour[0]](const glm::vec4& c) {
    return glm::all(glm::lessThanEqual(glm::abs(c - first), glm::vec4(0.5f / 255.0f)));
  });
}

constexpr double headset_focus_metres = 2.0;

// Comfort of an eye pair, from the left eye's picture. `headset`: the viewer wears a headset. Returns none
// for one eye or for a picture without depths.
std::optional<Comfort> comfort_of(const Shot& shot, bool headset, const Picture& left) {
  if (shot.eyes.size() != 2) return std::nullopt;
  const std::array<Camera, 2> eyes = {shot.eyes[0].camera, shot.eyes[1].camera};
  // A headset has no screen in the plane of zero disparity, and canted eyes have no such plane.
  const bool canted = glm::dot(eyes[0].rotation[2], eyes[1].rotation[2]) < 1.0 - 1e-9;
  const auto focus = canted || headset ? std::optional(headset_focus_metres * shot.units_per_metre)
                                       : stereo::screen_distance(eyes);
  const auto range = stereo::disparity_range(eyes, left, focus);
  if (!range) return std::nullopt;
  Comfort comfort{*range, focus ? std::optional(*focus / shot.units_per_metre) : std::nullopt, {}};
  const bool own_rig = !shot.given_eyes && !canted && !headset;
  if (own_rig && !stereo::is_comfortable(*range)) {
    comfort.better = stereo::comfortable_rig(*range, eyes);
    comfort.better->convergence /= shot.units_per_metre;
    if (comfort.better->ipd) *comfort.better->ipd /= shot.units_per_metre;
  }
  return comfort;
}

// PSNR of the 8-bit picture against its photo, if --photos names a folder.
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

// Memory of a shot from the GPU to the file: its colours and depths twice, and its encoded bytes.
double bytes_of(const Shot& shot) {
  constexpr double bytes_a_pixel = 2 * 20 + 24;
  double pixels = 0.0;
  for (const Eye& eye : shot.eyes) pixels += double{1} * eye.camera.width * eye.camera.height;
  return bytes_a_pixel * pixels;
}

/// Measures, encodes and writes shots on threads while the next are drawn. Videos receive frames in order.
class ShotWriter {
 public:
  /// Pictures that wait for writing take at most a quarter of the machine's memory, or --max-memory if that
  /// is less; two shots are always allowed. Each shot has its thread, at most one for each core at once.
  explicit ShotWriter(RenderRun& run)
      : run_(run), read_back_(*run.context), video_(open_video(run.outputs, run.shots)) {
    double most = 1.0;
    for (const Shot& shot : run.shots) most = std::max(most, bytes_of(shot));
    const double budget = std::min(0.25 * memory_bytes(), 1e6 * run.options.max_memory.value_or(1e24));
    const double fit = budget / most - 1.0;  // a further shot is on its way from the GPU
    const double useful = std::min<double>(core_count(), static_cast<double>(run.shots.size()));
    run.times.threads = static_cast<int>(std::clamp(fit, 1.0, std::max(1.0, useful)));
  }

  /// Starts a thread that calls `take` for a shot's pictures, and writes their files. It also writes comfort
  /// and PSNR into `drawn`, which must stay in place until finish(). Waits while memory is full. Throws what
  /// an earlier shot's thread threw, such as Error for a file that cannot be written.
  void add(Drawn& drawn, std::function<ShotPictures()> take) {
    wait_until(static_cast<std::size_t>(run_.times.threads) - 1);
    const auto earlier = video_ && !shots_.empty() ? shots_.back() : std::shared_future<void>();
    shots_.emplace_back(std::async(std::launch::async, &ShotWriter::write_shot, this, std::ref(drawn),
                                   std::move(take), earlier));
  }

  /// Requests the pictures of a shot that `frame` has just drawn. queue_pending() receives them.
  void read_back(Drawn& drawn, const render::Frame& frame) {
    pending_ = read_back_.start(frame);
    of_ = &drawn;
  }

  /// Queues the shot whose pictures were requested, if any, after the GPU has copied them.
  void queue_pending() {
    if (!pending_) return;
    const auto begin = Clock::now();
    pending_->wait();
    run_.times.reading += ms_since(begin);
    add(*of_, [taken = std::exchange(pending_, nullptr)] { return ShotPictures{taken->take(), {}}; });
  }

  /// Waits until every file is written. Throws as add() does.
  void finish() {
    queue_pending();
    wait_until(0);
    const auto begin = Clock::now();
    if (video_) video_->finish();
    run_.times.waiting += ms_since(begin);
    run_.times.encoding = 1e-3 * encoding_ms_;
    run_.times.writing = 1e-3 * writing_ms_;
  }

  /// Whether each picture has one colour, and whether it is that of Gaussians and not the background's.
  bool one_colour() const { return one_colour_; }
  bool hides() const { return hides_; }

 private:
  /// Forgets the shots whose files are written, and waits until at most `most` shots are in work.
  void wait_until(std::size_t most) {
    const auto begin = Clock::now();
    const auto is_written = [&] {
      return shots_.front().wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    };
    for (; !shots_.empty() && (shots_.size() > most || is_written()); shots_.pop_front())
      shots_.front().get();
    run_.times.waiting += ms_since(begin);
  }

  /// `earlier`: the shot whose frame precedes this one's in a video, if it is still in work.
  void write_shot(Drawn& drawn, std::function<ShotPictures()> take, std::shared_future<void> earlier) {
    ShotPictures of = std::exchange(take, {})();
    measure(drawn, of.pictures);
    if (!of.shown) of.shown = {std::move(of.pictures), std::nullopt};
    for (const PictureFile& file : drawn.shot.files) {
      const auto begin = Clock::now();
      const std::string bytes = encoded(file, run_.options, run_.outputs, drawn.shot, *of.shown);
      encoding_ms_ += ms_since(begin);
      if (earlier.valid()) std::exchange(earlier, {}).get();
      const auto encoded_at = Clock::now();
      video_ ? video_->add(bytes) : write_file(file.name, bytes);
      writing_ms_ += ms_since(encoded_at);
    }
  }

  void measure(Drawn& drawn, const std::vector<Picture>& pictures) {
    const Options& o = run_.options;
    if (std::ranges::all_of(pictures, has_one_colour)) {
      if (pictures[0].colour[0].a < 1.0f) hides_ = true;
    } else {
      one_colour_ = false;
    }
    if (!run_.outputs.vr180) drawn.comfort = comfort_of(drawn.shot, o.camera.lens.headset(), pictures[0]);
    drawn.photo_psnr = photo_psnr(run_.photos, o.picture.backdrop(), drawn.shot, pictures[0]);
  }

  RenderRun& run_;
  render::ReadBack read_back_;
  std::shared_ptr<render::ReadBack::Pictures> pending_;  // requested from the GPU
  Drawn* of_ = nullptr;                                  // the shot of pending_
  std::unique_ptr<Video> video_;
  std::atomic<bool> one_colour_ = true, hides_ = false;
  std::atomic<double> encoding_ms_ = 0.0, writing_ms_ = 0.0;
  std::deque<std::shared_future<void>> shots_;  // last: destroyed first, which waits for the threads
};

/// Draws shots of a model: frames, or panoramas of many.
struct Drawer {
  Drawer(RenderRun& of, const std::shared_ptr<render::GpuModel>& model)
      : run(of), drawing(model), show(model) {
    if (run.outputs.vr180) panorama.emplace(model, run.shots[0].eyes[0].camera.width);
  }

  RenderRun& run;
  stereo::Drawing drawing;
  stereo::DebugView show;
  std::optional<stereo::Panorama> panorama;

  /// Whether the output needs only the frame's own pictures, which can be read while the next shot is drawn.
  bool reads_asynchronously() const {
    const PictureOptions& o = run.options.picture;
    return !panorama && drawing.parts().empty() && o.show == SHOW_PICTURE;
  }

  /// Loads the levels that a shot needs.
  ShotLevels settle(std::span<const shared::View> views, render::FrameSettings& settings) {
    PictureStream& stream = *run.opened.stream;
    ShotLevels levels;
    levels.switched = stream.settle(views, settings, [&] { show.release(); });
    levels.gaussians = stream.gaussians();
    levels.predicted_psnr = stream.reported_db();
    const PictureStream::Times times = stream.take_times();
    levels.read_ms = times.read_ms;
    levels.upload_ms = times.upload_ms;
    // The frame's threshold may spend the error that the levels leave.
    settings.quality = stream.frame_quality(settings.quality);
    return levels;
  }

  /// Draws a shot. Calls `meanwhile` while the GPU works.
  Report draw(const Shot& shot, const std::vector<shared::View>& views, const render::FrameSettings& settings,
              const std::function<void()>& meanwhile) {
    const Options& o = run.options;
    const render::DebugOptions debug = debug_options_of(o.drawing);
    if (panorama) return panorama->draw(eyes_in_axes(shot, run.model().axes), run.near_plane);
    drawing.submit(views, settings, debug);
    meanwhile();
    return drawing.finish();
  }

  /// The pictures of the drawn shot, if they are read at once.
  ShotPictures read(Drawn& drawn, const std::vector<shared::View>& views,
                    const render::FrameSettings& settings) {
    ShotPictures of{panorama ? panorama->read_pictures() : drawing.read_pictures(), {}};
    const PictureOptions& output = run.options.picture;
    if (output.show != SHOW_PICTURE) {
      of.shown = show.make(output.show, {drawing.frame(), views, of.pictures, settings}, output.background);
      drawn.max_shown = of.shown->max;
    }
    return of;
  }
};

/// Returns whether the near plane hides more than a few Gaussians of a shot, and logs it: as a warning if
/// neither an option nor the training gave the near plane.
bool log_clipping(const RenderRun& run, const Shot& shot) {
  constexpr std::size_t max_ignored = 3;
  const std::size_t cut = count_clipped(run.model(), shot, run.near_plane);
  if (cut <= max_ignored) return false;
  const std::string text = fmt::format(
      "view {}: the near plane of {:.4g} units hides about {} Gaussians before it "
      "(--near for another)",
      shot.name, run.near_plane, cut);
  run.options.camera.near_plane || run.model().near_plane ? log_info("{}", text) : log_warning("{}", text);
  return true;
}

}  // namespace

void draw_all(RenderRun& run) {
  const Options& o = run.options;
  const auto model = run.opened.gpu_model(*run.context, run.settings.precision);
  measure_adagscale(o, model, run.opened.stream != nullptr, run.list, run.near_plane, run.calibrated,
                    run.settings);
  render::FrameSettings settings = run.settings;
  settings.background = o.picture.backdrop();
  Drawer drawer(run, model);
  if (run.screen) run.convergence = find_screen(drawer.drawing.frame(), settings, *run.screen);

  bool has_logged_clipping = false;
  const auto begin = Clock::now();
  ShotWriter files(run);
  Progress progress("drawing", run.shots.size() * static_cast<std::size_t>(o.drawing.frames),
                    o.drawing.frames == 1 ? "views" : "frames");
  run.drawn.reserve(run.shots.size());  // threads hold references to elements
  for (const Shot& shot : run.shots) {
    // Single pictures must not depend on earlier ones.
    if (!run.list.path) drawer.drawing.frame().start_over();
    Drawn& drawn = run.drawn.emplace_back();
    drawn.shot = shot;
    if (run.screen && run.convergence) converge(drawn.shot, *run.convergence);
    if (!run.opened.stream && !has_logged_clipping) has_logged_clipping = log_clipping(run, drawn.shot);
    const std::vector<shared::View> views = views_of(drawn.shot);
    render::FrameSettings of_shot = settings_of(run.calibrated, drawn.shot, settings, run.model().axes);
    of_shot.depth = o.picture.exr_depth.value_or(DepthKind::mean);
    if (run.opened.stream) drawn.levels = drawer.settle(views, of_shot);
    for (int n = 0; n < o.drawing.frames; ++n) {
      drawn.report = drawer.draw(drawn.shot, views, of_shot, [&] { files.queue_pending(); });
      run.frames.push_back(drawn.report);
      run.times.gpu += drawn.report.gpu_ms;
      progress.update(run.frames.size());
    }
    drawn.foveated = drawer.drawing.parts();
    if (drawer.reads_asynchronously()) {
      files.read_back(drawn, drawer.drawing.frame());
    } else {
      const auto pictures = std::make_shared<ShotPictures>(drawer.read(drawn, views, of_shot));
      files.add(drawn, [pictures] { return std::move(*pictures); });
    }
  }
  files.finish();
  run.times.all = ms_since(begin);
  if (!files.one_colour() || o.drawing.reference_until) return;
  if (files.hides())
    log_warning(
        "the pictures have one colour: the camera stands within Gaussians, or before a plain surface "
        "(--frame "
        "all shows the whole model)");
  else
    log_warning("the pictures are empty: {}", why_empty(run.model(), run.drawn[0].shot, run.near_plane));
}

}  // namespace binosplat::app
