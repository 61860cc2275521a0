#include "preview/window.h"

#include <imgui.h>
#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <chrono>

#include "base/error.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/statistics.h"
#include "preview/window_parts.h"

namespace binosplat::preview {

namespace {

namespace fs = std::filesystem;

// Time without movement after which the picture is drawn in full.
constexpr double seconds_to_rest = 0.2;

fs::file_time_type newest(const fs::path& folder) {
  fs::file_time_type time = fs::file_time_type::min();
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) time = std::max(time, entry.last_write_time());
  }
  return time;
}

}  // namespace

Window::Window(const Choices& choices, const WindowSettings& settings,
               std::function<Opened(const std::string&)> open)
    : choices_(choices), settings_(settings), open_(std::move(open)) {
  panel_.stereo_window = choices_.layout == LAYOUT_QUAD_BUFFER;
  const GLFWvidmode* const mode = glfwGetVideoMode(glfwGetPrimaryMonitor());
  if (mode != nullptr && mode->refreshRate > 0) panel_.budget_ms = 1000.0 / mode->refreshRate;
  window_ = open_window(settings_.size, panel_.stereo_window);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  listen();
  context_ = gl::Context::adopt(glfwGetProcAddress);
  log_info("drawing with {} (OpenGL {})", context_->renderer(), context_->version());
  if (!settings_.shader_folder.empty()) {
    context_->set_shader_folder(settings_.shader_folder);
    shaders_changed_ = newest(settings_.shader_folder);
  }
  panel_.requests = {
      .save_pose = [this] { save([this] { return save_pose(); }); },
      .full_screen = [this] { key(GLFW_KEY_F, 0); },
      .add_key = [this] { save_in_folder([this] { return session_->add_key(); }); },
      .play = [this] { play_or_stop(); },
      .record = [this] { record_or_stop(); },
      .move_key = [this](std::size_t k) { save_in_folder([&] { return session_->move_key(k); }); },
      .delete_key = [this](std::size_t k) { delete_key(k); },
      .open = [this](const std::string& file) { open_file(file); },
      .set_ruler_length = [this](double metres) { set_ruler_length(metres); }};
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  enable_keys();
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init("#version 450 core");
  rescale();
}

Window::~Window() {
  recording_.reset();
  session_.reset();
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  context_.reset();
  glfwDestroyWindow(window_);
}

void Window::load(Opened scene, bool again) {
  loading_.scene = std::move(scene);
  loading_.is_same = again;
  loading_.is_read = false;
  loading_.since = glfwGetTime();
  loading_.loaded = std::async(std::launch::async, loading_.scene.load);
}

void Window::run() {
  while (glfwWindowShouldClose(window_) == GLFW_FALSE) {
    wait();
    take_loaded();
    reload_shaders();
    if (session_ && announced_) {
      go();
      play();
      if (session_->moving() && glfwGetTime() - moved_at_ > seconds_to_rest) session_->rest();
      follow_levels();
      if (recording_) session_->change_show();  // a recording needs frames even at rest
      if (draw()) {
        if (recording_) recording_->recorder.add(session_->frames().back());
        measure_pace();
        ui_frames_ = std::max(ui_frames_, 1);
      }
    }
    if (recording_ && glfwGetTime() > recording_->until) record_or_stop();
    if (ui_frames_ > 0) show();
    context_->check_alive();
  }
  if (loading_.loaded.valid() || levels_move()) {
    // Nobody will see the model, and the reading thread holds only memory: quit without waiting.
    log_info("quit while {} was still loading", loading_.loaded.valid() ? loading_.scene.name : scene_.name);
    std::quick_exit(0);
  }
  log_info("{} frames were drawn, {} shown", session_ ? session_->frames_drawn() : 0, shown_);
}

