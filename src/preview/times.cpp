#include "preview/times.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/statistics.h"

namespace binosplat::preview {

namespace {

constexpr std::array<ImU32, 6> stage_colours = {IM_COL32(86, 156, 214, 255),  IM_COL32(78, 201, 176, 255),
                                                IM_COL32(220, 205, 121, 255), IM_COL32(206, 145, 120, 255),
                                                IM_COL32(197, 134, 192, 255), IM_COL32(156, 205, 90, 255)};

}  // namespace

void draw_speed(const std::deque<render::FrameReport>& reports,
                const std::optional<double>& frames_a_second) {
  if (reports.empty()) return;
  ImGui::Text("%.1f ms a frame", reports.back().total_ms);
  if (frames_a_second) ImGui::SameLine();
  if (frames_a_second) ImGui::Text("%.*f frames a second", *frames_a_second < 10.0 ? 1 : 0, *frames_a_second);
}

void draw_times(const std::deque<render::FrameReport>& reports) {
  if (reports.empty()) return;
  std::vector<double> totals;
  for (const render::FrameReport& report : reports) totals.push_back(report.total_ms);
  const double most = *std::max_element(totals.begin(), totals.end());
  ImGui::TextWrapped("GPU: %.2f ms, median %.2f, p99 %.2f", totals.back(), quantile(totals, 0.5),
                     quantile(totals, 0.99));
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = 5.0f * ImGui::GetFontSize();
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
  if (ImGui::BeginTable("stages", 2)) {
    for (std::size_t s = 0; s < reports.back().stages.size(); ++s) {
      const auto& stage = reports.back().stages[s];
      ImGui::TableNextColumn();
      ImGui::TextColored(ImColor(stage_colours[s % stage_colours.size()]), "%s %.1f", stage.name.c_str(),
                         stage.ms);
    }
    ImGui::EndTable();
  }
  const render::FrameReport& last = reports.back();
  ImGui::TextWrapped("%.2f M pairs, %.2f M Gaussians in view, %.0f MB",
                     static_cast<double>(last.pairs) * 1e-6, static_cast<double>(last.visible) * 1e-6,
                     static_cast<double>(last.gpu_bytes) * 1e-6);
}

}  // namespace binosplat::preview
