#pragma once
// What the preview shows: a model, a head in it, choices, and the frame drawn of them. Knows OpenGL, but no
// window: whoever has a context may drive it.

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gl/texture.h"
#include "measure/depth_table.h"
#include "preview/choices.h"
#include "preview/key_list.h"
#include "preview/mark_drawing.h"
#include "preview/navigator.h"
#include "render/frame_record.h"
#include "scene/model.h"
#include "stereo/debug_view.h"
#include "stereo/present.h"
#include "stereo/rig.h"
#include "stream/stream.h"

namespace binosplat::preview {

/// While the head moves, pictures of a fraction of the size are drawn where a frame takes longer than this.
constexpr double moving_ms = 30.0;

/// By what both sides of the next picture are divided while the head moves, 1 to 4, after a frame that was
/// divided by `divisor` and took `ms`. Goes back only where the larger picture would be in time, too.
int next_divisor(int divisor, double ms);

/// A model that was read, or a stream that owns it and has its levels of detail follow what is seen.
struct Loaded {
  Loaded(Model read) : model(std::move(read)) {}
  Loaded(std::unique_ptr<Stream> opened) : stream(std::move(opened)) {}

  const Model& shown() const { return stream ? stream->model() : model; }
  std::size_t gaussians() const { return stream ? stream->gaussians() : model.count(); }

  Model model;
  std::unique_ptr<Stream> stream;
};

/// Where a scene is looked at from.
struct Start {
  std::vector<Camera> cameras;  // to start at the first and step through; not empty
  glm::dvec3 up;                // the world's
  bool listed = true;           // the cameras are a file's or a built-in scene's, and not made up
};

/// What the threshold does to the picture of a head at rest.
struct ThresholdEffect {
  render::FrameReport drawn, exact;
  double psnr = 0.0;  // dB of what is drawn against the exact picture, over both eyes
};

class Session {
 public:
  /// Uploads; the context is current here and in every call. `folder` is where pictures and keys are saved.
  Session(gl::Context& context, Loaded loaded, Start start, Choices wanted, std::filesystem::path folder);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  KeyList keys;
  Navigator head;
  Choices choices;
  bool keeps_size = false;  // frames are no smaller while the head moves

  /// Has the stream's levels, if there is one, follow what the next frame shows, which takes some ms; all
  /// else stays. Throws what reading them threw.
  void follow_levels();
  /// Whether choices ask for a table of transmittance by depth that nobody has measured yet.
  bool needs_depth_table() const;
  /// Measures one more of the views from which it is made, of levels once these have settled. Returns whether
  /// there are more to measure.
  bool measure_depth_table();
  /// How many views were measured of how many; none where nothing is to be measured.
  std::optional<std::pair<std::size_t, std::size_t>> depth_table_progress() const;

  /// None where the model has no levels that follow.
  const Stream* stream() const { return loaded_.stream.get(); }

  /// What is seen next is drawn anew; with thresholds that use what frames measure, until those have settled.
  void change();
  /// The same while the head is under way: frames may be smaller, until it rests.
  void move();
  /// Draws in full what was drawn smaller while the head moved.
  void rest();
  bool moving() const { return moving_; }
  /// By what the sides of the last picture were divided.
  int divisor() const { return divisor_; }
  /// What is shown of it changes, not what is drawn.
  void change_show() { pending_ = std::max(pending_, 1); }
  /// What points upwards in the picture now is up in the world.
  void set_up();
  /// The size of the framebuffer in px; an eye's follows from the layout.
  void resize(const glm::ivec2& framebuffer);
  /// Goes on to the next camera, or back.
  void step_camera(int by);
  /// Back to the camera, with its own field of view.
  void reset_view() { go_to(start_.cameras[camera_]); }
  const std::string& camera_name() const { return start_.cameras[camera_].name; }
  /// That camera's name while the head is there; else that it has left it.
  std::string place_name() const;
  /// Cameras that choices.cameras has drawn; none that were made up.
  bool has_cameras() const { return start_.listed; }
  /// Where choices.grid and choices.cameras have things drawn.
  MarkPlaces mark_places();

  /// Draws a frame if anything changed; false if nothing did, or there is nothing to draw into. What goes
  /// wrong is told by trouble(), and the last picture stays.
  bool draw();
  /// The last frame drawn into the window's framebuffer, or into the two of a stereo window.
  void present();

