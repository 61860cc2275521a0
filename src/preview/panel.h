#pragma once
// The preview's widgets (Dear ImGui), over whatever is drawn.

#include <functional>
#include <optional>
#include <string>

#include "preview/session.h"

namespace binosplat::preview {

struct Panel {
  bool open = true;
  bool walking = false;
  bool stereo_window = false;       // LAYOUT_QUAD_BUFFER may be chosen
  std::function<void()> save_pose;  // of the button; empty: nowhere to save it
  std::string message;              // the last thing done, for the user
  std::optional<double> psnr;       // dB, of the last picture that was compared

  /// Between ImGui::NewFrame() and Render().
  void draw(Session& session);
  /// The next of the layouts that may be chosen, or the one before.
  void next_layout(int& layout, int by) const;

 private:
  void draw_controls(Session& session);
  bool draw_show(Choices& choices);
};

/// While a model is read, and then handed to the GPU: its name, how far that is (base/progress.h), and how
/// long it has taken, in s.
void draw_loading(const std::string& scene, bool read, double seconds);

/// What could not be done while there is no panel to tell it.
void draw_message(const std::string& message);

}  // namespace binosplat::preview
