#pragma once
// The preview's widgets (Dear ImGui), beside the picture.

#include <functional>
#include <optional>
#include <string>

#include "preview/session.h"

namespace binosplat::preview {

/// What buttons ask of the window.
struct Requests {
  std::function<void()> save_pose, full_screen, add_key, play, record;
  std::function<void(std::size_t key)> move_key, delete_key;
  std::function<void(const std::string& file)> open;
};

struct Panel {
  bool open = true;
  bool walking = false;
  bool playing = false;
  bool recording = false;
  double budget_ms = 1000.0 / 60.0;  // that a frame may take: the display's
  bool takes_keys = false;           // Tab and arrows go about in it, wherever the last click was
  bool stereo_window = false;        // LAYOUT_QUAD_BUFFER may be chosen
  Requests requests;
  std::optional<double> frames_a_second;  // as they were shown last while the head moved

  /// How much of a window it takes at the right, both in px: no picture is drawn there. 0 while it is hidden.
  float width(float window) const;
  /// Between ImGui::NewFrame() and Render().
  void draw(Session& session);
  /// The next of the layouts that may be chosen, or the one before.
  void next_layout(int& layout, int by) const;

 private:
  void draw_controls(Session& session);
  bool draw_view(Session& session);
  void draw_open();
  void draw_path(Session& session);
  void draw_times_of(Session& session);
  void draw_accuracy(Session& session);

  std::string file_;  // that is typed, to be opened
};

/// What the colours of a map mean (stereo/debug_view.h), at the lower right of a picture of that width in px.
void draw_legend(int show, double most, float width);

/// Tab goes to the next number, to be typed; arrows go from widget to widget, and Space presses one. Once,
/// after ImGui's context is made.
void enable_keys();

/// Fonts and widgets for a display of that scale, in a window whose framebuffer has `pixels` px for each of
/// its own units. Between frames.
void set_scale(float scale, float pixels);

}  // namespace binosplat::preview
