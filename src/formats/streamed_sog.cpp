#include "formats/streamed_sog.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "formats/content.h"
#include "formats/json_file.h"
#include "formats/sog_levels.h"
#include "scene/reduce.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;
using Taken = SogLevels::TakenOfFile;

/// A SOG and the ranges read from it.
struct LoadedPart {
  SogSource source;
  Taken taken;
};

/// Returns the requested level, or the finest complete one.
int choose(const fs::path& path, const SogLevels& levels, std::optional<int> lod) {
  const auto range = [&] { return levels.count() == 1 ? "0" : fmt::format("0 to {}", levels.count() - 1); };
  if (lod && (*lod < 0 || *lod >= levels.count())) {
    fail("level of detail {}: {} has the levels {}, 0 being the finest", *lod, path.string(), range());
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
    fail("level of detail {}: {} is missing; the finest complete level is {}", *lod, missing->string(),
         *there.begin());
  }
  const int level = lod.value_or(*there.begin());
  if (!lod && level > 0) {
    log_warning("{}: level 0 is not complete ({} is missing); level {} is drawn", path.string(),
                missing->string(), level);
  }
  return level;
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

bool is_sog_levels(const nlohmann::json& root) { return root.is_object() && root.contains("lodLevels"); }

fs::path lod_meta_of(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? path / "lod-meta.json" : path;
}

std::optional<nlohmann::json> read_lod_meta(const fs::path& lod_meta) {
  std::error_code ignored;
  if (!fs::is_regular_file(lod_meta, ignored)) return std::nullopt;
  const MappedFile file(lod_meta);
  const std::string_view text = as_text(file.bytes());
  if (text.find("\"lodLevels\"") == std::string_view::npos || content_of(file.bytes()) != Content::json)
    return std::nullopt;
  nlohmann::json json = parse_json(lod_meta.string(), text);
  return is_sog_levels(json) ? std::optional(std::move(json)) : std::nullopt;
}

bool is_streamed_sog(const fs::path& path) { return read_lod_meta(lod_meta_of(path)).has_value(); }

Model load_streamed_sog(const fs::path& lod_meta, const nlohmann::json& root, std::optional<int> lod) {
  const SogLevels levels(lod_meta, root);
  const int level = choose(lod_meta, levels, lod);
  log_info("{}: level of detail {} of {}", lod_meta.string(), level, levels.count());
  return load_taken(lod_meta, levels, levels.taken(level),
                    fmt::format("streamed SOG, level {} of {}", level, levels.count()));
}

Model load_taken(const fs::path& lod_meta, const SogLevels& levels, const std::vector<Taken>& taken_of_files,
                 const std::string& format) {
  std::vector<LoadedPart> parts = open_parts(lod_meta, levels, taken_of_files);
  Model model;
  model.name = lod_meta.filename().string();
  model.format = format;
  std::size_t total = 0;
  std::uint64_t bytes = 0;
  for (LoadedPart& part : parts) {
    bytes += part.source.bytes();
    model.degree = std::max(model.degree, part.source.degree());
    model.antialiased = model.antialiased || part.source.antialiased();
    model.perspective = part.source.perspective();  // equal in all
    for (SogLevels::Taken& taken : part.taken) {
      taken.range.slot = total;
      total += taken.range.count;
    }
  }
  if (total == 0) fail("{} holds no Gaussians ({})", lod_meta.string(), format);
  check_total(lod_meta, total, bytes);
  const auto decode = [&] {
    model.resize(total);
    model.left_out = 0;
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
  };
  decode();
  if (choose_origin(model)) decode();
  return model;
}

}  // namespace binosplat
