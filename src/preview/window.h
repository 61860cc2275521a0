#pragma once
// The preview's window (GLFW): input, and when to draw.

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "preview/session.h"

namespace binosplat::preview {

/// A scene to open: read in a thread of its own, then shown.
struct Opened {
  std::string name;
  glm::dvec3 up{0.0, -1.0, 0.0};    // the world's
  std::filesystem::path folder;     // for its pictures and keys
  std::filesystem::path pose_file;  // where its pose is saved; empty: nowhere
  std::function<Model()> load;
  /// Where to start and what to step through, for the model; not empty. Sets what of the choices follows from
  /// the model, such as the near plane.
  std::function<std::vector<Camera>(const Model& model, Choices& choices)> cameras;
  /// Of a model with levels of detail: what reads the levels that these views need, in a thread of its own
  /// and one at a time; nothing where they are the last ones that were read.
  std::function<std::function<Model()>(std::span<const shared::View> views)> levels;
};

struct WindowSettings {
  std::optional<glm::ivec2> size;  // px; none: what suits the display
  std::filesystem::path
      shader_folder;  // empty: the embedded shaders; else they are read again when they change
};

/// Shows a scene until the window is closed; files dropped on it are opened with `open`, whose Errors are
/// shown. With LAYOUT_QUAD_BUFFER the window is a stereo one. Throws Error(no_gl) where there is no display,
/// none with OpenGL 4.5 or no stereo window, and when the GPU is lost; and what reading the first scene
/// throws.
void run(Opened scene, const Choices& choices, const WindowSettings& settings,
         const std::function<Opened(const std::string& file)>& open);

}  // namespace binosplat::preview
