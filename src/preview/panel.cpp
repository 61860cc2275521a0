#include "preview/panel.h"

#include <fmt/core.h>
#include <imgui.h>
#include <imgui/imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "preview/keys.h"
#include "preview/times.h"

namespace binosplat::preview {

namespace {

// A combo box of the values of a setting (shared/choices.h), except `left_out`.
template <typename Value, std::size_t n>
bool combo(const char* label, Value& value, const Choice (&choices)[n],
           std::initializer_list<int> left_out = {}) {
  bool changed = false;
  const int chosen = static_cast<int>(value);
  if (!ImGui::BeginCombo(label, choices[chosen].name)) return false;
  for (int k = 0; k < static_cast<int>(n); ++k) {
    if (std::find(left_out.begin(), left_out.end(), k) != left_out.end()) continue;
    if (ImGui::Selectable(choices[k].name, k == chosen)) {
      value = static_cast<Value>(k);
      changed = true;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", choices[k].help);
  }
  ImGui::EndCombo();
  return changed;
}

bool factor_slider(const char* label, double& value, double least, double most, const char* format) {
  auto number = static_cast<float>(value);
  if (!ImGui::SliderFloat(label, &number, static_cast<float>(least), static_cast<float>(most), format,
                          ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoRoundToFormat))
    return false;
  value = std::max(0.01 * least, static_cast<double>(number));  // typed numbers may exceed the slider's range
  return true;
}

bool draw_rig(Choices& choices) {
  stereo::RigSettings& rig = choices.rig;
  bool changed = false;
  float ipd = static_cast<float>(1000.0 * rig.ipd);
  if (ImGui::SliderFloat("ipd", &ipd, 0.0f, 200.0f, "%.1f mm")) {
    rig.ipd = std::max(0.0f, ipd) / 1000.0;
    changed = true;
  }
  changed |= factor_slider("units per metre", rig.units_per_metre, 0.01, 100.0, "%.3f");
  const auto before = rig.convergence;
  bool converges = rig.convergence.has_value();
  if (ImGui::Checkbox("convergence", &converges)) {
    rig.convergence = converges ? std::optional(2.0) : std::nullopt;
    changed = true;
  }
  if (rig.convergence)
    changed |= factor_slider("convergence distance", *rig.convergence, 0.2, 50.0, "%.2f m");
  if (rig.convergence != before) choices.seeks_screen = false;  // the next model keeps this choice, too
  return changed;
}

// The right end of the slider means exact.
bool draw_quality(render::FrameSettings& s) {
  constexpr float least = 25.0f, exact = 60.0f;
  float db = s.quality.value_or(exact);
  const char* const format = s.quality                                       ? "%.0f dB"
                             : is_exact(s)                                   ? "exact"
                             : render::is_exact(render::chosen_threshold(s)) ? "set by tile test"
                                                                             : "set by tolerance";
  if (!ImGui::SliderFloat("quality", &db, least, exact, format, ImGuiSliderFlags_AlwaysClamp)) return false;
  choose_quality(s, db < exact ? std::optional(std::round(db)) : std::nullopt);
  return true;
}

bool draw_thresholds(render::FrameSettings& s, const adagscale::CalibratedThreshold& calibrated) {
  bool changed = combo("tiles", s.tiles, tiles_choices, {TILES_ALL});
  Threshold threshold = render::chosen_threshold(s);
  if (combo("threshold", threshold, threshold_choices)) {
    choose_threshold(s, threshold);
    changed = true;
  }
  if (render::is_exact(threshold)) return changed;
  float tolerance = s.tolerance.value_or(0.0f);
  const char* const format = s.quality ? "by quality" : s.tolerance ? "%.3f" : "as calibrated";
  if (ImGui::SliderFloat("tolerance", &tolerance, 0.001f, 10.0f, format, ImGuiSliderFlags_Logarithmic)) {
    s.tolerance = std::max(0.001f, tolerance);
    s.quality.reset();
    changed = true;
  }
  const bool has_table = calibrated.is_calibrated() || !s.depth_table.bounds.empty();
  Transmittance source = render::chosen_transmittance(s);
  if (combo("transmittance", source, transmittance_choices, {has_table ? -1 : TRANSMITTANCE_DEPTH})) {
    s.transmittance = source;
    changed = true;
  }
  if (calibrated.has_entry(s) && (s.tolerance || s.quality) && ImGui::Button("as calibrated")) {
    s.tolerance.reset();
    s.quality.reset();
    changed = true;
  }
  return changed;
}

void draw_row(const char* name, const Report& report, const std::string& psnr) {
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(name);
  for (const std::string& text : {fmt::format("{:.3g} M", 1e-6 * static_cast<double>(report.pairs)),
                                  fmt::format("{:.2f} ms", report.gpu_ms), psnr}) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(text.c_str());
  }
}

// Pairs, GPU time and error of the drawn picture, and of the exact one.
void draw_effect(const ThresholdEffect& effect) {
  if (!ImGui::BeginTable("effect", 4)) return;
  for (const char* name : {"", "pairs", "GPU", "PSNR"}) ImGui::TableSetupColumn(name);
  ImGui::TableHeadersRow();
  draw_row("drawn", effect.drawn, std::isinf(effect.psnr) ? "equal" : fmt::format("{:.1f} dB", effect.psnr));
  draw_row("exact", effect.exact, "");
  ImGui::EndTable();
}

void draw_keys() {
  if (!ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) return;
  ImGui::TableSetupColumn("keys");
  ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthStretch);
  for (const KeyHelp& key : key_help) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(key.keys);
    ImGui::TableNextColumn();
    ImGui::TextWrapped("%s", key.what);
  }
  ImGui::EndTable();
}

}  // namespace

