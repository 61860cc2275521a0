#include "formats/sog_parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/mapped_file.h"
#include "formats/content.h"
#include "formats/json_file.h"
#include "formats/sog.h"

namespace binosplat {

SogSource open_part(const std::filesystem::path& path) {
  const MappedFile file(path);
  if (content_of(file.bytes()) == Content::zip) return sog_in_archive(path);
  return sog_in_folder(path, parse_json(path.string(), as_text(file.bytes())));
}

std::vector<SogSource::Range> ranges_of(const SogLevels::TakenOfFile& taken) {
  std::vector<SogSource::Range> ranges;
  for (const SogLevels::Taken& of_leaf : taken) ranges.push_back(of_leaf.range);
  return ranges;
}

void check_leaves(const std::filesystem::path& path, const std::vector<LodChunk>& leaves) {
  if (std::all_of(leaves.begin(), leaves.end(), [](const auto& leaf) { return leaf.levels.empty(); }))
    fail("{}: none of its levels of detail is there: fetch one", path.string());
}

std::string format_of_chosen(const SogLevels& levels) {
  return fmt::format("streamed SOG, levels chosen of {}", levels.count());
}

}  // namespace binosplat
