#include "scene/model_chunks.h"

#include <algorithm>
#include <utility>

#include "base/parallel_in_frame.h"
#include "scene/reduce.h"

namespace binosplat {

namespace {

// Maximum number of blocks that the model grows by at once. The first access to new memory takes time: 5 ms
// for 1,024 blocks, too much for a frame.
constexpr std::size_t blocks_at_once = 128;

void hide(Model& model, std::size_t first, std::size_t count) {
  std::fill_n(model.opacity.begin() + static_cast<std::ptrdiff_t>(first), count, 0.0f);
}

}  // namespace

// Returns the first free block, so that used ones stay together. New blocks also get a position of the model,
// so that no bounding box grows.
std::size_t ModelChunks::allocate_block(Model& model, const glm::vec3& where) {
  if (free_.empty()) {
    const std::size_t before = owners_.size();
    const std::size_t more = std::clamp<std::size_t>(before / 8, 1, blocks_at_once);
    const std::size_t in_capacity = std::max(model.capacity / block, before) - before;
    owners_.resize(before + (in_capacity > 0 ? std::min(more, in_capacity) : more));
    if (in_capacity == 0) {
      model.capacity = (owners_.size() + owners_.size() / 8) * block;
      model.reserve(model.capacity);
    }
    model.resize(owners_.size() * block);
    changes_.resize(owners_.size());
    for (std::size_t b = before; b < owners_.size(); ++b) free_.push(b);
    hide(model, before * block, (owners_.size() - before) * block);
    const auto at = static_cast<std::ptrdiff_t>(before * block);
    std::fill(model.rotation.begin() + at, model.rotation.end(), glm::vec4(1, 0, 0, 0));
    std::fill(model.position.begin() + at, model.position.end(), where);
  }
  const std::size_t first = free_.top();
  free_.pop();
  return first;
}

void ModelChunks::note(std::size_t b, Change change) {
  if (changes_[b] == Change::none) changed_.push_back(b);
  changes_[b] = change;
}

Model ModelChunks::chunk(const Model& model, std::size_t chunk) const {
  Model found = without_gaussians(model);
  found.resize(counts_[chunk]);
  for (std::size_t n = 0; n < blocks_[chunk].size(); ++n) {
    const std::size_t first = n * block;
    copy(model, blocks_[chunk][n] * block, std::min(block, found.count() - first), found, first);
  }
  return found;
}

void ModelChunks::replace(Model& model, std::size_t chunk, const Model& by) {
  const Replacement one{chunk, &by};
  replace(model, {&one, 1});
}

void ModelChunks::replace(Model& model, std::span<const Replacement> all) {
  std::vector<std::vector<std::size_t>> before;  // earlier blocks of the chunks
  for (const Replacement& each : all) before.push_back(free_blocks(each.chunk));
  for (const auto& [chunk, by] : all) fill_blocks(model, chunk, *by);
  const auto fill = [&](std::size_t k) {
    for (const std::size_t b : before[k])
      if (changes_[b] == Change::emptied) hide(model, b * block, block);
    const auto& [chunk, by] = all[k];
    for (std::size_t n = 0; n < blocks_[chunk].size(); ++n) {
      const std::size_t first = n * block, count = std::min(block, by->count() - first);
      const std::size_t at = blocks_[chunk][n] * block;
      copy(*by, first, count, model, at);
      hide(model, at + count, block - count);
      std::fill_n(model.position.begin() + static_cast<std::ptrdiff_t>(at + count), block - count,
                  by->position[first]);
    }
  };
  std::size_t gaussians = 1;
  for (const Replacement& each : all) gaussians += each.by->count();
  const std::size_t numbers = gaussians * (11 + 3 * static_cast<std::size_t>(sh_count(model.degree)));
  const auto fill_some = [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) fill(k);
  };
  parallel_in_frame(all.size(), all.size() * numbers_a_chunk / numbers + 1, fill_some);
}

std::vector<std::size_t> ModelChunks::free_blocks(std::size_t chunk) {
  for (const std::size_t b : blocks_[chunk]) {
    note(b, Change::emptied);
    free_.push(b);
  }
  return std::exchange(blocks_[chunk], {});
}

void ModelChunks::fill_blocks(Model& model, std::size_t chunk, const Model& by) {
  blocks_[chunk].reserve((by.count() + block - 1) / block);
  for (std::size_t first = 0; first < by.count(); first += block) {
    const std::size_t b = allocate_block(model, by.position.front());
    owners_[b] = static_cast<std::uint32_t>(chunk);
    note(b, Change::filled);
    blocks_[chunk].push_back(b);
  }
  gaussians_ = gaussians_ - counts_[chunk] + by.count();
  counts_[chunk] = by.count();
}

ModelChunks::Changes ModelChunks::take_changes() {
  Changes changes;
  std::ranges::sort(changed_);
  for (const std::size_t b : changed_) {
    std::vector<Range>& ranges = changes_[b] == Change::filled ? changes.filled : changes.emptied;
    changes_[b] = Change::none;
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
