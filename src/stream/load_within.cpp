#include "stream/load_within.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "base/error.h"
#include "base/log.h"
#include "formats/models/sog_levels.h"
#include "formats/models/streamed_sog.h"
#include "stream/chooser.h"

namespace binosplat {

Model load_within(const std::filesystem::path& path, const DetailBudget& budget) {
  const std::filesystem::path lod_meta = lod_meta_of(path);
  const auto root = read_lod_meta(lod_meta);
  if (!root) fail("{} has no levels of detail; name the lod-meta.json of a streamed SOG", path.string());
  const SogLevels levels(lod_meta, *root);
  const std::vector<LodChunk> chunks = levels.chunks(*root);
  check_chunks(lod_meta, chunks);
  std::size_t file = 0;
  while (!levels.exists(file)) ++file;
  std::size_t most = budget.gaussians(open_sog(OpenedFile(levels.files()[file])).degree());
  const std::size_t around = levels.environment() ? open_sog(OpenedFile(*levels.environment())).count() : 0;
  most -= std::min(most, around);
  const std::vector<std::size_t> chosen = choose_by_spacing(chunks, budget.eyes, most);
  std::vector<std::size_t> of_level(static_cast<std::size_t>(levels.count()), 0);
  std::size_t total = 0;
  std::vector<int> numbers(chunks.size(), no_level);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    if (chunks[i].levels.empty()) continue;
    const LodChunk::Level& level = chunks[i].levels[chosen[i]];
    numbers[i] = level.number;
    of_level[static_cast<std::size_t>(level.number)] += level.count;
    total += level.count;
  }
  if (total > most) warn_over_limit(lod_meta.string(), total, most);
  std::string parts;
  for (std::size_t level = 0; level < of_level.size(); ++level) {
    if (of_level[level] > 0)
      parts += fmt::format("{}{} Gaussians of level {}", parts.empty() ? "" : ", ", of_level[level], level);
  }
  log_info("{}: {}", lod_meta.string(), parts);
  return load_ranges(lod_meta, levels,
                     levels.ranges_in_use([&](std::size_t chunk) { return numbers[chunk]; }),
                     format_of_chosen(levels));
}

}  // namespace binosplat
