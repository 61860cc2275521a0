// Handles the window's input; keys.h documents it.

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/log.h"
#include "preview/window_parts.h"

namespace binosplat::preview {

void Window::listen() {
  glfwSetWindowUserPointer(window_, this);
  static const auto of = [](GLFWwindow* window) {
    return static_cast<Window*>(glfwGetWindowUserPointer(window));
  };
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
  glfwSetWindowContentScaleCallback(window_, [](GLFWwindow* w, float, float) {
    of(w)->scale_changed_ = true;
    of(w)->ui_frames_ = 3;
  });
  glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** files) {
    if (count > 0) of(w)->open_file(files[0]);
  });
}

glm::dvec3 Window::direction() const {
  if (!session_ || ImGui::GetIO().WantCaptureKeyboard) return glm::dvec3(0.0);
  return {down(GLFW_KEY_D) - down(GLFW_KEY_A), down(GLFW_KEY_E) - down(GLFW_KEY_Q),
          down(GLFW_KEY_W) - down(GLFW_KEY_S)};
}

void Window::moved() {
  moved_at_ = glfwGetTime();
  session_->move();
}

// Per second, held keys move the head by half the distance to the target, with Shift by twice the distance.
void Window::go() {
  const double now = glfwGetTime();
  const double seconds = std::min(0.1, now - went_at_);
  went_at_ = now;
  if (!going()) return;
  const double speed = (down(GLFW_KEY_LEFT_SHIFT) ? 2.0 : 0.5) * session_->head.distance() * seconds;
  const glm::dvec3 by = speed * direction();
  session_->head.move(by.x, by.y, by.z, panel_.walking);
  moved();
}

void Window::drag(const glm::dvec2& at) {
  // A drag across the width of a window turns by about 3 radians, at any display scale.
  const glm::dvec2 by = (at - cursor_) / (400.0 * ImGui::GetFontSize() / 13.0);
  cursor_ = at;
  ui_frames_ = 3;
  if (!session_ || ImGui::GetIO().WantCaptureMouse) return;
  const auto held = [&](int button) { return glfwGetMouseButton(window_, button) == GLFW_PRESS; };
  if (held(GLFW_MOUSE_BUTTON_LEFT) && !session_->ruler) {
    session_->head.orbit(-by.x, by.y);
  } else if (held(GLFW_MOUSE_BUTTON_RIGHT)) {
    session_->head.look(by.x, -by.y);
  } else if (held(GLFW_MOUSE_BUTTON_MIDDLE)) {
    session_->head.move(-by.x * session_->head.distance(), by.y * session_->head.distance(), 0.0);
  } else {
    return;
  }
  moved();
}

void Window::scroll(double by) {
  ui_frames_ = 3;
  if (!session_ || ImGui::GetIO().WantCaptureMouse) return;
  session_->head.dolly(std::pow(0.9, by));
  moved();
}

void Window::click() {
  if (session_ && session_->ruler && !ImGui::GetIO().WantCaptureMouse) return click_ruler();
  const double now = glfwGetTime();
  const bool twice = now - clicked_at_ < 0.35;
  clicked_at_ = twice ? 0.0 : now;
  if (!twice || !session_ || ImGui::GetIO().WantCaptureMouse) return;
  session_->focus(pixel_under_cursor());
}

glm::ivec2 Window::pixel_under_cursor() const {
  glm::ivec2 window, framebuffer;
  glfwGetWindowSize(window_, &window.x, &window.y);
  glfwGetFramebufferSize(window_, &framebuffer.x, &framebuffer.y);
  return {cursor_ * glm::dvec2(framebuffer) / glm::max(glm::dvec2(window), 1.0)};
}

void Window::click_ruler() {
  if (session_->ruler_length()) return;  // the length is not typed yet
  if (!session_->add_to_ruler(pixel_under_cursor()))
    return show_message("there is no other point of the model here", true);
  if (!session_->ruler_length()) return show_message("the ruler's first point: click the second one");
  show_message("the ruler: type the distance of both points");
  panel_.open = panel_.takes_length = true;
}

// The file beside the model brings the scale to other commands.
void Window::set_ruler_length(double metres) {
  session_->set_ruler_length(metres);
  save([this] { return save_pose(true); });
}

