#include "preview/window.h"

#include <imgui.h>
#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/log.h"
#include "preview/glfw.h"
#include "preview/panel.h"

namespace binosplat::preview {

namespace {

namespace fs = std::filesystem;

fs::file_time_type newest(const fs::path& folder) {
  fs::file_time_type time = fs::file_time_type::min();
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) time = std::max(time, entry.last_write_time());
  }
  return time;
}

class Window {
 public:
  Window(const Choices& choices, const WindowSettings& settings,
         std::function<Opened(const std::string&)> open)
      : choices_(choices), settings_(settings), open_(std::move(open)) {
    make_window();
    context_ = gl::Context::adopt(glfwGetProcAddress);
    log_info("drawing with {} (OpenGL {})", context_->renderer(), context_->version());
    if (!settings_.shader_folder.empty()) {
      context_->set_shader_folder(settings_.shader_folder);
      shaders_changed_ = newest(settings_.shader_folder);
    }
    panel_.save_pose = [this] { save(GLFW_KEY_F9); };
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 450 core");
  }

  ~Window() {
    session_.reset();
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    context_.reset();
    glfwDestroyWindow(window_);
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  void load(Opened scene) {
    next_ = std::move(scene);
    read_ = false;
    loading_since_ = glfwGetTime();
    loading_ = std::async(std::launch::async, next_.load);
  }

  void run() {
    while (glfwWindowShouldClose(window_) == GLFW_FALSE) {
      wait();
      take_loaded();
      reload_shaders();
      if (session_) {
        go();
        follow_levels();
        if (draw()) ui_frames_ = std::max(ui_frames_, 1);
      }
      if (ui_frames_ > 0) show();
      context_->check_alive();
    }
    if (loading_.valid() || levels_.valid()) {
      // Nobody waits for a model that is not looked at, and nothing but memory was taken for it.
      log_info("left while {} was being read", loading_.valid() ? next_.name : scene_.name);
      std::quick_exit(0);
    }
    log_info("{} frames were drawn, {} shown", session_ ? session_->frames_drawn() : 0, shown_);
  }

 private:
  void make_window() {
    panel_.stereo_window = choices_.layout == LAYOUT_QUAD_BUFFER;
    window_ = open_window(settings_.size, panel_.stereo_window);
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetWindowUserPointer(window_, this);
    const auto self = [](GLFWwindow* window) {
      return static_cast<Window*>(glfwGetWindowUserPointer(window));
    };
    static const auto of = self;
    glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int mods) {
      if (action == GLFW_PRESS) of(w)->key(key, mods);
      of(w)->ui_frames_ = 3;
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int) {
      if (button == GLFW_MOUSE_BUTTON_LEFT && action == GLFW_PRESS) of(w)->click();
      of(w)->ui_frames_ = 3;
    });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) { of(w)->drag({x, y}); });
    glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double y) { of(w)->scroll(y); });
    glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { of(w)->ui_frames_ = 3; });
    glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* w, int, int) { of(w)->ui_frames_ = 3; });
    glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** files) {
      if (count > 0) of(w)->drop(files[0]);
    });
  }

  // At rest nothing is drawn: only input, a model that is being read, or shaders that are watched, end the
  // wait.
  void wait() {
    if (ui_frames_ > 0 || moving()) {
      glfwPollEvents();
    } else if (loading_.valid()) {
      glfwWaitEventsTimeout(0.05);
      ui_frames_ = 1;
    } else if (levels_.valid()) {
      glfwWaitEventsTimeout(0.02);
    } else if (!settings_.shader_folder.empty()) {
      glfwWaitEventsTimeout(0.5);
    } else {
      glfwWaitEvents();
    }
  }

  void take_loaded() {
    if (levels_.valid()) return;  // their thread reads from the scene that would go
    if (!loading_.valid() || loading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    if (!read_) {  // first say so: the driver takes the model in one go
      read_ = true;
      ui_frames_ = 1;
      return;
    }
    try {
      Model model = loading_.get();
      Choices choices = session_ ? session_->choices : choices_;
      Start start = next_.start(model, choices);
      std::optional<Navigator> head;
      if (session_ && again_) {
        head = session_->head;
        choices = session_->choices;
      }
      session_.reset();  // its memory first
      log_info("{}: {} Gaussians", next_.name, model.count());
      scene_ = std::move(next_);
      session_ = std::make_unique<Session>(*context_, std::move(model), std::move(start.cameras), start.up,
                                           choices, settings_.folder);
      if (head) session_->head = *head;
      glfwSetWindowTitle(window_, ("binosplat - " + scene_.name).c_str());
      panel_.message = scene_.name;
    } catch (const Error& error) {
      if (!session_) throw;
      tell(error.what());
    }
    ui_frames_ = 3;
  }

  // Takes the levels that were read, and has those read that the head needs now. What cannot be read leaves
  // the levels as they are.
  void follow_levels() {
    if (!levels_.valid()) {
      if (!scene_.levels || loading_.valid()) return;
      const auto read = scene_.levels(session_->views());
      if (read) levels_ = std::async(std::launch::async, read);
      return;
    }
    if (levels_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    try {
      session_->replace(levels_.get());
      log_info("{}: levels of {} Gaussians", scene_.name, session_->model().count());
    } catch (const Error& error) {
      if (error.code() == ExitCode::no_gl) throw;
      scene_.levels = nullptr;
      tell(error.what());
    }
    ui_frames_ = 3;
  }

  void reload_shaders() {
    if (settings_.shader_folder.empty() || !session_) return;
    const auto time = newest(settings_.shader_folder);
    if (time == shaders_changed_) return;
    shaders_changed_ = time;
    context_->set_shader_folder(settings_.shader_folder);
    session_->change();
    panel_.message = "shaders were read again";
  }

  // What there is to see at the window's size; false if nothing changed.
  bool draw() {
    glm::ivec2 size;
    glfwGetFramebufferSize(window_, &size.x, &size.y);
    session_->resize(size);
    return session_->draw();
  }

  void show() {
    --ui_frames_;
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    if (session_) panel_.draw(*session_);
    if (loading_.valid()) draw_loading(next_.name, read_, glfwGetTime() - loading_since_);
    ImGui::Render();
    context_->gl().BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    context_->gl().ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
    context_->gl().Clear(GL_COLOR_BUFFER_BIT);
    if (session_) session_->present();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window_);
    ++shown_;
  }

  bool down(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }

  glm::dvec3 direction() const {
    if (!session_ || ImGui::GetIO().WantCaptureKeyboard) return glm::dvec3(0.0);
    return {down(GLFW_KEY_D) - down(GLFW_KEY_A), down(GLFW_KEY_E) - down(GLFW_KEY_Q),
            down(GLFW_KEY_W) - down(GLFW_KEY_S)};
  }
  bool moving() const { return direction() != glm::dvec3(0.0); }

  // Held keys go half the distance to the target a second; with Shift four times as fast.
  void go() {
    const double now = glfwGetTime();
    const double seconds = std::min(0.1, now - last_time_);
    last_time_ = now;
    if (!moving()) return;
    const double speed = (down(GLFW_KEY_LEFT_SHIFT) ? 2.0 : 0.5) * session_->head.distance() * seconds;
    const glm::dvec3 by = speed * direction();
    session_->head.move(by.x, by.y, by.z, panel_.walking);
    session_->change();
  }

  void drag(const glm::dvec2& at) {
    const glm::dvec2 by = (at - cursor_) / 400.0;  // radians a pixel: a window's width is some 3 of them
    cursor_ = at;
    ui_frames_ = 3;
    if (!session_ || ImGui::GetIO().WantCaptureMouse) return;
    const auto held = [&](int button) { return glfwGetMouseButton(window_, button) == GLFW_PRESS; };
    if (held(GLFW_MOUSE_BUTTON_LEFT)) {
      session_->head.orbit(-by.x, by.y);
    } else if (held(GLFW_MOUSE_BUTTON_RIGHT)) {
      session_->head.look(by.x, -by.y);
    } else if (held(GLFW_MOUSE_BUTTON_MIDDLE)) {
      session_->head.move(-by.x * session_->head.distance(), by.y * session_->head.distance(), 0.0);
    } else {
      return;
    }
    session_->change();
  }

  void scroll(double by) {
    ui_frames_ = 3;
    if (!session_ || ImGui::GetIO().WantCaptureMouse) return;
    session_->head.dolly(std::pow(0.9, by));
    session_->change();
  }

  void click() {
    const double now = glfwGetTime();
    const bool twice = now - last_click_ < 0.35;
    last_click_ = twice ? 0.0 : now;
    if (!twice || !session_ || ImGui::GetIO().WantCaptureMouse) return;
    glm::ivec2 window, framebuffer;
    glfwGetWindowSize(window_, &window.x, &window.y);
    glfwGetFramebufferSize(window_, &framebuffer.x, &framebuffer.y);
    session_->focus(glm::ivec2(cursor_ * glm::dvec2(framebuffer) / glm::max(glm::dvec2(window), 1.0)));
  }

  void drop(const char* file) {
    ui_frames_ = 3;
    if (loading_.valid()) return tell(fmt::format("{} is still being read", next_.name));
    try {
      load(open_(file));
      again_ = false;
    } catch (const Error& error) {
      tell(error.what());
    }
  }

  // The same model as its file is now.
  void read_again() {
    if (loading_.valid()) return;
    if (levels_.valid()) return tell(fmt::format("levels of {} are still being read", scene_.name));
    load(scene_);
    again_ = true;
  }

  // What could not be done.
  void tell(const std::string& message) {
    panel_.message = message;
    log_warning("{}", message);
  }

  // The next of a list's choices, without one of them.
  static void next(int& value, int count, int left_out, int by) {
    do value = (value + by + count) % count;
    while (value == left_out);
  }

  void key(int key, int mods) {
    if (key == GLFW_KEY_ESCAPE) glfwSetWindowShouldClose(window_, GLFW_TRUE);
    if (key == GLFW_KEY_F1) panel_.open = !panel_.open;
    if (!session_ || ImGui::GetIO().WantTextInput) return;
    Choices& c = session_->choices;
    const int by = (mods & GLFW_MOD_SHIFT) != 0 ? -1 : 1;
    if (key == GLFW_KEY_G) panel_.walking = !panel_.walking;
    if (key == GLFW_KEY_N) session_->step_camera(1);
    if (key == GLFW_KEY_P) session_->step_camera(-1);
    if (key == GLFW_KEY_F5) read_again();
    if (key == GLFW_KEY_L) panel_.next_layout(c.layout, by);
    if (key == GLFW_KEY_V) {
      next(c.show, static_cast<int>(std::size(show_choices)), -1, by);
      session_->change_show();
    }
    if (key == GLFW_KEY_T) next(c.settings.tiles, static_cast<int>(std::size(tiles_choices)), TILES_ALL, by);
    if (key == GLFW_KEY_H) {
      next(c.settings.th, static_cast<int>(std::size(th_choices)), -1, by);
      choose_threshold(c.settings, c.settings.th);
    }
    if (key == GLFW_KEY_L || key == GLFW_KEY_T || key == GLFW_KEY_H) session_->change();
    save(key);
  }

  void save(int key) {
    if (key != GLFW_KEY_F12 && key != GLFW_KEY_F11 && key != GLFW_KEY_K && key != GLFW_KEY_F9) return;
    try {
      draw();  // what has changed since the last frame, the size among it
      const std::string file = key == GLFW_KEY_F9  ? save_pose()
                               : key == GLFW_KEY_K ? session_->save_camera(glfwGetTime())
                                                   : session_->save_picture(key == GLFW_KEY_F11);
      panel_.message = file;
      log_info("saved {}", file);
    } catch (const Error& error) {
      tell(error.what());
    }
  }

  std::string save_pose() const {
    if (scene_.pose_file.empty()) fail("{} is built in: there is no file to save a pose beside", scene_.name);
    session_->save_pose(scene_.pose_file);
    return scene_.pose_file.string();
  }

  Choices choices_;
  WindowSettings settings_;
  std::function<Opened(const std::string&)> open_;
  GLFWwindow* window_ = nullptr;
  std::unique_ptr<gl::Context> context_;
  std::unique_ptr<Session> session_;
  Panel panel_;
  Opened scene_, next_;  // what is shown, and what is being read
  bool read_ = false;    // that is done, and to be handed to the GPU
  bool again_ = false;   // that is the same one
  std::future<Model> loading_, levels_;
  double loading_since_ = 0.0, last_time_ = 0.0, last_click_ = 0.0;
  glm::dvec2 cursor_{0.0};
  fs::file_time_type shaders_changed_;
  int ui_frames_ = 3;  // still to show: widgets take some frames to settle after an event
  std::size_t shown_ = 0;
};

}  // namespace

void run(Opened scene, const Choices& choices, const WindowSettings& settings,
         const std::function<Opened(const std::string& file)>& open) {
  const Glfw glfw;
  Window window(choices, settings, open);
  window.load(std::move(scene));
  window.run();
}

}  // namespace binosplat::preview
