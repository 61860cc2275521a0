#pragma once
// Pictures of SOGs that are read again and again, a few Gaussians at a time.

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>

#include "formats/sog_source.h"

namespace binosplat {

/// Keeps those that were used last. May be called by several threads.
class SogCache {
 public:
  /// So many bytes at most, beside those that are in use.
  explicit SogCache(std::size_t most) : most_(most) {}

  /// The pictures of the SOG that has this number. Throws Error as decoding them does.
  std::shared_ptr<const SogSource::Textures> textures(std::size_t number, const SogSource& source);
  bool has(std::size_t number);

 private:
  struct Kept {
    std::size_t number;
    std::shared_ptr<const SogSource::Textures> textures;
  };

  std::size_t most_;
  std::mutex mutex_;
  std::list<Kept> kept_;  // the last used first
  std::size_t bytes_ = 0;
};

}  // namespace binosplat
