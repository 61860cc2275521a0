// The lod-meta.json of a streamed SOG: its tree, its ranges of Gaussians in files, and the choice of levels.

#include <algorithm>

#include "formats/containers/content.h"
#include "formats/models/sog_levels.h"
#include "fuzz/input.h"
#include "stream/level_choice.h"

namespace binosplat::fuzz {

namespace {

void check(const SogLevels& levels, const nlohmann::json& json) {
  std::vector<LodChunk> chunks = levels.chunks(json);
  for (int level = 0; level < std::min(levels.count(), 3); ++level) {
    const auto taken = levels.ranges_in_use(level);
    demand(taken.size() == levels.files().size(), "a file without a list");
    for (const auto& of_file : taken) {
      for (std::size_t k = 0; k < of_file.size(); ++k) {
        demand(of_file[k].chunk < chunks.size(), "a chunk that there is not");
        const SogSource::Range& range = of_file[k].range;
        demand(range.count > 0, "nothing taken");
        demand(k == 0 || of_file[k - 1].range.first + of_file[k - 1].range.count <= range.first,
               "taken twice");
      }
    }
  }
  // The files do not exist, so each chunk gets made-up levels.
  for (LodChunk& chunk : chunks) {
    const auto losing = [&](double error) { return std::vector<double>(chunk.seen.size(), error); };
    chunk.levels = {{0, 1000, losing(0.0)}, {1, 100, losing(1.0)}, {2, 10, losing(9.0)}};
  }
  const std::size_t most = 500 * chunks.size();
  const auto follow = [&](const auto& choose) {
    std::vector<std::size_t> before;
    for (const double x : {0.0, 10.0, 1e9}) {
      const std::vector<std::size_t> chosen = choose(x, before);
      std::size_t total = 0;
      demand(chosen.size() == chunks.size(), "a chunk without a choice");
      for (std::size_t i = 0; i < chunks.size(); ++i) total += chunks[i].levels.at(chosen[i]).count;
      demand(total <= most, "more than there is room for");
      before = chosen;
    }
  };
  follow([&](double x, const auto& before) {
    return choose_by_spacing(chunks, {{x, 0, 0}}, most, 0.01, before);
  });
  follow([&](double x, const auto& before) {
    VisibleChunks visible;
    if (!before.empty()) visible = {{std::vector<ChunkVisibility>(chunks.size(), {x, x + 1.0})}, before};
    const ErrorBudget budget{.error = 1e-4, .max_gaussians = most, .max_read = 700};
    return choose_by_error(chunks, {{.eye = {x, 0, 0}}}, budget, visible, before).levels;
  });
}

}  // namespace

void target(std::span<const std::byte> bytes) {
  feed(bytes, [&](const std::filesystem::path& path) {
    const nlohmann::json json = parse_json(path.string(), as_text(bytes));
    check(SogLevels(path, json), json);
  });
}

}  // namespace binosplat::fuzz
