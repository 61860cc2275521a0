// A model with the levels of detail that it is read with once.

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <set>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "formats/sog_parts.h"
#include "formats/streamed_sog.h"
#include "scene/reduce.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;
using Taken = SogLevels::TakenOfFile;

/// A SOG and what is taken of it.
struct LoadedPart {
  SogSource source;
  Taken taken;
};

/// The finest level that is there, or the one that was asked for.
int choose(const fs::path& path, const SogLevels& levels, std::optional<int> lod) {
  const auto range = [&] { return levels.count() == 1 ? "0" : fmt::format("0 to {}", levels.count() - 1); };
  if (lod && (*lod < 0 || *lod >= levels.count())) {
    fail("--lod {}: {} has the levels {}, 0 being the finest", *lod, path.string(), range());
  }
  std::set<int> there;
  std::optional<fs::path> missing;
  const auto of_levels = levels.missing();
  for (int level = 0; level < levels.count(); ++level) {
    const auto& absent = of_levels[static_cast<std::size_t>(level)];
    if (!absent) there.insert(level);
    if (absent && (!missing || level == lod)) missing = absent;
  }
  if (there.empty()) {
    fail("{}: no level of detail is complete; {} is missing: fetch it", path.string(), missing->string());
  }
  if (lod && there.count(*lod) == 0) {
    fail("--lod {}: {} is missing; the finest level that is there is {}", *lod, missing->string(),
         *there.begin());
  }
  const int level = lod.value_or(*there.begin());
  if (!lod && level > 0) {
    log_warning("{}: level 0 is not complete ({} is missing); level {} is drawn", path.string(),
                missing->string(), level);
  }
  return level;
}

/// What is taken of each file, and what to call it.
struct Selection {
  std::vector<Taken> taken;
  std::string name;
};

/// A level for each leaf, so that they fit.
Selection choose(const fs::path& path, const SogLevels& levels, const nlohmann::json& root,
                 const DetailBudget& budget) {
  const std::vector<DetailPart> leaves = levels.leaves(root);
  check_leaves(path, leaves);
  std::size_t file = 0;
  while (!levels.there(file)) ++file;
  std::size_t most = budget.gaussians(open_part(levels.files()[file]).degree());
  const std::size_t around = levels.environment() ? open_part(*levels.environment()).count() : 0;
  most -= std::min(most, around);
  const std::vector<std::size_t> chosen = choose_levels(leaves, budget.eyes, most);
  std::vector<std::size_t> of_level(static_cast<std::size_t>(levels.count()), 0);
  std::size_t total = 0;
  std::vector<int> numbers(leaves.size(), no_level);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (leaves[i].levels.empty()) continue;
    const DetailPart::Level& level = leaves[i].levels[chosen[i]];
    numbers[i] = level.number;
    of_level[static_cast<std::size_t>(level.number)] += level.count;
    total += level.count;
  }
  if (total > most) warn_of_no_room(path.string(), total, most);
  std::string parts;
  for (std::size_t level = 0; level < of_level.size(); ++level) {
    if (of_level[level] > 0)
      parts += fmt::format("{}{} Gaussians of level {}", parts.empty() ? "" : ", ", of_level[level], level);
  }
  log_info("{}: {}", path.string(), parts);
  return {levels.taken([&](std::size_t leaf) { return numbers[leaf]; }), format_of_chosen(levels)};
}

/// One level for all.
Selection choose_one(const fs::path& path, const SogLevels& levels, std::optional<int> lod) {
  const int level = choose(path, levels, lod);
  log_info("{}: level of detail {} of {}", path.string(), level, levels.count());
  return {levels.taken(level), fmt::format("streamed SOG, level {} of {}", level, levels.count())};
}

std::vector<LoadedPart> open_parts(const fs::path& lod_meta, const SogLevels& levels,
                                   const std::vector<Taken>& taken) {
  std::vector<LoadedPart> parts;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (taken[i].empty()) continue;
    parts.push_back({open_part(levels.files()[i]), taken[i]});
    check_taken(lod_meta, levels.files()[i], parts.back().source, taken[i]);
  }
  if (levels.environment()) {
    SogSource source = open_part(*levels.environment());
    const std::size_t count = source.count();
    parts.push_back({std::move(source), {{0, {0, count, 0}}}});
  }
  return parts;
}

}  // namespace

Model load_streamed_sog(const fs::path& lod_meta, const nlohmann::json& root, std::optional<int> lod,
                        const std::optional<DetailBudget>& budget) {
  const SogLevels levels(lod_meta, root);
  const Selection choice =
      budget ? choose(lod_meta, levels, root, *budget) : choose_one(lod_meta, levels, lod);
  std::vector<LoadedPart> parts = open_parts(lod_meta, levels, choice.taken);
  Model model;
  model.name = lod_meta.filename().string();
  model.format = choice.name;
  std::size_t total = 0;
  std::uint64_t bytes = 0;
  for (LoadedPart& part : parts) {
    bytes += part.source.bytes();
    model.degree = std::max(model.degree, part.source.degree());
    model.antialiased = model.antialiased || part.source.antialiased();
    model.perspective = part.source.perspective();  // of all alike
    for (SogLevels::Taken& taken : part.taken) {
      taken.range.slot = total;
      total += taken.range.count;
    }
  }
  if (total == 0) fail("{} holds no Gaussians ({})", lod_meta.string(), choice.name);
  check_total(lod_meta, total, bytes);
  model.resize(total);
  std::vector<std::uint8_t> kept(total);
  Progress progress("reading " + lod_meta.string(), total);
  std::mutex counting;
  std::size_t done = 0;
  parallel_for(parts.size(), [&](std::size_t i) {
    const std::vector<SogSource::Range> ranges = ranges_of(parts[i].taken);
    parts[i].source.decode(model, ranges, kept);
    const std::lock_guard<std::mutex> lock(counting);
    for (const SogSource::Range& range : ranges) done += range.count;
    progress.update(done);
  });
  keep_only(model, kept);
  return model;
}

}  // namespace binosplat