void Window::open_file(const std::string& file) {
  ui_frames_ = 3;
  if (loading_.loaded.valid())
    return show_message(fmt::format("{} is still being read", loading_.scene.name), true);
  try {
    load(open_(file));
  } catch (const Error& error) {
    show_message(error.what(), true);
  }
}

void Window::read_again() {
  if (loading_.loaded.valid()) return;
  load(scene_, true);
}

namespace {

// Goes to the next (`by` 1) or the previous (-1) of `count` values.
void next(int& value, int count, int by) { value = (value + by + count) % count; }

// Returns whether the panel's keyboard navigation, which begins with Tab or an arrow, uses this key.
bool is_for_widgets(int key) {
  if (!ImGui::GetIO().NavVisible) return false;
  return key == GLFW_KEY_SPACE || key == GLFW_KEY_ENTER || key == GLFW_KEY_ESCAPE;
}

}  // namespace

void Window::key(int key, int mods) {
  if (ImGui::GetIO().WantTextInput || is_for_widgets(key)) return;
  if (key == GLFW_KEY_TAB) panel_.takes_keys = true;
  if (key == GLFW_KEY_ESCAPE && !full_screen_.leave(window_)) glfwSetWindowShouldClose(window_, GLFW_TRUE);
  if (key == GLFW_KEY_F && !full_screen_.leave(window_)) full_screen_.enter(window_);
  if (key == GLFW_KEY_F1) panel_.open = !panel_.open;
  if (session_) key_of_scene(key, (mods & GLFW_MOD_SHIFT) != 0 ? -1 : 1);
}

void Window::key_of_scene(int key, int by) {
  Choices& c = session_->choices;
  if (key == GLFW_KEY_G) {
    panel_.walking = !panel_.walking;
    show_message(panel_.walking ? "walking" : "flying");
  }
  if (key == GLFW_KEY_N) session_->step_camera(1);
  if (key == GLFW_KEY_P) session_->step_camera(-1);
  if (key == GLFW_KEY_N || key == GLFW_KEY_P) show_message(session_->camera_name());
  if (key == GLFW_KEY_R) session_->reset_view();
  if (key == GLFW_KEY_Z) session_->show_all();
  if (key == GLFW_KEY_F5) read_again();
  if (key == GLFW_KEY_L) {
    panel_.next_layout(c.layout, by);
    show_message(fmt::format("layout {}: {}", layout_choices[c.layout].name, layout_choices[c.layout].help));
  }
  if (key == GLFW_KEY_V) {
    next(c.show, static_cast<int>(std::size(show_choices)), by);
    session_->change_show();
    show_message(fmt::format("{}: {}", show_choices[c.show].name, show_choices[c.show].help));
  }
  if (key == GLFW_KEY_T) {
    next_tiles(c.settings, by);
    show_message(fmt::format("tiles {}: {}", tiles_choices[c.settings.tiles].name,
                             tiles_choices[c.settings.tiles].help));
  }
  if (key == GLFW_KEY_H) {
    int threshold = static_cast<int>(render::chosen_threshold(c.settings));
    next(threshold, static_cast<int>(std::size(threshold_choices)), by);
    choose_threshold(c.settings, static_cast<Threshold>(threshold));
    c.flipped = false;
    show_message(fmt::format("threshold {}: {}", threshold_choices[threshold].name,
                             threshold_choices[threshold].help));
  }
  if (key == GLFW_KEY_M) {
    session_->ruler = session_->ruler ? std::nullopt : std::optional(std::vector<glm::dvec3>());
    session_->change();
    show_message(session_->ruler ? "the ruler: click two points on the model" : "no ruler");
  }
  if (key == GLFW_KEY_X && is_exact(c.settings)) {
    show_message("the picture is exact: choose a threshold (H), or less quality");
  } else if (key == GLFW_KEY_X) {
    c.flipped = !c.flipped;
    session_->change();
    show_message(c.flipped ? "the exact picture" : "the picture with the chosen settings");
  }
  if (key == GLFW_KEY_B || key == GLFW_KEY_C) key_of_marks(key);
  if (key == GLFW_KEY_L || key == GLFW_KEY_T || key == GLFW_KEY_H) session_->change();
  if (key == GLFW_KEY_SPACE) play_or_stop();
  if (key == GLFW_KEY_K) save_in_folder([this] { return session_->add_key(); });
  if (key == GLFW_KEY_F8) record_or_stop();
  if (key == GLFW_KEY_F9) save([this] { return save_pose(); });
  if (key == GLFW_KEY_F11 || key == GLFW_KEY_F12)
    save_in_folder([&] { return session_->save_picture(key == GLFW_KEY_F11); });
}