  /// Turns to what lies at a pixel of the framebuffer, counted from its top left.
  void focus(const glm::ivec2& pixel);
  /// Writes what is shown as PNG, or both eyes with depth as multi-view OpenEXR; returns the file's name.
  std::string save_picture(bool exr);
  // The keys of the path that `render --path` goes along; those that change them return the file's name.
  std::string add_key();
  /// To where the head is.
  std::string move_key(std::size_t k);
  /// Puts the head where a key is, or any camera.
  void go_to(const Camera& camera);
  /// Writes head, up, scale and the eyes' distance to where they are found again (formats/pose_file.h).
  void save_pose(const std::filesystem::path& path) const;
  /// What the threshold does to the last picture. Draws the exact frame, too, the first time that it is asked
  /// of a picture. None while the head moves, and of exact pictures.
  const std::optional<ThresholdEffect>& threshold_effect();
  /// What a view shows, as frames are drawn now.
  Image picture_of(const shared::View& view);

  /// The last frames drawn, newest last.
  const std::deque<render::FrameRecord>& frames() const { return frames_; }
  /// The number of a map's brightest colour (stereo/debug_view.h).
  std::optional<double> most_shown() const { return shown_.most; }
  std::size_t frames_drawn() const { return frames_drawn_; }
  const std::string& trouble() const { return trouble_; }
  /// The convergence that suited the first picture, in m, where that was asked for.
  const std::optional<double>& screen_found() const { return screen_found_; }
  const Model& model() const { return loaded_.shown(); }

  /// What the next frame draws, left eye first; none before there is a size to draw in.
  std::vector<shared::View> views();

 private:
  glm::ivec2 eye_size(int divisor = 1) const;
  Camera head_camera(int divisor = 1) const;
  std::vector<shared::View> views_of(const Camera& camera);
  void draw_at_rest();
  std::string write_picture(bool exr);
  render::FrameSettings settings(std::span<const shared::View> views) const;
  void find_screen();
  bool shows_marks() const;
  render::FrameReport draw_frame(std::span<const shared::View> asked);
  void make_shown(std::span<const shared::View> views);

  gl::Context& context_;
  Loaded loaded_;
  Start start_;
  std::size_t camera_ = 0;
  std::filesystem::path folder_;
  render::Frame frame_;
  stereo::Presenter presenter_;
  stereo::DebugView debug_view_;
  stereo::DebugPictures shown_;  // in place of the frame's own pictures; none: those
  gl::Buffer shown_colours_;     // theirs, as the frame's colours
  glm::ivec2 framebuffer_{0};
  bool moving_ = false;
  int divisor_ = 1;  // of the last frame drawn
  // Where a frame is drawn that is shown enlarged.
  std::unique_ptr<gl::Texture> smaller_;
  std::uint32_t smaller_framebuffer_ = 0;
  // Made at first use; the drawing, which has textures, goes once nothing of it is shown.
  std::unique_ptr<MarkDrawing> mark_drawing_;
  std::optional<MarkGround> mark_ground_;
  std::array<Camera, 2> eyes_;
  int shown_layout_ = LAYOUT_SEPARATE;  // of the last frame drawn, as are
  std::vector<shared::View> drawn_;     // its views as the frame has them
  int pending_ = 1;                     // frames still to draw
  std::size_t frames_drawn_ = 0;
  std::deque<render::FrameRecord> frames_;     // the last ones
  render::FrameLevels levels_;                 // that came since
  std::optional<Clock::time_point> followed_;  // when the next frame's levels were followed
  std::string trouble_;
  std::optional<ThresholdEffect> threshold_effect_;  // of the last frame drawn
  // The table of transmittance by depth, or how far its measurement is.
  std::optional<DepthTable> depth_table_;
  measure::DepthTableMeasurement depth_measurement_{{}};
  std::unique_ptr<render::Frame> depth_frame_;
  std::vector<shared::View> depth_views_;
  std::size_t depth_measured_ = 0;      // of these
  bool seeks_screen_ = false;           // the convergence that suits the first picture,
  std::optional<double> screen_found_;  // m, and what was found
};

}  // namespace binosplat::preview
