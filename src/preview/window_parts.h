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
  bool levels_move() const;
  void follow_levels();
  void reload_shaders();
  bool draw();
  void measure_pace();
  void show();
  void rescale();
  void tell(const std::string& message, bool trouble = false);

  // Of hands.
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
  void play_or_stop();
  void play();
  void delete_key(std::size_t k);
  void save(const std::function<std::string()>& write);
  void save_in_folder(const std::function<std::string()>& write);
  std::string save_pose() const;

  Choices choices_;
  WindowSettings settings_;
  std::function<Opened(const std::string&)> open_;
  GLFWwindow* window_ = nullptr;
  FullScreen full_screen_;
  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<Session> session_;
  Panel panel_;
  Messages messages_;
  Opened scene_, next_;     // what is shown, and what is being read
  bool read_ = false;       // that is done, and to be handed to the GPU
  bool again_ = false;      // that is the same one
  bool announced_ = false;  // that the first frame of what is shown takes longer
  std::future<Loaded> loading_;
  bool levels_follow_ = false;       // until they cannot be read
  bool levels_moved_ = false;        // when they were followed last
  std::size_t levels_reported_ = 0;  // Gaussians
  double loading_since_ = 0.0, last_time_ = 0.0, last_click_ = 0.0, moved_at_ = 0.0;
  std::optional<KeyPath> playing_;
  Camera played_;  // where that has brought the head
  double playing_since_ = 0.0;
  std::optional<double> drawn_at_;    // the last frame, where the next may follow at once
  std::deque<double> frame_seconds_;  // between the last frames that did
  glm::dvec2 cursor_{0.0};
  std::filesystem::file_time_type shaders_changed_;
  bool scale_changed_ = false;
  int ui_frames_ = 3;  // still to show: widgets take some frames to settle after an event
  std::size_t shown_ = 0;
};

}  // namespace binosplat::preview
