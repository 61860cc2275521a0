#pragma once
// Choices of levels one after the other.

#include <span>
#include <string>
#include <vector>

#include "stream/choice.h"
#include "stream/lod_files.h"

namespace binosplat {

/// Each choice goes by the one before it (choose_levels). Warns where even the coarsest levels do not fit.
class Chooser {
 public:
  /// Of files that must outlive it.
  explicit Chooser(const LodFiles& files) : files_(files) {}

  LevelChoice choose(std::span<const shared::View> views, const DetailRequest& request,
                     const VisibleChunks& visible);
  /// There is no choice before the next one.
  void forget() { before_.clear(); }

 private:
  const LodFiles& files_;
  std::vector<std::size_t> before_;
  bool warned_ = false;
};

/// That not even the coarsest levels fit.
void warn_of_no_room(const std::string& name, std::size_t total, std::size_t most);

}  // namespace binosplat