void Panel::next_layout(int& layout, int by) const {
  const int count = static_cast<int>(std::size(layout_choices));
  do layout = (layout + by + count) % count;
  while (layout == LAYOUT_MULTI_VIEW || (layout == LAYOUT_QUAD_BUFFER && !stereo_window));
}

float Panel::width(float window) const {
  return open ? std::floor(std::min(23.0f * ImGui::GetFontSize(), 0.5f * window)) : 0.0f;
}

bool Panel::draw_view(Session& session) {
  Choices& c = session.choices;
  bool changed = false;
  if (ImGui::Button("reset view")) session.reset_view();
  ImGui::SameLine();
  if (ImGui::Button("show all (Z)")) session.show_all();
  if (ImGui::Button("set up direction")) session.set_up_direction();
  ImGui::SameLine();
  if (ImGui::Button("save pose")) requests.save_pose();
  ImGui::TextWrapped("camera: %s", session.place_name().c_str());
  ImGui::Checkbox("walk", &walking);
  ImGui::SameLine();
  changed |= ImGui::Checkbox("grid (B)", &c.grid);
  ImGui::SameLine();
  ImGui::BeginDisabled(!session.has_cameras());
  changed |= ImGui::Checkbox("cameras (C)", &c.cameras);
  ImGui::EndDisabled();
  auto fov = static_cast<float>(glm::degrees(session.head.fov()));
  if (ImGui::SliderFloat("field of view", &fov, 10.0f, 120.0f, "%.0f degrees",
                         ImGuiSliderFlags_AlwaysClamp)) {
    session.head.set_fov(glm::radians(static_cast<double>(fov)));
    changed = true;
  }
  changed |= factor_slider("near plane", c.rig.near_plane, 0.001, 10.0, "%.3f units");
  changed |= ImGui::ColorEdit3("background", &c.background.x, ImGuiColorEditFlags_NoInputs);
  ImGui::InputInt("saved width", &c.saved_width, 100, 1000);
  c.saved_width = std::clamp(c.saved_width, 0, 16384);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("px of what F12 and F11 save; 0: as wide as the picture here");
  return changed;
}

