#include "preview/session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/path_questions.h"
#include "base/thread_spans.h"
#include "formats/cameras/pose_file.h"
#include "formats/pictures/exr.h"
#include "formats/pictures/image_file.h"
#include "measure/metrics.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "shared/layout.h"
#include "stereo/comfort.h"
#include "stereo/layout.h"

namespace binosplat::preview {

namespace {

constexpr std::size_t frames_kept = 240;

// The median view depth of the Gaussians ahead of a camera.
double depth_ahead(const Model& model, const Camera& of_world) {
  const Camera camera = into_axes(of_world, model.axes);
  std::vector<double> depths;
  const std::size_t step = std::max<std::size_t>(1, model.count() / 10000);
  for (std::size_t i = 0; i < model.count(); i += step) {
    const double z = glm::dot(camera.rotation[2], glm::dvec3(model.position[i]) - camera.position);
    if (z > 0.0 && model.opacity[i] > 0.0f) depths.push_back(z);
  }
  if (depths.empty()) return 1.0;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

}  // namespace

int next_divisor(int divisor, double ms) {
  constexpr int most = 4;
  // The next larger picture has at most four times the pixels.
  if (ms < moving_ms / 4.0) return std::max(1, divisor - 1);
  return ms > moving_ms ? std::min(most, divisor + 1) : divisor;
}

glm::ivec2 eye_size_in(int layout, const glm::ivec2& all) {
  switch (layout) {
    case LAYOUT_PARALLEL:
    case LAYOUT_CROSS_EYED:
      return {all.x / 2, all.y};
    case LAYOUT_HALF_WIDTH:
      return {all.x / 2 * 2, all.y};
    case LAYOUT_HALF_HEIGHT:
      return {all.x, all.y / 2 * 2};
    case LAYOUT_OVER_UNDER:
      return {all.x, all.y / 2};
    default:
      return all;
  }
}

Session::Session(gl::Context& context, OpenedModel<Stream> opened, Start start, Choices wanted,
                 std::filesystem::path folder)
    : keys(folder),
      head(start.cameras.at(0), start.up, depth_ahead(opened.model(), start.cameras[0])),
      choices(std::move(wanted)),
      context_(context),
      opened_(std::move(opened)),
      start_(std::move(start)),
      folder_(std::move(folder)),
      frame_(opened_.gpu_model(context, choices.settings.precision)),
      presenter_(context),
      debug_view_(frame_.model()),
      shown_colours_(context, "pixels to show"),
      seeks_screen_(choices.seeks_screen) {
  if (seeks_screen_) choices.rig.convergence.reset();
}

Session::~Session() { context_.gl().DeleteFramebuffers(1, &smaller_framebuffer_); }

void Session::move() {
  moving_ = true;
  change();
}

void Session::rest() {
  moving_ = false;
  if (divisor_ > 1) change();
}

void Session::change() {
  make_consistent(choices);
  threshold_effect_.reset();
  const render::FrameSettings& s = choices.settings;
  pending_ = render::measures(s) || s.quality ? 2 * render::settling_frames : 1;
}

void Session::resize(const glm::ivec2& framebuffer) {
  if (framebuffer == framebuffer_) return;
  framebuffer_ = framebuffer;
  change();
}

void Session::step_camera(int by) {
  const int count = static_cast<int>(start_.cameras.size());
  camera_ = static_cast<std::size_t>(((static_cast<int>(camera_) + by) % count + count) % count);
  go_to(start_.cameras[camera_]);
}

std::string Session::place_name() const {
  const Camera start = Navigator(start_.cameras[camera_], start_.up, 1.0).camera();
  const bool is_there = start.position == head.camera().position && start.rotation == head.camera().rotation;
  return is_there ? camera_name() : fmt::format("away from {} (R: back)", camera_name());
}

void Session::go_to(const Camera& camera) {
  head = Navigator(camera, start_.up, depth_ahead(model(), camera));
  change();
}

void Session::show_all() {
  Camera camera = head_camera();
  if (camera.width < 1 || camera.height < 1 || model().count() == 0) return;
  camera.cx = 0.5 * camera.width;
  camera.cy = 0.5 * camera.height;
  PictureShape shape = shape_of(camera);
  // An eye sees less on one side, where its frustum is shifted or turned to the other.
  const stereo::RigSettings& rig = choices.rig;
  const double shift =
      rig.convergence ? 0.5 * rig.ipd / *rig.convergence : std::tan(glm::radians(std::abs(rig.cant_degrees)));
  shape.tan_x = std::max(0.2 * shape.tan_x, shape.tan_x - shift);
  const Capture capture = find_viewpoint(model(), shape, start_.up, 0.0, Viewpoint::Kind::whole).capture;
  const Camera placed = first_camera(capture, camera.width, camera.height);
  const double back = 0.5 * rig.ipd * rig.units_per_metre / shape.tan_x;  // for eyes beside the head
  camera.rotation = placed.rotation;
  camera.position = placed.position - back * placed.rotation[2];
  head = Navigator(camera, start_.up, glm::distance(camera.position, capture.around->middle));
  change();
}

Camera Session::head_camera(int divisor) const {
  const glm::ivec2 size = eye_size(divisor);
  return resized(head.camera(), size.x, size.y);
}

void Session::set_up_direction() {
  start_.up = -head.camera().rotation[1];
  head = Navigator(head.camera(), start_.up, head.distance());
  mark_ground_.reset();
  if (shows_marks()) change();
}

// Debug views pass through the CPU, so they are slower than pictures.
void Session::make_shown(std::span<const shared::View> views) {
  shown_ = {};
  if (choices.show == SHOW_PICTURE) {
    debug_view_.release();
    return;
  }
  const std::vector<Picture> pictures = frame_.read_pictures();
  const render::FrameSettings of_frame = settings(views);
  shown_ =
      debug_view_.make(choices.show, {frame_, views, pictures, of_frame}, choices.background, choices.split);
  std::vector<glm::vec4> colours;
  for (const Picture& picture : shown_.pictures)
    colours.insert(colours.end(), picture.colour.begin(), picture.colour.end());
  shown_colours_.upload(colours);
}

render::FrameSettings Session::settings(std::span<const shared::View> views) const {
  if (choices.flipped) {
    render::FrameSettings exact = render::exact_of(choices.settings);
    exact.precision = choices.settings.precision;
    exact.background = choices.background;
    return exact;
  }
  render::FrameSettings of_frame = choices.calibrated.settings(choices.settings, views.front(), model().axes);
  if (opened_.stream) of_frame.quality = opened_.stream->frame_quality(of_frame.quality);
  return of_frame;
}

MarkPlaces Session::mark_places() {
  if (!mark_ground_) mark_ground_ = find_mark_ground(model(), start_.up);
  return places_of(*mark_ground_, start_.cameras, choices.rig.units_per_metre);
}

// Debug views show frames without marks.
bool Session::shows_marks() const {
  return choices.show == SHOW_PICTURE &&
         (choices.grid || (choices.cameras && has_cameras()) || (ruler && !ruler->empty()));
}

Report Session::draw_frame(std::span<const shared::View> asked) {
  if (!shows_marks()) {
    mark_drawing_.reset();
    return frame_.draw(asked, settings(asked));
  }
  const glm::dvec3 here = head.camera().position;
  std::vector<Line> lines;
  const auto add = [&](const std::vector<Line>& more) {
    lines.insert(lines.end(), more.begin(), more.end());
  };
  if (choices.grid) add(grid_lines(mark_places()));
  if (choices.cameras && has_cameras())
    add(camera_lines(start_.cameras, camera_, here, mark_places().camera_size));
  if (ruler) add(ruler_lines(*ruler, here));
  if (!mark_drawing_) mark_drawing_ = std::make_unique<MarkDrawing>(context_);
  return mark_drawing_->draw(frame_, asked, eyes_, settings(asked), lines);
}

void Session::follow_levels() {
  if (!opened_.stream) return;
  followed_ = Clock::now();
  levels_.ms = 0.0;
  const TimedSpan span("levels", &levels_.ms);
  const bool has_changed = opened_.stream->begin_frame(views(), choices.settings, max_levels_ms);
  levels_.uploaded += opened_.stream->take_times().put;
  if (!has_changed) return;
  debug_view_.release();
  change();
}

std::vector<shared::View> Session::views() {
  const glm::ivec2 size = eye_size();
  if (size.x < 1 || size.y < 1) return {};
  const auto seen = stereo::make_rig(head_camera(), choices.rig, model().axes).views;
  return {seen.begin(), seen.end()};
}

bool Session::draw() {
  const bool interlaced = choices.layout == LAYOUT_ROWS || choices.layout == LAYOUT_COLUMNS;  // never scaled
  const bool shrinks = moving_ && !keeps_size && !interlaced && !frames_.empty();
  const int divisor = shrinks ? next_divisor(divisor_, frames_.back().report.gpu_ms) : 1;
  const glm::ivec2 size = eye_size(divisor);
  if (pending_ == 0 || size.x < 1 || size.y < 1) return false;
  --pending_;
  try {
    const stereo::EyePair pair = stereo::make_rig(head_camera(divisor), choices.rig, model().axes);
    const std::vector<shared::View> asked(pair.views.begin(), pair.views.end());
    eyes_ = pair.cameras;
    divisor_ = divisor;
    render::FrameRecord frame{.views = asked, .gaussians = opened_.gaussians()};
    frame.begin = frame.due = std::exchange(followed_, {}).value_or(Clock::now());
    frame.report = draw_frame(asked);
    frame.end = Clock::now();
    frame.levels = std::exchange(levels_, {});
    frames_.push_back(std::move(frame));
    shown_layout_ = choices.layout;
    drawn_ = frame_.views();
    threshold_effect_.reset();
    make_shown(asked);
    trouble_.clear();
  } catch (const Error& error) {
    if (error.code() == ExitCode::no_gl) throw;
    trouble_ = error.what();
    pending_ = 0;
    return true;
  }
  if (frames_.size() > frames_kept) frames_.pop_front();
  ++frames_drawn_;
  if (seeks_screen_ && shown_layout_ != LAYOUT_SEPARATE) find_screen();
  return true;
}

// Called only once a model: a screen whose distance changes while the head moves causes dizziness.
void Session::find_screen() {
  seeks_screen_ = false;
  if (choices.rig.convergence || choices.rig.cant_degrees != 0.0) return;
  screen_found_ = stereo::suitable_convergence(eyes_, frame_.read_pictures()[0], choices.rig.units_per_metre);
  choices.rig.convergence = screen_found_;
  if (screen_found_) change();
}

void Session::present() {
  if (frames_drawn_ == 0) return;
  const shared::View& eye = drawn_[0];
  const glm::ivec2 size =
      stereo::layout_size(shown_layout_, {static_cast<int>(eye.width), static_cast<int>(eye.height)});
  Target target;
  if (divisor_ == 1) {
    target.y = std::max(0, framebuffer_.y - size.y);
  } else {
    if (smaller_framebuffer_ == 0) context_.gl().CreateFramebuffers(1, &smaller_framebuffer_);
    if (!smaller_ || !smaller_->is(GL_RGBA8, size.x, size.y)) {
      smaller_ = std::make_unique<gl::Texture>(context_, GL_RGBA8, size.x, size.y);
      context_.gl().NamedFramebufferTexture(smaller_framebuffer_, GL_COLOR_ATTACHMENT0, smaller_->id(), 0);
    }
    target.texture = smaller_->id();
  }
  const gl::Buffer& colours = shown_.pictures.empty() ? frame_.colours() : shown_colours_;
  const auto draw = [&](std::size_t first, int layout) {
    presenter_.draw(colours, drawn_, first, layout, target, choices.background);
    if (divisor_ > 1) {
      context_.gl().BlitNamedFramebuffer(smaller_framebuffer_, 0, 0, 0, size.x, size.y, 0, 0, framebuffer_.x,
                                         framebuffer_.y, GL_COLOR_BUFFER_BIT, GL_LINEAR);
    }
  };
  if (shown_layout_ != LAYOUT_QUAD_BUFFER) return draw(0, shown_layout_);
  context_.gl().DrawBuffer(GL_BACK_LEFT);
  draw(0, LAYOUT_SEPARATE);
  context_.gl().DrawBuffer(GL_BACK_RIGHT);
  draw(1, LAYOUT_SEPARATE);
  context_.gl().DrawBuffer(GL_BACK);  // the left and the right buffer
}

// Functions that read a picture need it in full size.
void Session::draw_at_rest() {
  rest();
  draw();
}

std::optional<glm::dvec3> Session::point_at(const glm::ivec2& pixel) {
  draw_at_rest();
  if (frames_drawn_ == 0) return std::nullopt;
  const shared::View& eye = drawn_[0];
  const auto layout = static_cast<shared::uint>(shown_layout_);
  const shared::LayoutSource from = shared::layout_source(
      layout, static_cast<shared::uint>(pixel.x), static_cast<shared::uint>(pixel.y), eye.width, eye.height);
  const std::size_t side = from.eye == EYE_RIGHT ? 1 : 0;
  if (from.x >= eye.width || from.y >= eye.height) return std::nullopt;
  const Image depth = depth_map(frame_.read_pictures()[side]);
  const float z = depth.at(static_cast<int>(from.x), static_cast<int>(from.y), 0);
  if (!std::isfinite(z)) return std::nullopt;
  const Camera& camera = eyes_[side];
  return camera.position + static_cast<double>(z) * ray_through(camera, glm::dvec2(from.x, from.y) + 0.5);
}

void Session::focus(const glm::ivec2& pixel) {
  const auto point = point_at(pixel);
  if (!point) return;
  head.focus(*point);
  change();
}

bool Session::add_to_ruler(const glm::ivec2& pixel) {
  const auto point = point_at(pixel);
  if (!point) return false;
  const double cross = 0.02 * glm::distance(*point, head.camera().position);  // the size of the first point's
  if (!ruler->empty() && glm::distance(*point, ruler->front()) < cross) return false;
  ruler->push_back(*point);
  change();
  return true;
}

std::optional<double> Session::ruler_length() const {
  if (!ruler || ruler->size() < 2) return std::nullopt;
  return glm::distance((*ruler)[0], (*ruler)[1]);
}

void Session::set_ruler_length(double metres) {
  choices.rig.units_per_metre = *ruler_length() / metres;
  ruler.reset();
  change();
}

std::string Session::save_picture(bool exr) {
  const glm::ivec2 window = framebuffer_;
  const double larger = choices.saved_width / static_cast<double>(std::max(1, window.x));
  if (choices.saved_width > 0) resize({choices.saved_width, std::max(1l, std::lround(larger * window.y))});
  try {
    draw_at_rest();
    if (!trouble_.empty()) fail("{}", trouble_);
    std::string file = write_picture(exr);
    resize(window);
    return file;
  } catch (...) {
    resize(window);
    throw;
  }
}

std::string Session::write_picture(bool exr) {
  const std::vector<Picture> pictures = frame_.read_pictures();
  const auto path = free_name(folder_, "preview", exr ? ".exr" : ".png");
  if (exr) {
    save_exr(path, pictures[0], pictures[1], {.half = false, .background = choices.background});
  } else {
    const std::vector<Picture>& eyes = shown_.pictures.empty() ? pictures : shown_.pictures;
    const int layout = shown_layout_ == LAYOUT_QUAD_BUFFER ? LAYOUT_PARALLEL : shown_layout_;
    const Picture both =
        layout == LAYOUT_SEPARATE ? eyes[0] : stereo::lay_out(layout, eyes[0], eyes[1], choices.background);
    save_png(path, composite(both, choices.background));
  }
  return path.string();
}

std::string Session::add_key() {
  keys.add(head_camera());
  return keys.file().string();
}

std::string Session::move_key(std::size_t k) {
  keys.replace(k, head_camera());
  return keys.file().string();
}

void Session::save_pose(const std::filesystem::path& path, bool keeps_pose) const {
  SavedPose pose{head_camera(), start_.up, choices.rig.units_per_metre, choices.rig.ipd,
                 choices.rig.near_plane};
  pose.camera.name = "saved";
  if (keeps_pose && is_there(path)) {
    pose = load_pose(path);
    pose.units_per_metre = choices.rig.units_per_metre;
  }
  binosplat::save_pose(path, pose);
}

const std::optional<ThresholdEffect>& Session::threshold_effect() {
  const bool is_at_rest = !moving_ && divisor_ == 1 && pending_ == 0 && frames_drawn_ > 0;
  if (threshold_effect_ || !is_at_rest || choices.flipped || is_exact(choices.settings) || shows_marks())
    return threshold_effect_;
  const std::vector<shared::View> now = views();
  const std::vector<Picture> shown = frame_.read_pictures();
  ThresholdEffect effect{.drawn = frames_.back().report};
  const std::vector<Picture> exact = debug_view_.exact(now, choices.settings);
  effect.exact = debug_view_.exact_report();
  effect.psnr = measure::psnr(shown, exact, choices.background);
  threshold_effect_ = std::move(effect);
  return threshold_effect_;
}

Image Session::picture_of(const shared::View& view) {
  render::Frame other(frame_.model());  // keeps the shown picture
  other.draw({&view, 1}, settings({&view, 1}));
  return composite(other.read_pictures().front(), choices.background);
}

}  // namespace binosplat::preview
