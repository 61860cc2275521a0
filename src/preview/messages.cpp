#include "preview/messages.h"

#include <imgui.h>

#include <algorithm>

namespace binosplat::preview {

namespace {

constexpr double seconds_read = 5.0, seconds_of_trouble = 12.0;
constexpr std::size_t max_messages = 4;

}  // namespace

void Messages::add(const std::string& text, bool trouble, double now) {
  std::erase_if(messages_, [&](const Message& m) { return m.text == text || (!trouble && !m.trouble); });
  if (messages_.size() == max_messages) messages_.erase(messages_.begin());
  messages_.push_back({text, trouble, now + (trouble ? seconds_of_trouble : seconds_read)});
}

const std::vector<Message>& Messages::current(double now) {
  std::erase_if(messages_, [now](const Message& m) { return m.until <= now; });
  return messages_;
}

std::optional<double> Messages::next_change(double now) const {
  const auto first = std::min_element(messages_.begin(), messages_.end(),
                                      [](const Message& a, const Message& b) { return a.until < b.until; });
  if (first == messages_.end()) return std::nullopt;
  return std::max(0.0, first->until - now);
}

void draw(const std::vector<Message>& messages, float width) {
  if (messages.empty()) return;
  const float margin = 0.75f * ImGui::GetFontSize();
  const ImGuiStyle& style = ImGui::GetStyle();
  const float max_width = width - 2.0f * (margin + style.WindowPadding.x);
  // Computes the size itself: Dear ImGui would know it one frame later.
  ImVec2 size = {0.0f, -style.ItemSpacing.y};
  for (const Message& message : messages) {
    const ImVec2 one = ImGui::CalcTextSize(message.text.c_str(), nullptr, false, max_width);
    size = {std::max(size.x, one.x), size.y + one.y + style.ItemSpacing.y};
  }
  ImGui::SetNextWindowPos({margin, margin});
  ImGui::SetNextWindowSize({size.x + 2.0f * style.WindowPadding.x, size.y + 2.0f * style.WindowPadding.y});
  // Clicks pass through the text.
  ImGui::Begin(
      "messages", nullptr,
      ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PushTextWrapPos(style.WindowPadding.x + max_width);
  for (const Message& message : messages) {
    if (message.trouble) ImGui::PushStyleColor(ImGuiCol_Text, {1.0f, 0.5f, 0.4f, 1.0f});
    ImGui::TextUnformatted(message.text.c_str());
    if (message.trouble) ImGui::PopStyleColor();
  }
  ImGui::PopTextWrapPos();
  ImGui::End();
}

}  // namespace binosplat::preview
