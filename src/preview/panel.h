#pragma once
// The preview's widgets (Dear ImGui), over whatever is drawn.

#include <optional>
#include <string>

#include "preview/session.h"

namespace binosplat::preview {

struct Panel {
  bool open = true;
  bool walking = false;
  std::string message;         // the last thing done, for the user
  std::optional<double> psnr;  // dB, of the last picture that was compared

  /// Between ImGui::NewFrame() and Render().
  void draw(Session& session);
};

/// While a model is read: its name and how long it has taken, in s.
void draw_loading(const std::string& scene, double seconds);

}  // namespace binosplat::preview
