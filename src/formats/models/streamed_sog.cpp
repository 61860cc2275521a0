#include "formats/models/streamed_sog.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/path_questions.h"
#include "base/progress.h"
#include "formats/containers/opened_file.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;
using FileRanges = SogLevels::FileRanges;

/// A SOG and the ranges read from it.
struct OpenSog {
  SogSource source;
  FileRanges ranges;
};

/// Returns the requested level, or the finest complete one that has Gaussians.
int choose(const fs::path& path, const SogLevels& levels, std::optional<int> lod) {
  const auto range = [&] { return levels.count() == 1 ? "0" : fmt::format("0 to {}", levels.count() - 1); };
  if (lod && (*lod < 0 || *lod >= levels.count()))
    fail("level of detail {}: {} has the levels {}, 0 being the finest", *lod, path, range());
  std::set<int> there;
  std::optional<fs::path> missing;
  const auto of_levels = levels.missing();
  for (int level = 0; level < levels.count(); ++level) {
    const auto& absent = of_levels[static_cast<std::size_t>(level)];
    const auto ranges = levels.ranges_in_use(level);
    if (!absent && !std::ranges::all_of(ranges, &SogLevels::FileRanges::empty)) there.insert(level);
    if (absent && !missing) missing = absent;
  }
  if (there.empty() && missing)
    fail("{}: no level of detail is complete; {} is missing: fetch it", path, *missing);
  if (lod && !there.empty() && !there.contains(*lod)) {
    const auto& absent = of_levels[static_cast<std::size_t>(*lod)];
    fail("level of detail {}: {}; the finest complete level is {}", *lod,
         absent ? absent->string() + " is missing" : path.string() + " has no Gaussians there",
         *there.begin());
  }
  const int level = lod.value_or(there.empty() ? 0 : *there.begin());
  if (!lod && level > 0 && missing)
    log_warning("{}: level 0 is not complete ({} is missing); level {} is drawn", path, *missing, level);
  return level;
}

std::vector<OpenSog> open_sogs(const fs::path& lod_meta, const SogLevels& levels,
                               const std::vector<FileRanges>& ranges) {
  std::vector<OpenSog> sogs;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (ranges[i].empty()) continue;
    sogs.push_back({open_sog(OpenedFile(levels.files()[i])), ranges[i]});
    check_ranges(lod_meta, levels.files()[i], sogs.back().source, ranges[i]);
  }
  if (levels.environment()) {
    SogSource source = open_sog(OpenedFile(*levels.environment()));
    const std::size_t count = source.count();
    sogs.push_back({std::move(source), {{0, {0, count, 0}}}});
  }
  return sogs;
}

}  // namespace

bool is_sog_levels(const nlohmann::json& root) { return root.is_object() && root.contains("lodLevels"); }

fs::path lod_meta_of(const fs::path& path) { return is_folder(path) ? path / "lod-meta.json" : path; }

std::optional<nlohmann::json> read_lod_meta(const fs::path& lod_meta) {
  if (!is_file(lod_meta)) return std::nullopt;
  const OpenedFile file(lod_meta);
  if (file.content != Content::json || as_text(file.bytes()).find("\"lodLevels\"") == std::string_view::npos)
    return std::nullopt;
  nlohmann::json json = parse_json(lod_meta.string(), as_text(file.bytes()));
  return is_sog_levels(json) ? std::optional(std::move(json)) : std::nullopt;
}

bool is_streamed_sog(const fs::path& path) { return read_lod_meta(lod_meta_of(path)).has_value(); }

Model load_streamed_sog(const fs::path& lod_meta, const nlohmann::json& root, std::optional<int> lod) {
  const SogLevels levels(lod_meta, root);
  const int level = choose(lod_meta, levels, lod);
  log_info("{}: level of detail {} of {} (0 is the finest)", lod_meta, level, levels.count());
  return load_ranges(lod_meta, levels, levels.ranges_in_use(level),
                     fmt::format("streamed SOG, level {} of {}", level, levels.count()));
}

Model load_ranges(const fs::path& lod_meta, const SogLevels& levels,
                  const std::vector<FileRanges>& ranges_of_files, const std::string& format) {
  std::vector<OpenSog> sogs = open_sogs(lod_meta, levels, ranges_of_files);
  Model model;
  model.name = lod_meta.filename().string();
  model.format = format;
  std::size_t total = 0;
  std::uint64_t bytes = 0;
  for (OpenSog& sog : sogs) {
    bytes += sog.source.bytes();
    model.degree = std::max(model.degree, sog.source.degree());
    model.set_training(sog.source.training());  // equal in all SOGs
    for (SogLevels::ChunkRange& used : sog.ranges) {
      used.range.slot = total;
      total += used.range.count;
    }
  }
  if (total == 0) fail("{} holds no Gaussians ({})", lod_meta, format);
  check_total(lod_meta, total, bytes);
  const auto decode = [&] {
    model.resize(total);
    model.left_out = 0;
    std::vector<std::uint8_t> kept(total);
    Progress progress("reading " + lod_meta.string(), total);
    parallel_for(sogs.size(), [&](std::size_t i) {
      const std::vector<SogSource::Range> ranges = ranges_of(sogs[i].ranges);
      sogs[i].source.decode(model, ranges, kept);
      for (const SogSource::Range& range : ranges) progress.add(range.count);
    });
    keep_only(model, kept);
  };
  decode();
  if (choose_origin(model)) decode();
  return model;
}

}  // namespace binosplat
