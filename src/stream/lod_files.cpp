#include "stream/lod_files.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "formats/sog_cache.h"
#include "formats/sog_levels.h"
#include "formats/sog_source.h"
#include "formats/streamed_sog.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t files_at_a_time = 16;  // each decoded by several threads and held in memory
// Bytes of decoded files in the cache, about 80 million Gaussians. Without it, a head that moves through 20
// million decodes files of 131,072 repeatedly for a few chunks each, on eight cores.
std::size_t cached_most() {
  return static_cast<std::size_t>(std::min(std::exp2(31.0), memory_bytes() / 8.0));
}
// Decoding this many Gaussians of a file takes as long as moving one to the GPU.
constexpr std::size_t decoded_for_one = 8;

nlohmann::json levels_json(const fs::path& path, const fs::path& asked) {
  auto json = read_lod_meta(path);
  if (!json)
    fail("{} has no levels of detail; `binosplat levels` makes a streamed SOG that has them", asked.string());
  return std::move(*json);
}

/// Returns the Gaussians of the largest chunk.
std::size_t largest_of(const std::vector<LodChunk>& chunks) {
  std::size_t most = 0;
  for (const LodChunk& chunk : chunks)
    if (!chunk.levels.empty()) most = std::max(most, chunk.levels.front().count);
  return most;
}

}  // namespace

/// The contents of lod-meta.json, and the SOGs that exist; empty for missing files.
struct LodFiles::Source {
  fs::path path;
  SogLevels levels;
  std::vector<std::optional<SogSource>> files;
  std::optional<SogSource> environment;
  std::uint64_t bytes = 0;        // sum of SogSource::bytes
  SogCache cache{cached_most()};  // by file number

  Source(const fs::path& lod_meta, const nlohmann::json& json) : path(lod_meta), levels(path, json) {
    files.resize(levels.files().size());
    parallel_for(files.size(), [&](std::size_t i) {
      if (levels.there(i)) files[i] = open_part(levels.files()[i]);
    });
    if (levels.environment()) environment = open_part(*levels.environment());
    for (const auto& file : files) bytes += file ? file->bytes() : 0;
    bytes += environment ? environment->bytes() : 0;
  }
};

struct LodFiles::Reading {
  std::span<const std::size_t> from;
  const LevelChoice& choice;
  const std::function<bool()>& goes_on;

  std::size_t level(std::size_t chunk) const { return choice.levels[chunk]; }
  /// With `goes_on` the order depends on the cached files; without, it is always the same.
  bool is_in_a_hurry() const { return goes_on != nullptr; }
  bool ends() const { return goes_on && !goes_on(); }
};

