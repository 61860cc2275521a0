#include "formats/sog_cache.h"

#include <algorithm>

namespace binosplat {

std::shared_ptr<const SogSource::Textures> SogCache::textures(std::size_t number, const SogSource& source) {
  if (auto found = find(number)) return found;
  const auto textures = source.textures();
  const std::lock_guard lock(mutex_);
  kept_.push_front({number, textures});
  bytes_ += textures->bytes();
  while (bytes_ > most_) {
    bytes_ -= kept_.back().textures->bytes();
    kept_.pop_back();
  }
  return textures;
}

std::shared_ptr<const SogSource::Textures> SogCache::find(std::size_t number) {
  const std::lock_guard lock(mutex_);
  const auto it = std::ranges::find(kept_, number, &Kept::number);
  if (it == kept_.end()) return nullptr;
  kept_.splice(kept_.begin(), kept_, it);
  return it->textures;
}

}  // namespace binosplat
