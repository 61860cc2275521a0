#pragma once
// Looks at a picture band by band, a band a frame.

#include <vector>

#include "scene/model_parts.h"

namespace binosplat {

/// Bands that take about equally long, so that no frame waits for one in which most of a scene lies: all of a
/// street's houses at its end, say.
class LookBands {
 public:
  /// That is looked at next.
  Band next() const { return {edges_[at_], edges_[at_ + 1]}; }
  /// Of a picture.
  bool is_first() const { return at_ == 0; }
  int count() const { return static_cast<int>(edges_.size()) - 1; }

  /// What that took; whether it was the last of a picture. The next picture has the same bands.
  bool note(double ms);
  /// Takes a band at most that is too narrow to show anything.
  static constexpr double nothing_ms = 0.5;
  /// Before what is left of a picture.
  void start_again();
  /// Makes other bands by what they took since the last time, each in the picture where it took least, since
  /// anything may hold up a frame: so many that each takes what a frame has for it, or about the least that
  /// up to `most` of them take.
  void divide(int most);

 private:
  void find_fixed(double all_ms);

  std::vector<double> edges_ = {0.0, 1.0};
  std::vector<double> ms_ = {0.0};  // of each, in the picture where it took least
  std::size_t at_ = 0;
  bool is_known_ = false;                    // from another picture
  int before_ = 1;                           // bands the last time, and
  double before_ms_ = 0.0, fixed_ms_ = 0.0;  // what a picture took then; what any band takes
};

/// Adds what is seen of parts in another band of a view.
void add_band(const std::vector<SeenPart>& more, std::vector<SeenPart>& seen);

}  // namespace binosplat
