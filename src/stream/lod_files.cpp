#include "stream/lod_files.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "formats/models/sog_cache.h"
#include "formats/models/sog_levels.h"
#include "formats/models/sog_source.h"
#include "formats/models/streamed_sog.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t files_at_a_time = 16;  // several threads decode each file; memory holds all 16
// Maximum size of the cache of decoded files, in bytes: 2 GiB hold about 80 million Gaussians. Without it, a
// head that moves through 20 million Gaussians keeps eight cores decoding files for a few chunks each.
std::size_t max_cached() { return static_cast<std::size_t>(std::min(std::exp2(31.0), memory_bytes() / 8.0)); }
// Decoding this many Gaussians of a file takes as long as uploading one Gaussian.
constexpr std::size_t decoded_for_one = 8;

nlohmann::json levels_json(const fs::path& path, const fs::path& asked) {
  if (!fs::exists(asked)) const MappedFile missing(asked);  // throws the usual error
  auto json = read_lod_meta(path);
  if (!json)
    fail("{} has no levels of detail; `binosplat levels` makes a streamed SOG that has them", asked.string());
  return std::move(*json);
}

std::size_t largest_of(const std::vector<LodChunk>& chunks) {
  std::size_t most = 0;
  for (const LodChunk& chunk : chunks)
    if (!chunk.levels.empty()) most = std::max(most, chunk.levels.front().count);
  return most;
}

}  // namespace

/// The contents of lod-meta.json, and the SOGs that exist. Elements of `files` are empty for missing files.
struct LodFiles::Source {
  fs::path path;
  SogLevels levels;
  std::vector<std::optional<SogSource>> files;
  std::optional<SogSource> environment;
  std::uint64_t bytes = 0;       // sum of SogSource::bytes
  SogCache cache{max_cached()};  // its keys are the numbers of files

  Source(const fs::path& lod_meta, const nlohmann::json& json) : path(lod_meta), levels(path, json) {
    files.resize(levels.files().size());
    parallel_for(files.size(), [&](std::size_t i) {
      if (levels.exists(i)) files[i] = open_sog(OpenedFile(levels.files()[i]));
    });
    if (levels.environment()) environment = open_sog(OpenedFile(*levels.environment()));
    for (const auto& file : files) bytes += file ? file->bytes() : 0;
    bytes += environment ? environment->bytes() : 0;
  }
};

struct LodFiles::Reading {
  std::span<const std::size_t> from;
  const LevelChoice& choice;
  const std::function<bool()>& may_continue;

  std::size_t level(std::size_t chunk) const { return choice.levels[chunk]; }
  /// The order of reading depends on the cached files only if reading may be interrupted.
  bool may_be_interrupted() const { return may_continue != nullptr; }
  bool ends() const { return may_continue && !may_continue(); }
};

LodFiles::LodFiles(const fs::path& path) {
  const fs::path lod_meta = lod_meta_of(path);
  const nlohmann::json json = levels_json(lod_meta, path);
  source_ = std::make_unique<Source>(lod_meta, json);
  chunks_ = source_->levels.chunks(json);
  check_chunks(source_->path, chunks_);
  Model middles;
  for (const LodChunk& chunk : chunks_) {
    middles.position.emplace_back(0.5 * (chunk.low + chunk.high));
    middles.scale.emplace_back(chunk.high - chunk.low);
  }
  if (choose_origin(middles)) properties_.axes = middles.axes;
  for (LodChunk& chunk : chunks_) {
    chunk.low -= properties_.axes.origin;
    chunk.high -= properties_.axes.origin;
  }
  for (int level = 0; level < source_->levels.count(); ++level)
    static_cast<void>(source_->levels.ranges_in_use(level));  // throws if chunks share Gaussians
  extra_capacity_ = (chunks_.size() + 1) * ModelChunks::block;
  if (has_errors()) extra_capacity_ += std::min(sampled_chunks * largest_of(chunks_), finest() / 8);
  properties_.name = source_->path.filename().string();
  properties_.format = format_of_chosen(source_->levels);
  const auto add = [&](const std::optional<SogSource>& file) {
    if (!file) return;
    properties_.degree = std::max(properties_.degree, file->degree());
    properties_.set_training(file->training());
  };
  for (const auto& file : source_->files) add(file);
  add(source_->environment);
}

LodFiles::~LodFiles() = default;

std::string LodFiles::name() const { return source_->path.string(); }

bool LodFiles::has_errors() const {
  return std::ranges::any_of(chunks_, [](const LodChunk& chunk) { return !chunk.pixels.empty(); });
}

void LodFiles::check(const DetailRequest& request) const {
  if (!request.db || has_errors()) return;
  fail("{} lacks the errors of its levels, which {} dB need; run `binosplat levels`, or choose levels by px",
       name(), *request.db);
}

Model LodFiles::environment() const {
  if (!source_->environment) return properties_;
  const SogSource& file = *source_->environment;
  const SogLevels::FileRanges all = {{chunks_.size(), {0, file.count(), 0}}};
  check_ranges(source_->path, *source_->levels.environment(), file, all);
  return std::move(file.decode_each(properties_, ranges_of(all), *file.textures()).front());
}

std::size_t LodFiles::environment_count() const {
  return source_->environment ? source_->environment->count() : 0;
}

std::size_t LodFiles::count(std::span<const std::size_t> levels) const {
  std::size_t total = environment_count();
  for (std::size_t c = 0; c < chunks_.size(); ++c)
    total += chunks_[c].levels.empty() ? 0 : chunks_[c].levels[levels[c]].count;
  return total;
}

std::size_t LodFiles::finest() const { return count(std::vector<std::size_t>(chunks_.size(), 0)); }

