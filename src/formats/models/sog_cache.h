#pragma once
// A cache of SOGs' decoded pictures, for streams that repeatedly read a few Gaussians.

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>

#include "formats/models/sog_source.h"

namespace binosplat {

/// Keeps the most recently used pictures. Several threads may call it.
class SogCache {
 public:
  /// Keeps at most this many bytes. Pictures in use may take more.
  explicit SogCache(std::size_t most) : most_(most) {}

  /// Returns the decoded pictures of `source`, which `number` identifies. Throws Error as decoding them does.
  std::shared_ptr<const SogSource::Textures> textures(std::size_t number, const SogSource& source);
  bool has(std::size_t number);

 private:
  struct Kept {
    std::size_t number;
    std::shared_ptr<const SogSource::Textures> textures;
  };

  std::size_t most_;
  std::mutex mutex_;
  std::list<Kept> kept_;  // most recently used first
  std::size_t bytes_ = 0;
};

}  // namespace binosplat
