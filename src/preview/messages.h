#pragma once
// Messages over the picture, with or without the panel.

#include <optional>
#include <string>
#include <vector>

namespace binosplat::preview {

struct Message {
  std::string text;
  bool trouble = false;  // a failure
  double until = 0.0;    // s
};

/// The last action and the last few failures, each for as long as reading takes. Times: s, monotonic clock.
class Messages {
 public:
  /// Adds a message. An action replaces the previous action. A repeated failure only extends its time.
  void add(const std::string& text, bool trouble, double now);
  /// The oldest message is first.
  const std::vector<Message>& current(double now);
  /// Time until a message ends, in s; none without messages.
  std::optional<double> next_change(double now) const;

 private:
  std::vector<Message> messages_;
};

/// Draws messages from the upper left down, `width` px wide. Call between ImGui::NewFrame() and Render().
void draw(const std::vector<Message>& messages, float width);

}  // namespace binosplat::preview
