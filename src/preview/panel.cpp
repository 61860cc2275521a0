#include "preview/panel.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/statistics.h"

namespace binosplat::preview {

namespace {

constexpr std::array<ImU32, 6> stage_colours = {IM_COL32(86, 156, 214, 255),  IM_COL32(78, 201, 176, 255),
                                                IM_COL32(220, 205, 121, 255), IM_COL32(206, 145, 120, 255),
                                                IM_COL32(197, 134, 192, 255), IM_COL32(156, 205, 90, 255)};

// A choice of shared/axes.h, from `first` on and without `left_out`.
template <std::size_t n>
bool combo(const char* label, int& value, const Choice (&choices)[n], int left_out = -1) {
  bool changed = false;
  if (!ImGui::BeginCombo(label, choices[value].name)) return false;
  for (int k = 0; k < static_cast<int>(n); ++k) {
    if (k == left_out) continue;
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
  bool changed = combo("tiles", s.tiles, tiles_choices, TILES_ALL);
  if (combo("th", s.th, th_choices)) {
    changed = true;
    if (s.th != TH_TAU && s.loss == 0.0f) s.loss = 0.15f;
  }
  if (s.th == TH_TAU) return changed;
  changed |= ImGui::SliderFloat("loss", &s.loss, 0.001f, 10.0f, "%.3f", ImGuiSliderFlags_Logarithmic);
  s.loss = std::max(0.0f, s.loss);
  // The depth table needs cameras to be measured from: `binosplat render` has it.
  changed |= combo("transmittance", s.transmittance, transmittance_choices, TRANSMITTANCE_DEPTH);
  if (s.th == TH_SQUARED && render::measures(s.transmittance))
    changed |= combo("contrast", s.contrast, contrast_choices);
  changed |= combo("th-eyes", s.th_eyes, th_eyes_choices);
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

}  // namespace

void Panel::draw(Session& session) {
  if (!open) return;
  ImGui::SetNextWindowPos({10, 10}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({370, 470}, ImGuiCond_FirstUseEver);
  if (ImGui::Begin("binosplat", &open)) {
    Choices& c = session.choices;
    bool changed = combo("layout", c.layout, layout_choices, LAYOUT_MULTI_VIEW);
    changed |= draw_rig(c.rig);
    changed |= draw_thresholds(c.settings);
    changed |= ImGui::ColorEdit3("background", &c.background.x);
    ImGui::Checkbox("walk (G)", &walking);
    if (changed) {
      session.change();
      psnr.reset();
    }
    draw_times(session.reports());
    if (ImGui::Button("PSNR against exact")) psnr = session.psnr_against_exact();
    ImGui::SameLine();
    if (psnr) ImGui::Text(std::isinf(*psnr) ? "equal" : "%.2f dB", *psnr);
    ImGui::TextWrapped("%s  %s", session.camera_name().c_str(), message.c_str());
    if (!session.trouble().empty()) ImGui::TextColored({1, 0.4f, 0.3f, 1}, "%s", session.trouble().c_str());
    ImGui::TextDisabled(
        "drag: orbit, right: look, middle: move, wheel: nearer\nWASD QE: go, double click: focus\n"
        "N P: cameras, L T H: layout, tiles, th\nF12 F11: PNG, EXR, K: key of a path, F1: this");
  }
  ImGui::End();
}

void draw_loading(const std::string& scene, double seconds) {
  ImGui::SetNextWindowPos({10, 10});
  ImGui::Begin("loading", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar);
  ImGui::Text("reading %s, %.0f s", scene.c_str(), seconds);
  ImGui::End();
}

}  // namespace binosplat::preview
