#pragma once
// Choices of levels that follow one another.

#include <span>
#include <string>
#include <vector>

#include "stream/choice.h"
#include "stream/lod_files.h"

namespace binosplat {

/// Gives each choice the one before it (choose_levels), and warns where even the coarsest levels do not fit.
class Chooser {
 public:
  /// The files must outlive it.
  explicit Chooser(const LodFiles& files) : files_(files) {}

  LevelChoice choose(std::span<const shared::View> views, const DetailRequest& request,
                     const VisibleChunks& visible);
  /// The next choice is made as a first one.
  void forget() { before_.clear(); }

 private:
  const LodFiles& files_;
  std::vector<std::size_t> before_;
  bool warned_ = false;
};

/// Warns that the coarsest levels have `total` Gaussians and only `most` fit.
void warn_of_no_room(const std::string& name, std::size_t total, std::size_t most);

}  // namespace binosplat
