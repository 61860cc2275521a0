#pragma once
// The preview's window as its own files see it: window.cpp reads, draws and shows, window_input.cpp follows
// hands.

#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "preview/glfw.h"
#include "preview/messages.h"
#include "preview/panel.h"
#include "preview/window.h"
#include "scene/key_path.h"

namespace binosplat::preview {

class Window {
 public:
  Window(const Choices& choices, const WindowSettings& settings,
         std::function<Opened(const std::string&)> open);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Has a scene read, to be shown once that is done; `again`: the one that is shown, as its file is now.
  void load(Opened scene, bool again = false);
  /// Until it is closed.
  void run();

 private:
  void listen();
  void wait();
  void take_loaded();
  void show_model(const Opened& scene, Loaded loaded, bool is_same);
  bool turns() const { return session_ && announced_ && !scene_.more.empty() && !turn_.is_held; }
  void take_turn();
  bool levels_move() const;
  void follow_levels();
  void measure_depth_table();
  void reload_shaders();
  bool draw();
  void measure_pace();
  void show();
  void rescale();
  void tell(const std::string& message, bool trouble = false);

  // What hands do.
  bool down(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }
  glm::dvec3 direction() const;
  bool going() const { return direction() != glm::dvec3(0.0); }
  void go();
  void moved();
  void drag(const glm::dvec2& at);
  void scroll(double by);
  void click();
  void open_file(const std::string& file);
  void read_again();
  void key(int key, int mods);
  void key_of_scene(int key, int by);
  void key_of_marks(int key);
  void play_or_stop();
  void play();
  void delete_key(std::size_t k);
  void save(const std::function<std::string()>& write);
  void save_in_folder(const std::function<std::string()>& write);
  std::string save_pose() const;
  void record_or_stop();
  void record(const render::FrameRecord& frame);

  Choices choices_;
  WindowSettings settings_;
  std::function<Opened(const std::string&)> open_;
  GLFWwindow* window_ = nullptr;
  FullScreen full_screen_;
  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<Session> session_;
  Panel panel_;
  Messages messages_;
  Opened scene_;            // what is shown
  bool announced_ = false;  // that its first frame takes longer
  /// A scene that is being read, in place of the one that is shown.
  struct Loading {
    Opened scene;
    bool is_same = false;  // as the one that is shown, whose file may have changed
    bool is_read = false;  // and to be handed to the GPU
    std::future<Loaded> loaded;
    double since = 0.0;
  };
  Loading loading_;
  /// Models of a moving scene.
  struct Turn {
    std::size_t shown = 0;     // 0: that of scene_.load, and so on
    std::future<Loaded> next;  // is read meanwhile
    double due = 0.0;
    bool is_held = false;
  };
  Turn turn_;
  /// Levels of detail of the scene that is shown.
  struct Levels {
    bool follow = false;        // until they cannot be read
    bool moved = false;         // when they were followed last
    std::size_t gaussians = 0;  // that the log reported last
  };
  Levels levels_;
  bool is_measuring_ = false;                                 // a table of transmittance by depth
  double went_at_ = 0.0, clicked_at_ = 0.0, moved_at_ = 0.0;  // s: when hands did that
  glm::dvec2 cursor_{0.0};
  /// The path that the head is taken along; it ends where somebody moves the head.
  struct Playing {
    KeyPath path;
    double since = 0.0;
    Camera head = {};  // where that has brought it
  };
  std::optional<Playing> playing_;
  /// Frames that are recorded, until then.
  struct Recording {
    render::Recorder recorder;
    double until = 0.0;
  };
  std::optional<Recording> recording_;
  std::optional<double> drawn_at_;    // the last frame, where the next may follow at once
  std::deque<double> frame_seconds_;  // between the last frames that did
  std::filesystem::file_time_type shaders_changed_;
  bool scale_changed_ = false;
  int ui_frames_ = 3;  // still to show: widgets take some frames to settle after an event
  std::size_t shown_ = 0;
};

}  // namespace binosplat::preview
