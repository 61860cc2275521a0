#pragma once
// What the user is told over the picture, whether or not there is a panel.

#include <optional>
#include <string>
#include <vector>

namespace binosplat::preview {

struct Message {
  std::string text;
  bool trouble = false;  // something could not be done
  double until = 0.0;    // s
};

/// The last thing that was done and the last few troubles, each for as long as it takes to read. Times are s
/// of one clock that never goes back.
class Messages {
 public:
  /// Says something. What was done takes the place of what was done before; the same trouble again only
  /// prolongs what is there.
  void tell(const std::string& text, bool trouble, double now);
  /// What is to be read now, the oldest first.
  const std::vector<Message>& at(double now);
  /// How long until one goes, in s; none: there is none.
  std::optional<double> next_change(double now) const;

 private:
  std::vector<Message> messages_;
};

/// Draws them one below the other, at the upper left, wrapped to a width in px; between ImGui::NewFrame() and
/// Render().
void draw(const std::vector<Message>& messages, float width);

}  // namespace binosplat::preview
