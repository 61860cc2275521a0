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
  /// Before what is left of a picture.
  void start_again();
  /// Makes other bands by what they took since the last time, each in the picture where it took least, since
  /// anything may hold up a frame: so many that each takes what a frame has for it, but `most` at most.
  void divide(int most);

 private:
  std::vector<double> edges_ = {0.0, 1.0};
  std::vector<double> ms_ = {0.0};  // of each, in the picture where it took least
  std::size_t at_ = 0;
  bool is_known_ = false;  // from another picture
};

}  // namespace binosplat