void Panel::draw_path(Session& session) {
  const std::vector<Camera>& keys = session.keys.keys();
  if (ImGui::Button("add key (K)")) requests.add_key();
  if (keys.size() > 1) {
    ImGui::SameLine();
    if (ImGui::Button(playing ? "stop (Space)" : "play (Space)")) requests.play();
  }
  for (std::size_t k = 0; k < keys.size(); ++k) {
    ImGui::PushID(static_cast<int>(k));
    const std::string name = fmt::format("{}: {:.1f} s", k, *keys[k].time);
    if (ImGui::Button("go")) session.go_to(keys[k]);
    ImGui::SameLine();
    const bool moved = ImGui::Button("move here");
    ImGui::SameLine();
    const bool deleted = ImGui::Button("delete");
    ImGui::SameLine();
    ImGui::TextUnformatted(name.c_str());
    ImGui::PopID();
    if (deleted) return requests.delete_key(k);
    if (moved) requests.move_key(k);
  }
  if (!keys.empty()) ImGui::TextWrapped("%s", session.keys.file().c_str());
}

void Panel::draw_ruler(double units) {
  ImGui::TextWrapped("the two points are %.3g units apart: type their distance", units);
  if (takes_length &&
      !ImGui::IsMouseDown(ImGuiMouseButton_Left)) {  // a click beside the panel takes the focus
    takes_length = false;
    metres_ = 0.0;
    ImGui::SetKeyboardFocusHere();
  }
  const bool entered =
      ImGui::InputDouble("metres", &metres_, 0.0, 0.0, "%.6g", ImGuiInputTextFlags_EnterReturnsTrue);
  if (entered && metres_ > 0.0) requests.set_ruler_length(metres_);
}

void Panel::draw_open() {
  const bool entered =
      ImGui::InputTextWithHint("file", "a model's path", &file_, ImGuiInputTextFlags_EnterReturnsTrue);
  if ((ImGui::Button("open") || entered) && !file_.empty()) requests.open(file_);
  ImGui::SameLine();
  ImGui::TextDisabled("or drop it on the window");
}

void Panel::draw_times_of(Session& session) {
  draw_times(session.frames(), budget_ms);
  if (ImGui::Button(recording ? "stop recording (F8)" : "record 10 s (F8)")) requests.record();
}

void Panel::draw_accuracy(Session& session) {
  Choices& c = session.choices;
  bool changed = draw_thresholds(c.settings, c.calibrated);
  if (is_exact(c.settings)) {
    ImGui::TextWrapped("exact: choose a threshold, or less quality");
  } else {
    changed |= ImGui::Checkbox("the exact picture (X)", &c.flipped);
  }
  if (changed) session.change();
  if (const auto& effect = session.threshold_effect()) draw_effect(*effect);
}

void Panel::draw_controls(Session& session) {
  Choices& c = session.choices;
  bool changed = stereo_window
                     ? combo("layout", c.layout, layout_choices, {LAYOUT_MULTI_VIEW})
                     : combo("layout", c.layout, layout_choices, {LAYOUT_MULTI_VIEW, LAYOUT_QUAD_BUFFER});
  bool shown = combo("show", c.show, show_choices);
  if (c.show == SHOW_SPLIT) {
    float split = static_cast<float>(c.split);
    shown |= ImGui::SliderFloat("split", &split, 0.0f, 1.0f, "drawn < %.2f > exact");
    c.split = std::clamp(split, 0.0f, 1.0f);
  }
  if (shown) session.change_show();
  changed |= draw_quality(c.settings);
  if (ImGui::CollapsingHeader("view", ImGuiTreeNodeFlags_DefaultOpen)) changed |= draw_view(session);
  if (ImGui::CollapsingHeader("eyes", ImGuiTreeNodeFlags_DefaultOpen)) changed |= draw_rig(c);
  if (changed) session.change();
}

