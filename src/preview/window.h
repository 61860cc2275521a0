#pragma once
// The preview's window (GLFW).

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "preview/session.h"
#include "render/recorder.h"

namespace binosplat::preview {

/// A scene to open. A thread reads it, then the window shows it.
struct Opened {
  std::string name;
  std::filesystem::path folder;     // for saved pictures and keys
  std::function<void()> claim;      // called before each file is written to `folder`; may be empty
  std::filesystem::path pose_file;  // for saved poses; empty: none
  std::function<OpenedModel<Stream>()> load;
  /// Sets the choices that also depend on the model, such as the near plane, and measures it for AdaGScale.
  /// `eye`: px of an eye's picture, whose shape a made-up camera suits.
  std::function<Start(gl::Context& context, const OpenedModel<Stream>& opened, Choices& choices,
                      const glm::ivec2& eye)>
      start;
};

/// Writes recorded frames of this context into a new folder. `draw` draws one of their views again.
using SaveRecording = std::function<void(const std::filesystem::path& folder, const std::string& scene,
                                         const gl::Context& context, render::Recording recording,
                                         const std::function<Image(const shared::View& view)>& draw)>;

struct WindowSettings {
  std::optional<glm::ivec2> size;       // px; none: suits the display
  std::filesystem::path shader_folder;  // empty: embedded; else reloaded on change
  SaveRecording save_recording;
};

/// Shows a scene until the window is closed. `open` opens files dropped on the window; its Errors become
/// messages. LAYOUT_QUAD_BUFFER opens a stereo window. Rethrows errors of reading the first scene. Throws
/// Error(no_gl) without a display, OpenGL 4.5 or the stereo window, and if the GPU is lost.
void run(Opened scene, const Choices& choices, const WindowSettings& settings,
         const std::function<Opened(const std::string& file)>& open);

}  // namespace binosplat::preview
