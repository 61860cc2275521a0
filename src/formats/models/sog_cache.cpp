#include "formats/models/sog_cache.h"

#include <algorithm>

namespace binosplat {

std::shared_ptr<const SogSource::Textures> SogCache::textures(std::size_t number, const SogSource& source) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto it = std::ranges::find(kept_, number, &Kept::number); it != kept_.end()) {
      kept_.splice(kept_.begin(), kept_, it);
      return it->textures;
    }
  }
  auto textures = source.textures();
  const std::lock_guard lock(mutex_);
  kept_.push_front({number, textures});
  bytes_ += textures->bytes();
  while (bytes_ > most_) {
    bytes_ -= kept_.back().textures->bytes();
    kept_.pop_back();
  }
  return textures;
}

bool SogCache::has(std::size_t number) {
  const std::lock_guard lock(mutex_);
  return std::ranges::find(kept_, number, &Kept::number) != kept_.end();
}

}  // namespace binosplat