void LodFiles::read(std::span<const std::size_t> from, const LevelChoice& choice, const OnChunk& on_chunk,
                    const std::function<bool()>& may_continue) const {
  const Reading reading{from, choice, may_continue};
  const RangesByFile shrinking = ranges_to_read(reading, true), growing = ranges_to_read(reading, false);
  check_ranges_of(shrinking);
  check_ranges_of(growing);
  const std::size_t total = count(choice.levels);
  if (total == 0) fail("{} holds no Gaussians ({})", name(), properties_.format);
  check_total(source_->path, total, source_->bytes);
  for (std::size_t c = 0; c < chunks_.size(); ++c) {
    const auto& levels = chunks_[c].levels;
    if (!levels.empty() && from[c] != reading.level(c) && levels[reading.level(c)].count == 0)
      on_chunk({.chunk = c, .level = reading.level(c), .model = properties_});
  }
  read_ranges(reading, shrinking, on_chunk);
  if (!reading.ends()) read_ranges(reading, growing, on_chunk);
}

// A slow file never delays decoding others; without `may_continue` it delays passing on later files' chunks.
void LodFiles::read_ranges(const Reading& reading, const RangesByFile& ranges,
                           const OnChunk& on_chunk) const {
  std::vector<std::size_t> files;
  for (std::size_t i = 0; i < ranges.size(); ++i)
    if (!ranges[i].empty()) files.push_back(i);
  // Files that save more error per Gaussian come first.
  std::vector<double> first(ranges.size());
  for (const std::size_t i : files) first[i] = worth(reading, i, ranges[i]);
  std::ranges::stable_sort(files, std::greater<>(), [&](std::size_t i) { return first[i]; });
  std::vector<std::vector<LoadedChunk>> of_files(files.size());
  const auto begins = [&](std::size_t k) { return k < files.size() && (k == 0 || !reading.ends()); };
  const auto decode = [&](std::size_t k) {
    of_files[k] = read_file(files[k], ranges[files[k]], reading.choice.levels);
  };
  const auto hand_over = [&](std::size_t k) {
    for (LoadedChunk& loaded : std::exchange(of_files[k], {})) on_chunk(std::move(loaded));
  };
  if (files.empty()) return;
  parallel_stages(files_at_a_time, begins, decode, hand_over,
                  reading.may_be_interrupted() ? HandOver::as_done : HandOver::in_order);
}

LodFiles::RangesByFile LodFiles::ranges_to_read(const Reading& reading, bool shrinks) const {
  return source_->levels.ranges_in_use([&](std::size_t c) {
    const auto& levels = chunks_[c].levels;
    if (levels.empty() || reading.from[c] == reading.level(c)) return no_level;
    const std::size_t before = reading.from[c] == not_read ? 0 : levels[reading.from[c]].count;
    const LodChunk::Level& level = levels[reading.level(c)];
    return (level.count < before) == shrinks ? level.number : no_level;
  });
}

double LodFiles::worth(const Reading& reading, std::size_t file, const SogLevels::FileRanges& ranges) const {
  if (!reading.choice.has_errors())
    return chunks_[ranges.front().chunk].levels[reading.level(ranges.front().chunk)].number;
  const bool is_decoded = reading.may_be_interrupted() && source_->cache.has(file);
  std::size_t count = is_decoded ? 0 : source_->files[file]->count() / decoded_for_one;
  double sum = 0.0;
  for (const SogLevels::ChunkRange& used : ranges) {
    const std::size_t c = used.chunk, from = reading.from[c];
    sum += from == not_read ? INFINITY : reading.choice.error_saved(c, from, reading.level(c));
    count += used.range.count;
  }
  return sum / static_cast<double>(std::max<std::size_t>(count, 1));
}

void LodFiles::check_ranges_of(const RangesByFile& ranges) const {
  for (std::size_t i = 0; i < ranges.size(); ++i)
    if (!ranges[i].empty())
      check_ranges(source_->path, source_->levels.files()[i], *source_->files[i], ranges[i]);
}

ChunkModels LodFiles::read_finest(std::span<const std::size_t> chunks) const {
  std::vector<int> numbers(chunks_.size(), no_level);
  for (const std::size_t c : chunks) numbers[c] = chunks_[c].levels.front().number;
  const RangesByFile ranges = source_->levels.ranges_in_use([&](std::size_t c) { return numbers[c]; });
  const std::vector<std::size_t> levels(chunks_.size(), 0);
  std::vector<std::vector<LoadedChunk>> of_files(ranges.size());
  parallel_for(ranges.size(), [&](std::size_t i) {
    if (ranges[i].empty()) return;
    check_ranges(source_->path, source_->levels.files()[i], *source_->files[i], ranges[i]);
    of_files[i] = read_file(i, ranges[i], levels);
  });
  ChunkModels finest;
  for (std::vector<LoadedChunk>& of_file : of_files) {
    for (LoadedChunk& loaded : of_file) {
      finest.chunks.push_back(loaded.chunk);
      finest.models.push_back(std::move(loaded.model));
    }
  }
  return finest;
}

std::vector<LodFiles::LoadedChunk> LodFiles::read_file(std::size_t file, const SogLevels::FileRanges& ranges,
                                                       std::span<const std::size_t> levels) const {
  const SogSource& source = *source_->files[file];
  std::vector<Model> models =
      source.decode_each(properties_, ranges_of(ranges), *source_->cache.textures(file, source));
  std::vector<LoadedChunk> loaded_chunks;
  for (std::size_t i = 0; i < ranges.size(); ++i)
    loaded_chunks.push_back(
        {.chunk = ranges[i].chunk, .level = levels[ranges[i].chunk], .model = std::move(models[i])});
  return loaded_chunks;
}

}  // namespace binosplat