void Window::key_of_marks(int key) {
  Choices& c = session_->choices;
  if (key == GLFW_KEY_C && !session_->has_cameras())
    return show_message(scene_.name + " comes without cameras", true);
  bool& shown = key == GLFW_KEY_B ? c.grid : c.cameras;
  shown = !shown;
  session_->change();
  const char* const name = key == GLFW_KEY_B ? "grid" : "cameras";
  if (!shown) return show_message(fmt::format("no {}", name));
  std::string text = name;
  if (key == GLFW_KEY_B)
    text += fmt::format(": lines {:.3g} m apart", session_->mark_places().spacing / c.rig.units_per_metre);
  if (c.show != SHOW_PICTURE) text += fmt::format(", with the {} (V)", show_choices[SHOW_PICTURE].name);
  show_message(text);
}

void Window::play_or_stop() {
  if (playing_) return playing_.reset();
  try {
    playing_.emplace(Playing{.path = KeyPath(session_->keys.keys()), .since = glfwGetTime()});
    session_->go_to(playing_->path.at(0.0));
    playing_->head = session_->head.camera();
  } catch (const Error& error) {
    show_message(error.what(), true);
  }
}

// Plays the path by its keys' times until the user moves the head.
void Window::play() {
  if (!playing_) return;
  const Camera& head = session_->head.camera();
  if (head.position != playing_->head.position || head.rotation != playing_->head.rotation)
    return playing_.reset();
  const double at = glfwGetTime() - playing_->since;
  session_->go_to(playing_->path.at(std::min(at, playing_->path.seconds())));
  playing_->head = session_->head.camera();
  moved();
  if (at >= playing_->path.seconds()) playing_.reset();
}

void Window::delete_key(std::size_t k) {
  save_in_folder([&] {
    session_->keys.remove(k);
    return session_->keys.file().string();
  });
}

// Shows which file was written, or the error.
void Window::save(const std::function<std::string()>& write) {
  try {
    draw();  // applies changes since the last frame, such as the size
    const std::string file = write();
    show_message("saved " + file);
    log_info("saved {}", file);
  } catch (const Error& error) {
    show_message(error.what(), true);
  }
}

void Window::save_in_folder(const std::function<std::string()>& write) {
  save([&] {
    if (scene_.claim) scene_.claim();
    return write();
  });
}

// A recording draws full-size frames at the display's rate.
void Window::record_or_stop() {
  constexpr double seconds = 10.0;
  session_->keeps_size = !recording_;
  if (!recording_) {
    recording_.emplace(
        Recording{{*context_, 1000.0 / panel_.budget_ms, std::make_shared<gl::GpuClock>(*context_)},
                  glfwGetTime() + seconds});
    return show_message(fmt::format("recording {:.0f} s: F8 ends it", seconds));
  }
  render::Recording recording = recording_->recorder.finish();
  recording_.reset();
  if (recording.frames.empty()) return show_message("no frame was drawn meanwhile", true);
  save_in_folder([&] {
    const std::filesystem::path folder = free_name(scene_.folder, "profile", "");
    settings_.save_recording(folder, scene_.name, *context_, std::move(recording),
                             [this](const shared::View& view) { return session_->picture_of(view); });
    return folder.string();
  });
}

std::string Window::save_pose(bool keeps_pose) const {
  if (scene_.pose_file.empty())
    fail("{} is built in: pose and scale are saved only beside a model file", scene_.name);
  session_->save_pose(scene_.pose_file, keeps_pose);
  return scene_.pose_file.string();
}

}  // namespace binosplat::preview