void Panel::draw(Session& session) {
  if (!open) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x - width(size.x), 0.0f});
  ImGui::SetNextWindowSize({width(size.x), size.y});
  if (std::exchange(takes_keys, false)) ImGui::SetNextWindowFocus();
  ImGui::Begin("panel", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoMove);
  ImGui::PushItemWidth(-8.0f * ImGui::GetFontSize());
  if (ImGui::Button("hide (F1)")) open = false;
  ImGui::SameLine();
  if (ImGui::Button("full screen (F)")) requests.full_screen();
  draw_speed(session.frames(), frames_a_second);
  if (const auto units = session.ruler_length()) draw_ruler(*units);
  draw_controls(session);
  if (ImGui::CollapsingHeader("accuracy", ImGuiTreeNodeFlags_DefaultOpen)) draw_accuracy(session);
  if (ImGui::CollapsingHeader("path", ImGuiTreeNodeFlags_DefaultOpen)) draw_path(session);
  if (ImGui::CollapsingHeader("open", ImGuiTreeNodeFlags_DefaultOpen)) draw_open();
  if (ImGui::CollapsingHeader("times")) draw_times_of(session);
  if (ImGui::CollapsingHeader("keys")) draw_keys();
  ImGui::PopItemWidth();
  ImGui::End();
}

void draw_legend(int show, double most, float width) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float line = ImGui::GetFontSize(), margin = 0.75f * line;
  const float bar = std::max(1.0f, std::min(20.0f * line, width - 2.0f * (margin + style.WindowPadding.x)));
  const std::string title = fmt::format("{}: {}", show_choices[show].name, show_choices[show].help);
  const std::string end = fmt::format("{} and more", most);
  // Computes the size itself: Dear ImGui would know it one frame later.
  const float texts = ImGui::CalcTextSize(title.c_str(), nullptr, false, bar).y;
  const ImVec2 size = {bar + 2.0f * style.WindowPadding.x,
                       texts + 2.0f * (line + style.ItemSpacing.y + style.WindowPadding.y)};
  ImGui::SetNextWindowPos({width - margin, ImGui::GetIO().DisplaySize.y - margin}, ImGuiCond_Always, {1, 1});
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("legend", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs);
  ImGui::PushTextWrapPos(style.WindowPadding.x + bar);
  ImGui::TextUnformatted(title.c_str());
  ImGui::PopTextWrapPos();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  for (float x = 0; x < bar; ++x) {
    const glm::vec3 colour = stereo::map_colour(x / bar);
    ImGui::GetWindowDrawList()->AddRectFilled({at.x + x, at.y}, {at.x + x + 1.0f, at.y + line},
                                              ImColor(colour.r, colour.g, colour.b));
  }
  ImGui::Dummy({bar, line});
  ImGui::Text("0");
  ImGui::SameLine(style.WindowPadding.x + bar - ImGui::CalcTextSize(end.c_str()).x);
  ImGui::TextUnformatted(end.c_str());
  ImGui::End();
}

void enable_keys() {
  // Keeps the window's keys working after a widget was used.
  ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard | ImGuiConfigFlags_NavNoCaptureKeyboard;
}

namespace {

// Loads DejaVu Sans from the paths of Debian, Fedora and Arch; else Dear ImGui's font of 13 px, scaled.
void choose_font(float scale) {
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  fonts.Clear();
  for (const char* file :
       {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
        "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf"}) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) continue;
    fonts.AddFontFromFileTTF(file, std::floor(15.0f * scale));
    return;
  }
  ImFontConfig config;
  config.SizePixels = std::floor(13.0f * scale);
  fonts.AddFontDefault(&config);
}

}  // namespace

void set_scale(float scale, float pixels) {
  ImGuiIO& io = ImGui::GetIO();
  choose_font(scale);
  io.FontGlobalScale = 1.0f / pixels;
  ImGui::GetStyle() = ImGuiStyle();
  ImGui::StyleColorsDark();
  ImGui::GetStyle().ScaleAllSizes(scale / pixels);
}

}  // namespace binosplat::preview
