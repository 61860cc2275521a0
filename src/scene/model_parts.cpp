#include "scene/model_parts.h"

#include <algorithm>

#include "base/parallel.h"
#include "scene/reduce.h"

namespace binosplat {

namespace {

// Which the model grows by, and whose memory is touched then: more would take a frame's time (1,024: 5 ms).
constexpr std::size_t blocks_at_once = 128;

void hide(Model& model, std::size_t first, std::size_t count) {
  std::fill_n(model.opacity.begin() + static_cast<std::ptrdiff_t>(first), count, 0.0f);
}

}  // namespace

// Places that are made for later, too, lie where something is, which makes no box larger.
std::size_t ModelParts::take_block(Model& model, const glm::vec3& where) {
  if (free_.empty()) {
    const std::size_t before = owners_.size();
    const std::size_t more = std::clamp<std::size_t>(before / 8, 1, blocks_at_once);
    const std::size_t in_room = std::max(model.room / block, before) - before;
    owners_.resize(before + (in_room > 0 ? std::min(more, in_room) : more));
    if (in_room == 0) {
      model.room = (owners_.size() + owners_.size() / 8) * block;
      model.reserve(model.room);
    }
    model.resize(owners_.size() * block);
    for (std::size_t b = before; b < owners_.size(); ++b) free_.push(b);
    hide(model, before * block, (owners_.size() - before) * block);
    const auto at = static_cast<std::ptrdiff_t>(before * block);
    std::fill(model.rotation.begin() + at, model.rotation.end(), glm::vec4(1, 0, 0, 0));
    std::fill(model.position.begin() + at, model.position.end(), where);
  }
  const std::size_t found = free_.top();
  free_.pop();
  return found;
}

Model ModelParts::part(const Model& model, std::size_t part) const {
  Model found = without_gaussians(model);
  found.resize(counts_[part]);
  for (std::size_t n = 0; n < blocks_[part].size(); ++n) {
    const std::size_t first = n * block;
    copy(model, blocks_[part][n] * block, std::min(block, found.count() - first), found, first);
  }
  return found;
}

void ModelParts::replace(Model& model, std::size_t part, const Model& by) {
  const Replacement one{part, &by};
  replace(model, {&one, 1});
}

void ModelParts::replace(Model& model, std::span<const Replacement> all) {
  for (const Replacement& each : all) give_back(model, each.part);
  for (const auto& [part, by] : all) take_place(model, part, *by);
  const auto fill = [&](std::size_t k) {
    const auto& [part, by] = all[k];
    for (std::size_t n = 0; n < blocks_[part].size(); ++n) {
      const std::size_t first = n * block, count = std::min(block, by->count() - first);
      const std::size_t at = blocks_[part][n] * block;
      copy(*by, first, count, model, at);
      hide(model, at + count, block - count);
      std::fill_n(model.position.begin() + static_cast<std::ptrdiff_t>(at + count), block - count,
                  by->position[first]);
    }
  };
  std::size_t gaussians = 1;
  for (const Replacement& each : all) gaussians += each.by->count();
  const std::size_t numbers = gaussians * (11 + 3 * static_cast<std::size_t>(sh_count(model.degree)));
  parallel_for(all.size(), fill, all.size() * numbers_a_thread / numbers + 1);
}

void ModelParts::give_back(Model& model, std::size_t part) {
  for (const std::size_t b : blocks_[part]) {
    hide(model, b * block, block);
    changed_[b] = false;
    free_.push(b);
  }
  blocks_[part].clear();
}

void ModelParts::take_place(Model& model, std::size_t part, const Model& by) {
  for (std::size_t first = 0; first < by.count(); first += block) {
    const std::size_t b = take_block(model, by.position.front());
    owners_[b] = static_cast<std::uint32_t>(part);
    changed_[b] = true;
    blocks_[part].push_back(b);
  }
  gaussians_ = gaussians_ - counts_[part] + by.count();
  counts_[part] = by.count();
}

ModelParts::Changes ModelParts::take_changes() {
  Changes changes;
  for (const auto& [b, filled] : changed_) {
    std::vector<Range>& ranges = filled ? changes.filled : changes.emptied;
    if (!ranges.empty() && ranges.back().first + ranges.back().count == b * block) {
      ranges.back().count += block;
    } else {
      ranges.push_back({b * block, block});
    }
  }
  changed_.clear();
  return changes;
}

}  // namespace binosplat
