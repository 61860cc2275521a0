#pragma once
// The preview's state: a model, a head in it, choices, and the drawn frame. Needs a context, but no window.

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gl/texture.h"
#include "preview/camera_key_list.h"
#include "preview/mark_drawing.h"
#include "preview/navigator.h"
#include "preview/viewer_choices.h"
#include "render/profiled_frame.h"
#include "scene/model.h"
#include "stereo/debug_view.h"
#include "stereo/present.h"
#include "stream/opened_model.h"
#include "stream/stream.h"

namespace binosplat::preview {

/// While the head moves, pictures are smaller if a frame takes longer than this.
constexpr double moving_ms = 30.0;

/// The divisor (1 to 4) of the next picture's sides while the head moves, after a frame with `divisor` that
/// took `ms`. It decreases only if the larger picture would be fast enough.
int next_divisor(int divisor, double ms);

/// Returns the size in px of an eye's picture in a layout that fills `all`.
glm::ivec2 eye_size_in(int layout, const glm::ivec2& all);

struct Start {
  std::vector<Camera> cameras;  // the head starts at the first; not empty
  glm::dvec3 up;                // the world's
  bool listed = true;           // the cameras come from a file or a built-in scene, not from the model
};

/// The effect of the threshold on a picture.
struct ThresholdEffect {
  Report drawn, exact;
  double psnr = 0.0;  // dB against the exact picture, over both eyes
};

class Session {
 public:
  /// Uploads the model. The context must be current here and in every call. Pictures and keys go to `folder`.
  Session(gl::Context& context, OpenedModel<Stream> opened, Start start, Choices wanted,
          std::filesystem::path folder);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  KeyList keys;
  Navigator head;
  Choices choices;
  std::optional<std::vector<glm::dvec3>> ruler;  // points of a measurement of the scale, at most two
  bool keeps_size = false;                       // draws in full size even while the head moves

  /// Updates the stream's levels, if any, for the next frame. Takes some ms. Rethrows errors of reading.
  void follow_levels();
  /// Null without levels.
  const Stream* stream() const { return opened_.stream.get(); }

  /// Requests a new frame. If thresholds use measurements, requests frames until measurements have settled.
  void change();
  /// As change() while the head moves: frames may be smaller until the head rests.
  void move();
  /// Ends the movement. Draws in full size if the last frame was smaller.
  void rest();
  bool moving() const { return moving_; }
  int divisor() const { return divisor_; }
  /// Requests a single frame, after a change of the debug view only.
  void change_show() { pending_ = std::max(pending_, 1); }
  /// Makes the picture's upward direction the world's up.
  void set_up_direction();
  /// Sets the framebuffer's size in px. The layout determines the size of an eye.
  void resize(const glm::ivec2& framebuffer);
  /// Goes to the next camera (`by` 1) or the previous one (-1).
  void step_camera(int by);
  /// Returns to the current camera, with its field of view.
  void reset_view() { go_to(start_.cameras[camera_]); }
  /// Moves the head so that both eyes see the whole model, upright. The middle of the model is the target.
  void show_all();
  const std::string& camera_name() const { return start_.cameras[camera_].name; }
  /// The current camera's name, or a text that says that the head is away from the camera.
  std::string place_name() const;
  /// Whether choices.cameras has cameras to show: listed ones, not cameras made from the model.
  bool has_cameras() const { return start_.listed; }
  /// Marks that choices.grid and choices.cameras show.
  MarkPlaces mark_places();

  /// Draws a frame if anything changed. Returns false if nothing changed or the size is zero. On an Error,
  /// trouble() has the message, and the last picture stays.
  bool draw();
  /// Presents the last frame in the window's framebuffer; in a stereo window, in the left and right buffers.
  void present();

