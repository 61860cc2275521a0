#pragma once
// The preview's panel of widgets (Dear ImGui), beside the picture.

#include <functional>
#include <optional>
#include <string>

#include "preview/session.h"

namespace binosplat::preview {

/// Actions of buttons, which the window implements.
struct Requests {
  std::function<void()> save_pose, full_screen, add_key, play, record;
  std::function<void(std::size_t key)> move_key, delete_key;
  std::function<void(const std::string& file)> open;
  std::function<void(double metres)> set_ruler_length;
};

struct Panel {
  bool open = true;
  bool walking = false;
  bool playing = false;
  bool recording = false;
  double budget_ms = 1000.0 / 60.0;  // time for a frame: the display's refresh period
  bool takes_length = false;         // the ruler's length takes the keyboard focus at the next draw()
  bool takes_keys = false;           // the panel takes the keyboard focus at the next draw()
  bool stereo_window = false;        // allows LAYOUT_QUAD_BUFFER
  Requests requests;
  std::optional<double> frames_a_second;  // the last rate while the head moved

  /// Width of the panel at the right of a window, both in px; 0 if hidden. No picture is drawn there.
  float width(float window) const;
  /// Call it between ImGui::NewFrame() and Render().
  void draw(Session& session);
  /// Changes to the next allowed layout (`by` 1) or the previous one (-1).
  void next_layout(int& layout, int by) const;

 private:
  void draw_controls(Session& session);
  bool draw_view(Session& session);
  void draw_ruler(double units);
  void draw_open();
  void draw_path(Session& session);
  void draw_times_of(Session& session);
  void draw_accuracy(Session& session);

  std::string file_;     // typed path of a file to open
  double metres_ = 0.0;  // typed length of the ruler
};

/// Draws the colour scale of a map (stereo/debug_view.h) at the lower right of a picture `width` px wide.
void draw_legend(int show, double most, float width);

/// Enables keys: Tab goes to the next number to type, arrows to other widgets; Space presses. Call it
/// once, after creation of ImGui's context.
void enable_keys();

/// Sets fonts and widgets for a display's scale, between frames. `pixels`: framebuffer px per window unit.
void set_scale(float scale, float pixels);

}  // namespace binosplat::preview
