#pragma once
// Successive choices of levels.

#include <span>
#include <string>
#include <vector>

#include "stream/level_choice.h"
#include "stream/lod_files.h"

namespace binosplat {

/// Calls choose_levels() with the previous choice as `before`. Warns if even the coarsest levels do not fit.
class Chooser {
 public:
  /// The files must outlive this object.
  explicit Chooser(const LodFiles& files) : files_(files) {}

  LevelChoice choose(std::span<const shared::View> views, const DetailRequest& request,
                     const VisibleChunks& visible);
  /// Makes the next choice independent of earlier choices.
  void forget() { before_.clear(); }

 private:
  const LodFiles& files_;
  std::vector<std::size_t> before_;
  bool warned_ = false;
};

void warn_over_limit(const std::string& name, std::size_t total, std::size_t most);

}  // namespace binosplat