LodFiles::LodFiles(const fs::path& path) {
  const fs::path lod_meta = lod_meta_of(path);
  const nlohmann::json json = levels_json(lod_meta, path);
  source_ = std::make_unique<Source>(lod_meta, json);
  chunks_ = source_->levels.leaves(json);
  check_leaves(source_->path, chunks_);
  Model middles;
  for (const LodChunk& chunk : chunks_) {
    middles.position.emplace_back(0.5 * (chunk.low + chunk.high));
    middles.scale.emplace_back(chunk.high - chunk.low);
  }
  if (choose_origin(middles)) like_.axes = middles.axes;
  for (LodChunk& chunk : chunks_) {
    chunk.low -= like_.axes.origin;
    chunk.high -= like_.axes.origin;
  }
  for (int level = 0; level < source_->levels.count(); ++level)
    static_cast<void>(source_->levels.taken(level));  // throws if leaves share Gaussians
  spare_ = (chunks_.size() + 1) * ModelChunks::block;
  if (has_errors()) spare_ += std::min(sample_room * largest_of(chunks_), finest() / 8);
  like_.name = source_->path.filename().string();
  like_.format = format_of_chosen(source_->levels);
  const auto add = [&](const std::optional<SogSource>& file) {
    if (!file) return;
    like_.degree = std::max(like_.degree, file->degree());
    like_.antialiased = like_.antialiased || file->antialiased();
    like_.perspective = file->perspective();
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
  fail("--detail {}dB: {} lacks the errors of its levels; `binosplat levels` writes them; or use --detail PX",
       *request.db, name());
}

Model LodFiles::environment() const {
  if (!source_->environment) return like_;
  const SogSource& file = *source_->environment;
  const SogLevels::TakenOfFile all = {{chunks_.size(), {0, file.count(), 0}}};
  check_taken(source_->path, *source_->levels.environment(), file, all);
  return std::move(file.decode_each(like_, ranges_of(all), *file.textures()).front());
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

void LodFiles::read(std::span<const std::size_t> from, const LevelChoice& choice, const Take& take,
                    const std::function<bool()>& goes_on) const {
  const Reading reading{from, choice, goes_on};
  const TakenOfAll shrinking = taken_of(reading, true), growing = taken_of(reading, false);
  check_taken_of(shrinking);
  check_taken_of(growing);
  const std::size_t total = count(choice.levels);
  if (total == 0) fail("{} holds no Gaussians ({})", name(), like_.format);
  check_total(source_->path, total, source_->bytes);
  for (std::size_t c = 0; c < chunks_.size(); ++c) {
    const auto& levels = chunks_[c].levels;
    if (!levels.empty() && from[c] != reading.level(c) && levels[reading.level(c)].count == 0)
      take({.chunk = c, .level = reading.level(c), .model = like_});
  }
  read_some(reading, shrinking, take);
  if (!reading.ends()) read_some(reading, growing, take);
}

// A slow file does not delay decoding of others. Without `goes_on` it only delays passing on the files after
// it.
void LodFiles::read_some(const Reading& reading, const TakenOfAll& taken, const Take& take) const {
  std::vector<std::size_t> files;
  for (std::size_t i = 0; i < taken.size(); ++i)
    if (!taken[i].empty()) files.push_back(i);
  // Few Gaussians that save much error come before many that save little.
  std::vector<double> first(taken.size());
  for (const std::size_t i : files) first[i] = worth(reading, i, taken[i]);
  std::ranges::stable_sort(files, std::greater<>(), [&](std::size_t i) { return first[i]; });
  std::vector<std::vector<Piece>> of_files(files.size());
  const auto begins = [&](std::size_t k) { return k < files.size() && (k == 0 || !reading.ends()); };
  const auto decode = [&](std::size_t k) {
    of_files[k] = read_file(files[k], taken[files[k]], reading.choice.levels);
  };
  const auto hand_over = [&](std::size_t k) {
    for (Piece& piece : std::exchange(of_files[k], {})) take(std::move(piece));
  };
  if (files.empty()) return;
  parallel_stages(files_at_a_time, begins, decode, hand_over,
                  reading.is_in_a_hurry() ? HandOver::as_done : HandOver::in_order);
}

LodFiles::TakenOfAll LodFiles::taken_of(const Reading& reading, bool shrinks) const {
  return source_->levels.taken([&](std::size_t c) {
    const auto& levels = chunks_[c].levels;
    if (levels.empty() || reading.from[c] == reading.level(c)) return no_level;
    const std::size_t before = reading.from[c] == not_read ? 0 : levels[reading.from[c]].count;
    const LodChunk::Level& level = levels[reading.level(c)];
    return (level.count < before) == shrinks ? level.number : no_level;
  });
}

double LodFiles::worth(const Reading& reading, std::size_t file, const SogLevels::TakenOfFile& taken) const {
  if (!reading.choice.knows_errors())
    return chunks_[taken.front().leaf].levels[reading.level(taken.front().leaf)].number;
  const bool is_decoded = reading.is_in_a_hurry() && source_->cache.has(file);
  std::size_t count = is_decoded ? 0 : source_->files[file]->count() / decoded_for_one;
  double sum = 0.0;
  for (const SogLevels::Taken& of_chunk : taken) {
    const std::size_t c = of_chunk.leaf, from = reading.from[c];
    sum += from == not_read ? INFINITY : reading.choice.saved(c, from, reading.level(c));
    count += of_chunk.range.count;
  }
  return sum / static_cast<double>(std::max<std::size_t>(count, 1));
}

void LodFiles::check_taken_of(const TakenOfAll& taken) const {
  for (std::size_t i = 0; i < taken.size(); ++i)
    if (!taken[i].empty())
      check_taken(source_->path, source_->levels.files()[i], *source_->files[i], taken[i]);
}

ChunkModels LodFiles::finest_of(std::span<const std::size_t> chunks) const {
  std::vector<int> numbers(chunks_.size(), no_level);
  for (const std::size_t c : chunks) numbers[c] = chunks_[c].levels.front().number;
  const TakenOfAll taken = source_->levels.taken([&](std::size_t c) { return numbers[c]; });
  const std::vector<std::size_t> levels(chunks_.size(), 0);
  std::vector<std::vector<Piece>> of_files(taken.size());
  parallel_for(taken.size(), [&](std::size_t i) {
    if (taken[i].empty()) return;
    check_taken(source_->path, source_->levels.files()[i], *source_->files[i], taken[i]);
    of_files[i] = read_file(i, taken[i], levels);
  });
  ChunkModels finest;
  for (std::vector<Piece>& of_file : of_files) {
    for (Piece& piece : of_file) {
      finest.chunks.push_back(piece.chunk);
      finest.models.push_back(std::move(piece.model));
    }
  }
  return finest;
}

std::vector<LodFiles::Piece> LodFiles::read_file(std::size_t file, const SogLevels::TakenOfFile& taken,
                                                 std::span<const std::size_t> levels) const {
  const SogSource& source = *source_->files[file];
  std::vector<Model> models =
      source.decode_each(like_, ranges_of(taken), *source_->cache.textures(file, source));
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < taken.size(); ++i)
    pieces.push_back({.chunk = taken[i].leaf, .level = levels[taken[i].leaf], .model = std::move(models[i])});
  return pieces;
}

}  // namespace binosplat