// At rest nothing is drawn. Input, loading models, expiring messages and watched shaders end the wait.
void Window::wait() {
  if (ui_frames_ > 0 || going() || playing_ || recording_) return glfwPollEvents();
  drawn_at_.reset();
  std::optional<double> seconds = messages_.next_change(glfwGetTime());
  const auto at_most = [&](double most) { seconds = std::min(seconds.value_or(most), most); };
  if (loading_.loaded.valid()) at_most(0.05);
  if (levels_.moved || levels_move()) at_most(0.02);
  if (session_ && session_->moving()) at_most(seconds_to_rest);
  if (!settings_.shader_folder.empty()) at_most(0.5);
  if (!seconds) return glfwWaitEvents();
  glfwWaitEventsTimeout(std::max(*seconds, 1e-3));
  if (loading_.loaded.valid() || messages_.next_change(glfwGetTime()) == 0.0)
    ui_frames_ = std::max(ui_frames_, 1);
}

void Window::take_loaded() {
  if (!loading_.loaded.valid() ||
      loading_.loaded.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return;
  if (!loading_.is_read) {  // show a message first, because the upload blocks
    loading_.is_read = true;
    ui_frames_ = 1;
    return;
  }
  try {
    show_model(loading_.scene, loading_.loaded.get(), loading_.is_same);
    scene_ = std::move(loading_.scene);
    recording_.reset();
    playing_.reset();
    announced_ = false;
    log_info("{}: {} Gaussians", scene_.name, levels_.gaussians);
    glfwSetWindowTitle(window_, ("binosplat - " + scene_.name).c_str());
  } catch (const Error& error) {
    if (!session_) throw;
    show_message(error.what(), true);
  }
  ui_frames_ = 3;
}

// `is_same`: a reload of the current scene, which keeps head and choices.
void Window::show_model(const Opened& scene, OpenedModel<Stream> opened, bool is_same) {
  Choices choices = session_ ? session_->choices : choices_;
  const glm::ivec2 eye = glm::max(eye_size_in(choices.layout, picture_size()), 1);
  Start start = scene.start(*context_, opened, choices, eye);
  std::optional<Navigator> head;
  std::optional<KeyList> keys;
  if (session_ && is_same) {
    head = session_->head;
    keys = session_->keys;
    Choices kept = session_->choices;
    kept.calibrated = std::move(choices.calibrated);  // the file may have another model now
    kept.settings.depth_table = std::move(choices.settings.depth_table);
    choices = std::move(kept);
    choices.seeks_screen = choices.seeks_screen && !choices.rig.convergence;  // keeps a chosen convergence
  }
  session_.reset();  // frees its memory first
  levels_ = {opened.stream != nullptr, false, opened.gaussians()};
  session_ = std::make_unique<Session>(*context_, std::move(opened), std::move(start), choices, scene.folder);
  if (head) session_->head = *head;
  if (keys) session_->keys = *keys;
}

bool Window::levels_move() const { return levels_.follow && !session_->stream()->settled(); }

// If reading fails, the current levels stay.
void Window::follow_levels() {
  if (!levels_.follow) return;
  // Levels may settle between two calls, in the reading thread.
  const bool moved = levels_.moved || levels_move();
  try {
    session_->follow_levels();
    levels_.moved = levels_move();
    const Stream& stream = *session_->stream();
    if (moved && !levels_.moved && stream.gaussians() != levels_.gaussians) {
      levels_.gaussians = stream.gaussians();
      const auto db = stream.reported_db();
      log_info("{}: levels of {} Gaussians{}", scene_.name, levels_.gaussians,
               db ? fmt::format(", {:.1f} dB predicted", *db) : "");
    }
  } catch (const Error& error) {
    // If the GPU's memory was exhausted, a part of the model is lost: end the preview.
    if (error.code() == ExitCode::no_gl || error.code() == ExitCode::out_of_memory) throw;
    levels_.follow = false;
    show_message(error.what(), true);
  }
  if (moved) ui_frames_ = 3;
}

void Window::reload_shaders() {
  if (settings_.shader_folder.empty() || !session_) return;
  const auto time = newest(settings_.shader_folder);
  if (time == shaders_changed_) return;
  shaders_changed_ = time;
  context_->set_shader_folder(settings_.shader_folder);
  session_->change();
  show_message("reloaded the shaders");
}

// The window's area beside the panel, in px.
glm::ivec2 Window::picture_size() const {
  glm::ivec2 window, size;
  glfwGetWindowSize(window_, &window.x, &window.y);
  glfwGetFramebufferSize(window_, &size.x, &size.y);
  const auto across = static_cast<float>(std::max(1, window.x));
  size.x -= static_cast<int>(panel_.width(across) * static_cast<float>(size.x) / across);
  return size;
}

// Draws the picture. Returns false if nothing changed.
bool Window::draw() {
  session_->resize(picture_size());
  const bool known = session_->screen_found().has_value();
  const bool drawn = session_->draw();
  if (!known && session_->screen_found()) {
    const std::string text = fmt::format(
        "convergence {:.3g} m, which suits what is seen (`convergence` METRES for another, or inf)",
        *session_->screen_found());
    log_info("{}", text);
    show_message(text);
  }
  return drawn;
}

// Measures the frame rate. Only frames that follow one another directly count.
void Window::measure_pace() {
  const double now = glfwGetTime();
  if (!drawn_at_) frame_seconds_.clear();
  if (drawn_at_) frame_seconds_.push_back(now - *drawn_at_);
  drawn_at_ = now;
  if (frame_seconds_.size() > 30) frame_seconds_.pop_front();
  if (frame_seconds_.size() >= 3)
    panel_.frames_a_second = 1.0 / quantile({frame_seconds_.begin(), frame_seconds_.end()}, 0.5);
}

void Window::show() {
  --ui_frames_;
  if (scale_changed_) rescale();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  const float across = ImGui::GetIO().DisplaySize.x;
  const float beside = session_ ? across - panel_.width(across) : across;
  const double now = glfwGetTime();
  std::vector<Message> messages = messages_.current(now);
  if (session_) {
    if (session_->max_shown()) draw_legend(session_->choices.show, *session_->max_shown(), beside);
    if (!session_->trouble().empty()) messages.push_back({as_shown(session_->trouble()), true});
    if (!announced_)
      messages.push_back({"drawing the first picture: the driver may have to build its shaders"});
    panel_.playing = playing_.has_value();
    panel_.recording = recording_.has_value();
    panel_.draw(*session_);
  }
  if (loading_.loaded.valid()) {
    messages.push_back({fmt::format("reading {}, {:.0f} s\n{}", loading_.scene.name, now - loading_.since,
                                    loading_.is_read ? "to the GPU" : latest_progress())});
  }
  preview::draw(messages, beside);
  ImGui::Render();
  context_->gl().BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  context_->gl().ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
  context_->gl().Clear(GL_COLOR_BUFFER_BIT);
  if (session_) session_->present();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(window_);
  ++shown_;
  if (session_) announced_ = true;
}

// Scales widgets to the display's scale, which may change when the window moves.
void Window::rescale() {
  scale_changed_ = false;
  float scale = 1.0f, ignored = 1.0f;
  glfwGetWindowContentScale(window_, &scale, &ignored);
  glm::ivec2 window, framebuffer;
  glfwGetWindowSize(window_, &window.x, &window.y);
  glfwGetFramebufferSize(window_, &framebuffer.x, &framebuffer.y);
  set_scale(scale,
            static_cast<float>(std::max(1, framebuffer.x)) / static_cast<float>(std::max(1, window.x)));
  ImGui_ImplOpenGL3_DestroyDeviceObjects();  // recreated with the next frame, with the fonts' texture
}

void Window::show_message(const std::string& message, bool trouble) {
  messages_.add(as_shown(message), trouble, glfwGetTime());
  if (trouble) log_warning("{}", message);
  ui_frames_ = std::max(ui_frames_, 1);
}

void run(Opened scene, const Choices& choices, const WindowSettings& settings,
         const std::function<Opened(const std::string& file)>& open) {
  const Glfw glfw;
  Window window(choices, settings, open);
  window.load(std::move(scene));
  window.run();
}

}  // namespace binosplat::preview
