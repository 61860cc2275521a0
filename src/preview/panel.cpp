#include "preview/panel.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/progress.h"
#include "base/statistics.h"

namespace binosplat::preview {

namespace {

constexpr std::array<ImU32, 6> stage_colours = {IM_COL32(86, 156, 214, 255),  IM_COL32(78, 201, 176, 255),
                                                IM_COL32(220, 205, 121, 255), IM_COL32(206, 145, 120, 255),
                                                IM_COL32(197, 134, 192, 255), IM_COL32(156, 205, 90, 255)};

// A choice of shared/axes.h, without those that are left out.
template <std::size_t n>
bool combo(const char* label, int& value, const Choice (&choices)[n],
           std::initializer_list<int> left_out = {}) {
  bool changed = false;
  if (!ImGui::BeginCombo(label, choices[value].name)) return false;
  for (int k = 0; k < static_cast<int>(n); ++k) {
    if (std::find(left_out.begin(), left_out.end(), k) != left_out.end()) continue;
    if (ImGui::Selectable(choices[k].name, k == value)) {
      value = k;
      changed = true;
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", choices[k].help);
  }
  ImGui::EndCombo();
  return changed;
}

bool draw_rig(stereo::RigSettings& rig) {
  bool changed = false;
  float ipd = static_cast<float>(1000.0 * rig.ipd);
  if (ImGui::SliderFloat("ipd, mm", &ipd, 0.0f, 200.0f, "%.1f")) {
    rig.ipd = std::max(0.0f, ipd) / 1000.0;
    changed = true;
  }
  float units = static_cast<float>(rig.units_per_metre);
  if (ImGui::SliderFloat("units a metre", &units, 0.01f, 100.0f, "%.3f", ImGuiSliderFlags_Logarithmic)) {
    rig.units_per_metre = std::max(0.0001f, units);
    changed = true;
  }
  bool converges = rig.convergence.has_value();
  if (ImGui::Checkbox("convergence", &converges)) {
    rig.convergence = converges ? std::optional(2.0) : std::nullopt;
    changed = true;
  }
  if (rig.convergence) {
    float metres = static_cast<float>(*rig.convergence);
    ImGui::SameLine();
    if (ImGui::SliderFloat("m", &metres, 0.2f, 50.0f, "%.2f", ImGuiSliderFlags_Logarithmic)) {
      rig.convergence = std::max(0.01f, metres);
      changed = true;
    }
  }
  return changed;
}

bool draw_thresholds(render::FrameSettings& s) {
  bool changed = combo("tiles", s.tiles, tiles_choices, {TILES_ALL});
  if (combo("th", s.th, th_choices)) {
    choose_threshold(s, s.th);
    changed = true;
  }
  if (render::is_exact(s.th)) return changed;
  changed |=
      ImGui::SliderFloat("tolerance", &s.tolerance, 0.001f, 10.0f, "%.3f", ImGuiSliderFlags_Logarithmic);
  s.tolerance = std::max(0.0f, s.tolerance);
  // The depth table needs cameras to be measured from: `binosplat render` has it.
  if (render::threshold_rules[s.th].uses_bound)
    changed |= combo("transmittance", s.transmittance, transmittance_choices, {TRANSMITTANCE_DEPTH});
  return changed;
}

// Stage times of the last frames as stacked bars.
void draw_times(const std::deque<render::FrameReport>& reports) {
  if (reports.empty()) return;
  std::vector<double> totals;
  for (const render::FrameReport& report : reports) totals.push_back(report.total_ms);
  const double most = *std::max_element(totals.begin(), totals.end());
  ImGui::Text("%.2f ms, median %.2f, p99 %.2f", totals.back(), quantile(totals, 0.5), quantile(totals, 0.99));
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = 60.0f;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float bar = std::max(1.0f, std::floor(width / 120.0f));
  const std::size_t bars = std::min(reports.size(), static_cast<std::size_t>(width / bar));
  for (std::size_t k = 0; k < bars; ++k) {
    float bottom = at.y + height;
    const float x = at.x + bar * static_cast<float>(k);
    const auto& stages = reports[reports.size() - bars + k].stages;
    for (std::size_t s = 0; s < stages.size(); ++s) {
      const float top = bottom - static_cast<float>(stages[s].ms / most) * height;
      list->AddRectFilled({x, top}, {x + bar, bottom}, stage_colours[s % stage_colours.size()]);
      bottom = top;
    }
  }
  ImGui::Dummy({width, height});
  for (std::size_t s = 0; s < reports.back().stages.size(); ++s) {
    const auto& stage = reports.back().stages[s];
    ImGui::TextColored(ImColor(stage_colours[s % stage_colours.size()]), "%s %.1f", stage.name.c_str(),
                       stage.ms);
    if (s % 3 != 2) ImGui::SameLine(120.0f * static_cast<float>(s % 3 + 1));
  }
  ImGui::NewLine();
  const render::FrameReport& last = reports.back();
  ImGui::TextWrapped("%.2f M pairs, %.2f M Gaussians in view, %.0f MB",
                     static_cast<double>(last.pairs) * 1e-6, static_cast<double>(last.visible) * 1e-6,
                     static_cast<double>(last.gpu_bytes) * 1e-6);
}

// What the colours of a map mean, at the lower right.
void draw_legend(int show, double most) {
  constexpr float width = 256.0f, height = 12.0f;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x - 10, size.y - 10}, ImGuiCond_Always, {1, 1});
  ImGui::Begin("legend", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoDecoration);
  ImGui::Text("%s: %s", show_choices[show].name, show_choices[show].help);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  for (float x = 0; x < width; ++x) {
    const glm::vec3 colour = stereo::map_colour(x / (width - 1.0f));
    ImGui::GetWindowDrawList()->AddRectFilled({at.x + x, at.y}, {at.x + x + 1.0f, at.y + height},
                                              ImColor(colour.r, colour.g, colour.b));
  }
  ImGui::Dummy({width, height});
  ImGui::Text("0");
  const std::string end = fmt::format("{} and more", most);
  ImGui::SameLine(width - ImGui::CalcTextSize(end.c_str()).x);
  ImGui::TextUnformatted(end.c_str());
  ImGui::End();
}

}  // namespace

