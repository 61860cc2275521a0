#pragma once
// The preview's window (GLFW): input, and when to draw.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "preview/session.h"
#include "render/recorder.h"

namespace binosplat::preview {

/// A scene to open: read in a thread of its own, then shown.
struct Opened {
  std::string name;
  std::filesystem::path folder;     // for its pictures and keys
  std::function<void()> claim;      // called before each that is written there; may be empty
  std::filesystem::path pose_file;  // where its pose is saved; empty: nowhere
  std::function<Loaded()> load;
  /// Sets what of the choices follows from the model, too, such as the near plane.
  std::function<Start(const Model& model, Choices& choices)> start;
  /// Of a moving scene the models after that of `load`: so many a second, again and again, or as fast as they
  /// can be read.
  std::vector<std::function<Loaded()>> more;
  double fps = 0.0;
};

/// Writes frames of a scene, that were recorded with this context, into a new folder. `draw` draws one of
/// their views once more.
using SaveRecording = std::function<void(const std::filesystem::path& folder, const std::string& scene,
                                         const gl::Context& context, render::Recording recording,
                                         const std::function<Image(const shared::View& view)>& draw)>;

struct WindowSettings {
  std::optional<glm::ivec2> size;  // px; none: what suits the display
  std::filesystem::path
      shader_folder;  // empty: the embedded shaders; else they are read again when they change
  SaveRecording save_recording;
};

/// Shows a scene until the window is closed; files dropped on it are opened with `open`, whose Errors are
/// shown. With LAYOUT_QUAD_BUFFER the window is a stereo one. Throws Error(no_gl) where there is no display,
/// none with OpenGL 4.5 or no stereo window, and when the GPU is lost; and what reading the first scene
/// throws.
void run(Opened scene, const Choices& choices, const WindowSettings& settings,
         const std::function<Opened(const std::string& file)>& open);

}  // namespace binosplat::preview