  /// The world's point at a pixel of the framebuffer, counted from its top left. None on the background.
  std::optional<glm::dvec3> point_at(const glm::ivec2& pixel);
  /// Turns the head to that point.
  void focus(const glm::ivec2& pixel);
  /// Adds that point to the ruler. Returns false on the background, and beside the first point.
  bool add_to_ruler(const glm::ivec2& pixel);
  /// The distance between the ruler's two points in world units; none before both are there.
  std::optional<double> ruler_length() const;
  /// Sets the scale so that the ruler is as long as this.
  void set_ruler_length(double metres);
  /// Saves the shown picture as PNG, or both eyes with depth as OpenEXR (`exr`). Returns the file's name.
  std::string save_picture(bool exr);
  // Keys of the path for `render --path`. Changing functions return the file's name.
  std::string add_key();
  /// Moves a key to the head's place.
  std::string move_key(std::size_t k);
  void go_to(const Camera& camera);
  /// Saves head, up, scale and eye distance (formats/cameras/pose_file.h). With `keeps_pose`, only the scale
  /// changes in a file that exists.
  void save_pose(const std::filesystem::path& path, bool keeps_pose = false) const;
  /// The threshold's effect on the last picture. The first call for a picture also draws the exact frame.
  /// None while the head moves, and for exact pictures.
  const std::optional<ThresholdEffect>& threshold_effect();
  /// Draws a view with the current settings.
  Image picture_of(const shared::View& view);

  /// The last frames drawn, newest last.
  const std::deque<render::FrameRecord>& frames() const { return frames_; }
  /// The value of a map's brightest colour (stereo/debug_view.h).
  std::optional<double> max_shown() const { return shown_.max; }
  std::size_t frames_drawn() const { return frames_drawn_; }
  const std::string& trouble() const { return trouble_; }
  /// The convergence that suited the first picture, in m, if choices.seeks_screen requested it.
  const std::optional<double>& screen_found() const { return screen_found_; }
  const Model& model() const { return opened_.model(); }

  /// The views of the next frame, left eye first; empty before the first resize().
  std::vector<shared::View> views();

 private:
  glm::ivec2 eye_size(int divisor = 1) const { return eye_size_in(choices.layout, framebuffer_ / divisor); }
  Camera head_camera(int divisor = 1) const;
  void draw_at_rest();
  std::string write_picture(bool exr);
  render::FrameSettings settings(std::span<const shared::View> views) const;
  void find_screen();
  bool shows_marks() const;
  Report draw_frame(std::span<const shared::View> asked);
  void make_shown(std::span<const shared::View> views);

  gl::Context& context_;
  OpenedModel<Stream> opened_;
  Start start_;
  std::size_t camera_ = 0;
  std::filesystem::path folder_;
  render::Frame frame_;
  stereo::Presenter presenter_;
  stereo::DebugView debug_view_;
  stereo::DebugPictures shown_;  // shown instead of the frame; empty: the frame
  gl::Buffer shown_colours_;     // colours of shown_, in the frame's layout
  glm::ivec2 framebuffer_{0};
  bool moving_ = false;
  int divisor_ = 1;  // of the last frame drawn
  // For smaller frames, which are then enlarged to the window.
  std::unique_ptr<gl::Texture> smaller_;
  std::uint32_t smaller_framebuffer_ = 0;
  // Has large textures, so it exists only while marks are shown.
  std::unique_ptr<MarkDrawing> mark_drawing_;
  std::optional<MarkGround> mark_ground_;
  std::array<Camera, 2> eyes_;
  int shown_layout_ = LAYOUT_SEPARATE;  // of the last frame
  std::vector<shared::View> drawn_;     // views of the last frame, as the frame stores them
  int pending_ = 1;                     // frames still to draw
  std::size_t frames_drawn_ = 0;
  std::deque<render::FrameRecord> frames_;     // the last frames
  render::FrameLevels levels_;                 // changes of levels since the last frame
  std::optional<Clock::time_point> followed_;  // time of the last follow_levels()
  std::string trouble_;
  std::optional<ThresholdEffect> threshold_effect_;  // of the last frame
  bool seeks_screen_ = false;                        // chooses the convergence at the first picture;
  std::optional<double> screen_found_;               // the result, m
};

}  // namespace binosplat::preview
