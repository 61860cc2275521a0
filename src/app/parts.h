#pragma once
// Progress of work that has parts.

#include <memory>
#include <string>

#include "base/progress.h"

namespace binosplat::app {

/// A line of progress for each part of the work.
class Parts {
 public:
  void update(const std::string& what, std::size_t done, std::size_t of) {
    if (what != what_) progress_ = std::make_unique<Progress>(what, of);
    what_ = what;
    progress_->update(done);
  }

 private:
  std::string what_;
  std::unique_ptr<Progress> progress_;
};

}  // namespace binosplat::app
