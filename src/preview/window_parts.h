#pragma once
// The class of the preview's window: window.cpp loads, draws and presents, window_input.cpp handles input.

#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "preview/glfw_window.h"
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

  /// Starts reading a scene, which is shown when complete. `again`: reloads the current scene's changed file.
  void load(Opened scene, bool again = false);
  void run();

 private:
  void listen();
  void wait();
  void take_loaded();
  void show_model(const Opened& scene, OpenedModel<Stream> opened, bool is_same);
  bool levels_move() const;
  void follow_levels();
  void reload_shaders();
  glm::ivec2 picture_size() const;
  bool draw();
  void measure_pace();
  void show();
  void rescale();
  void show_message(const std::string& message, bool trouble = false);

  // Input.
  bool down(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }
  glm::dvec3 direction() const;
  bool going() const { return direction() != glm::dvec3(0.0); }
  void go();
  void moved();
  void drag(const glm::dvec2& at);
  void scroll(double by);
  void click();
  glm::ivec2 pixel_under_cursor() const;
  void click_ruler();
  void set_ruler_length(double metres);
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
  std::string save_pose(bool keeps_pose = false) const;
  void record_or_stop();

  Choices choices_;
  WindowSettings settings_;
  std::function<Opened(const std::string&)> open_;
  GLFWwindow* window_ = nullptr;
  FullScreen full_screen_;
  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<Session> session_;
  Panel panel_;
  Messages messages_;
  Opened scene_;
  bool announced_ = false;  // a message has announced that this scene's first frame takes longer
  /// The next scene, which a thread reads while the window shows the current one.
  struct Loading {
    Opened scene;
    bool is_same = false;  // a reload of the current scene
    bool is_read = false;  // reading is complete; the upload is next
    std::future<OpenedModel<Stream>> loaded;
    double since = 0.0;
  };
  Loading loading_;
  struct Levels {
    bool follow = false;        // false after a failed read
    bool moved = false;         // levels moved at the last follow_levels()
    std::size_t gaussians = 0;  // in the last log line
  };
  Levels levels_;
  double went_at_ = 0.0, clicked_at_ = 0.0, moved_at_ = 0.0;  // s: times of input
  glm::dvec2 cursor_{0.0};
  /// A path that plays until the user moves the head.
  struct Playing {
    KeyPath path;
    double since = 0.0;
    Camera head = {};  // the last pose that it set
  };
  std::optional<Playing> playing_;
  /// A recording, with the time of its end.
  struct Recording {
    render::Recorder recorder;
    double until = 0.0;
  };
  std::optional<Recording> recording_;
  std::optional<double> drawn_at_;    // time of the last frame, if the next follows directly
  std::deque<double> frame_seconds_;  // between successive frames
  std::filesystem::file_time_type shaders_changed_;
  bool scale_changed_ = false;
  int ui_frames_ = 3;  // frames still to show: widgets need some to settle after an event
  std::size_t shown_ = 0;
};

}  // namespace binosplat::preview