void Panel::next_layout(int& layout, int by) const {
  const int count = static_cast<int>(std::size(layout_choices));
  do layout = (layout + by + count) % count;
  while (layout == LAYOUT_MULTI_VIEW || (layout == LAYOUT_QUAD_BUFFER && !stereo_window));
}

// What is shown of the frame; true if that changes.
bool Panel::draw_show(Choices& c) {
  bool changed = combo("show", c.show, show_choices);
  if (c.show == SHOW_SPLIT) {
    float split = static_cast<float>(c.split);
    changed |= ImGui::SliderFloat("split", &split, 0.0f, 1.0f, "drawn < %.2f > exact");
    c.split = std::clamp(split, 0.0f, 1.0f);
  }
  return changed;
}

void Panel::draw_controls(Session& session) {
  Choices& c = session.choices;
  bool changed = stereo_window
                     ? combo("layout", c.layout, layout_choices, {LAYOUT_MULTI_VIEW})
                     : combo("layout", c.layout, layout_choices, {LAYOUT_MULTI_VIEW, LAYOUT_QUAD_BUFFER});
  changed |= draw_rig(c.rig);
  changed |= draw_thresholds(c.settings);
  if (draw_show(c)) session.change_show();
  changed |= ImGui::ColorEdit3("background", &c.background.x);
  ImGui::Checkbox("walk (G)", &walking);
  ImGui::SameLine();
  if (ImGui::Button("this is up")) session.set_up();
  ImGui::SameLine();
  if (ImGui::Button("save pose")) save_pose();
  if (changed) {
    session.change();
    psnr.reset();
  }
}

void Panel::draw(Session& session) {
  if (session.most_shown()) draw_legend(session.choices.show, *session.most_shown());
  if (!open) {
    if (!session.trouble().empty()) draw_message(session.trouble());
    return;
  }
  ImGui::SetNextWindowPos({10, 10}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({370, 560}, ImGuiCond_FirstUseEver);
  if (ImGui::Begin("binosplat", &open)) {
    draw_controls(session);
    draw_times(session.reports());
    if (ImGui::Button("PSNR against exact")) psnr = session.psnr_against_exact();
    if (psnr) ImGui::SameLine();
    if (psnr) ImGui::Text(std::isinf(*psnr) ? "equal" : "%.2f dB", *psnr);
    ImGui::TextWrapped("%s  %s", session.camera_name().c_str(), message.c_str());
    if (!session.trouble().empty()) ImGui::TextColored({1, 0.4f, 0.3f, 1}, "%s", session.trouble().c_str());
    ImGui::TextDisabled(
        "drag: orbit, right: look, middle: move, wheel: nearer\nWASD QE: go, double click: focus\n"
        "N P: cameras, L T H V: layout, tiles, th, show\nF12 F11: PNG, EXR, K: key of a path, F9: save pose\n"
        "F5: read the model again, F1: this");
  }
  ImGui::End();
}

void draw_loading(const std::string& scene, bool read, double seconds) {
  ImGui::SetNextWindowPos({10, 10});
  ImGui::Begin("loading", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar);
  ImGui::Text("reading %s, %.0f s", scene.c_str(), seconds);
  ImGui::TextUnformatted(read ? "to the GPU" : latest_progress().c_str());
  ImGui::End();
}

void draw_message(const std::string& message) {
  ImGui::SetNextWindowPos({10, 10});
  ImGui::Begin("message", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar);
  ImGui::PushTextWrapPos(0.9f * ImGui::GetIO().DisplaySize.x);
  ImGui::TextUnformatted(message.c_str());
  ImGui::PopTextWrapPos();
  ImGui::End();
}

}  // namespace binosplat::preview
