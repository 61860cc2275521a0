#include "preview/times.h"

#include <fmt/core.h>
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

constexpr ImU32 whole_colour = IM_COL32(255, 255, 255, 160), budget_colour = IM_COL32(230, 80, 80, 255),
                event_colour = IM_COL32(255, 170, 40, 255);

/// Geometry of the bar graph of the last frames, in px on the screen.
struct Graph {
  ImVec2 at;
  float width, height, bar;
  std::size_t first, bars;
  double most;  // ms at its upper edge

  float x(std::size_t k) const { return at.x + bar * static_cast<float>(k); }
  float y(double ms) const { return at.y + height * static_cast<float>(1.0 - ms / most); }
};

std::string tooltip_of(const render::FrameRecord& frame, const render::FrameRecord* before) {
  std::string text = fmt::format("{:.2f} ms, GPU {:.2f}", frame.wall_ms(), frame.report.gpu_ms);
  for (const render::FrameEvent& event : render::events_of(frame, before)) text += "\n" + event.text();
  return text;
}

void draw_graph(const Frames& frames, const Graph& graph, double budget_ms) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const auto before = [&](std::size_t n) { return n == 0 ? nullptr : &frames[n - 1]; };
  for (std::size_t k = 0; k < graph.bars; ++k) {
    const std::size_t n = graph.first + k;
    double ms = 0.0;
    const auto& stages = frames[n].report.stages;
    for (std::size_t s = 0; s < stages.size(); ++s) {
      const ImVec2 top(graph.x(k), graph.y(ms + stages[s].ms)), bottom(graph.x(k + 1), graph.y(ms));
      list->AddRectFilled(top, bottom, stage_colours[s % stage_colours.size()]);
      ms += stages[s].ms;
    }
    const float middle = 0.5f * (graph.x(k) + graph.x(k + 1));
    if (k > 0)
      list->AddLine({middle - graph.bar, graph.y(frames[n - 1].wall_ms())},
                    {middle, graph.y(frames[n].wall_ms())}, whole_colour);
    if (!render::events_of(frames[n], before(n)).empty())
      list->AddCircleFilled({middle, graph.at.y + 2.0f}, std::max(2.0f, 0.5f * graph.bar), event_colour);
  }
  list->AddLine({graph.at.x, graph.y(budget_ms)}, {graph.at.x + graph.width, graph.y(budget_ms)},
                budget_colour);
  const float mouse = (ImGui::GetIO().MousePos.x - graph.at.x) / graph.bar;
  if (!ImGui::IsItemHovered() || mouse < 0.0f || mouse >= static_cast<float>(graph.bars)) return;
  const std::size_t n = graph.first + static_cast<std::size_t>(mouse);
  ImGui::SetTooltip("%s", tooltip_of(frames[n], before(n)).c_str());
}

}  // namespace

void draw_speed(const Frames& frames, const std::optional<double>& frames_a_second) {
  if (frames.empty()) return;
  ImGui::Text("%.1f ms a frame", frames.back().report.gpu_ms);
  if (frames_a_second) ImGui::SameLine();
  if (frames_a_second) ImGui::Text("%.*f frames a second", *frames_a_second < 10.0 ? 1 : 0, *frames_a_second);
}

void draw_times(const Frames& frames, double budget_ms) {
  if (frames.empty()) return;
  std::vector<double> totals;
  double most = budget_ms;
  for (const render::FrameRecord& frame : frames) {
    totals.push_back(frame.report.gpu_ms);
    most = std::max({most, totals.back(), frame.wall_ms()});
  }
  ImGui::TextWrapped("GPU: %.2f ms, median %.2f, p99 %.2f; budget %.1f ms", totals.back(),
                     quantile(totals, 0.5), quantile(totals, 0.99), budget_ms);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = 5.0f * ImGui::GetFontSize();
  const float bar = std::max(1.0f, std::floor(width / 120.0f));
  const std::size_t bars = std::min(frames.size(), static_cast<std::size_t>(width / bar));
  ImGui::Dummy({width, height});
  draw_graph(frames, {at, width, height, bar, frames.size() - bars, bars, most}, budget_ms);
  const Report& last = frames.back().report;
  if (ImGui::BeginTable("stages", 2)) {
    for (std::size_t s = 0; s < last.stages.size(); ++s) {
      const auto& stage = last.stages[s];
      ImGui::TableNextColumn();
      ImGui::TextColored(ImColor(stage_colours[s % stage_colours.size()]), "%s %.1f", stage.name.c_str(),
                         stage.ms);
    }
    ImGui::EndTable();
  }
  ImGui::TextWrapped("%.2f M pairs, %.2f M Gaussians in view, %.0f MB",
                     static_cast<double>(last.pairs) * 1e-6, static_cast<double>(last.visible) * 1e-6,
                     static_cast<double>(last.gpu_bytes) * 1e-6);
}

}  // namespace binosplat::preview
