#pragma once
// Looks at a picture band by band, a band a frame.

#include <cstddef>
#include <vector>

#include "scene/model_parts.h"
#include "shared/types.h"

namespace binosplat {

/// Bands that take about equally long, so that no frame waits for one in which most of a scene lies: all of a
/// street's houses at its end, say, wherever in the picture that is while a head turns.
class LookBands {
 public:
  /// Before the first band of a picture: cuts it by what lay in these directions in the last two, in so many
  /// that each takes so long, or about the least that those take which are allowed.
  void begin(const shared::View& view, double band_ms);
  /// That is looked at next.
  Band next() const { return {edges_[at_], edges_[at_ + 1]}; }
  /// Of a picture.
  bool is_first() const { return at_ == 0; }
  int count() const { return static_cast<int>(edges_.size()) - 1; }

  /// What that took; whether it was the last of a picture.
  bool note(double ms);
  /// Takes a band at most that is too narrow to show anything.
  static constexpr double nothing_ms = 0.5;
  /// Before what is left of a picture.
  void start_again() { at_ = 0; }
  /// So many of the next pictures, or 12.
  void allow(int most);

 private:
  struct Picture {
    shared::View view;
    std::vector<double> edges, ms;  // of its bands; for pixels
    double all_ms = 0.0;            // that it took
  };
  double expected(const shared::View& view, double begin, double end) const;
  void find_fixed(double all_ms);

  std::vector<double> edges_ = {0.0, 1.0};
  std::vector<double> ms_ = {0.0};  // of each
  std::size_t at_ = 0;
  int most_ = 1;
  shared::View view_{};        // of the picture that is looked at,
  std::vector<Picture> last_;  // and those before it, the last first
  double fixed_ms_ = 0.0;      // what any band takes
};

/// Adds what is seen of parts in another band of a view.
void add_band(const std::vector<SeenPart>& more, std::vector<SeenPart>& seen);

}  // namespace binosplat
