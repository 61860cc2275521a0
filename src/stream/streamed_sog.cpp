#include "stream/streamed_sog.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "formats/sog_cache.h"
#include "formats/sog_levels.h"
#include "formats/sog_parts.h"
#include "formats/sog_source.h"
#include "formats/streamed_sog.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t files_at_a_time = 16;  // each by several threads, and whole in memory meanwhile
// Bytes of decoded files that are kept: of some 80 million Gaussians, without which a head that moves through
// 20 million has files of 131,072 decoded again and again for a few leaves each, eight cores long.
std::size_t cached_most() {
  return static_cast<std::size_t>(std::min(std::exp2(31.0), memory_bytes() / 8.0));
}
// Decoding so many of a file takes as long as one takes to reach the GPU.
constexpr std::size_t decoded_for_one = 8;

nlohmann::json levels_json(const fs::path& path, const fs::path& asked) {
  auto json = read_lod_meta(path);
  if (!json)
    fail("--detail: {} has no levels of detail to choose from; a streamed SOG's lod-meta.json has",
         asked.string());
  return std::move(*json);
}

/// Gaussians of that which has most.
std::size_t largest_part(const std::vector<DetailPart>& leaves) {
  std::size_t most = 0;
  for (const DetailPart& leaf : leaves)
    if (!leaf.levels.empty()) most = std::max(most, leaf.levels.front().count);
  return most;
}

}  // namespace

/// What lod-meta.json says, and the SOGs that are there; none of another file.
struct StreamedSog::Source {
  fs::path path;
  SogLevels levels;
  std::vector<std::optional<SogSource>> files;  // the environment last, where there is one
  std::uint64_t bytes = 0;                      // of them (SogSource::bytes)
  SogCache cache{cached_most()};                // by the number of the file

  Source(const fs::path& lod_meta, const nlohmann::json& json) : path(lod_meta), levels(path, json) {
    files.resize(levels.files().size());
    parallel_for(files.size(), [&](std::size_t i) {
      if (levels.there(i)) files[i] = open_part(levels.files()[i]);
    });
    if (levels.environment()) files.emplace_back(open_part(*levels.environment()));
    for (const auto& file : files) bytes += file ? file->bytes() : 0;
  }

  /// Gaussians of the environment.
  std::size_t around() const { return levels.environment() ? files.back()->count() : 0; }

  const fs::path& name(std::size_t file) const {
    return file == levels.files().size() ? *levels.environment() : levels.files()[file];
  }
};

StreamedSog::StreamedSog(const fs::path& path) {
  const fs::path lod_meta = lod_meta_of(path);
  const nlohmann::json json = levels_json(lod_meta, path);
  source_ = std::make_unique<Source>(lod_meta, json);
  leaves_ = source_->levels.leaves(json);
  check_leaves(source_->path, leaves_);
  chooser_.emplace(source_->path.string(), leaves_, source_->around());
  for (int level = 0; level < source_->levels.count(); ++level)
    static_cast<void>(source_->levels.taken(level));  // throws where leaves share Gaussians
  read_.resize(leaves_.size());
  spare_ = parts() * ModelParts::block;
  if (has_errors()) spare_ += std::min(sample_of_rest * largest_part(leaves_), finest() / 8);
  like_.name = source_->path.filename().string();
  like_.format = format_of_chosen(source_->levels);
  for (const auto& file : source_->files) {
    if (!file) continue;
    like_.degree = std::max(like_.degree, file->degree());
    like_.antialiased = like_.antialiased || file->antialiased();
    like_.perspective = file->perspective();
  }
}

StreamedSog::~StreamedSog() = default;

bool StreamedSog::choose(std::shared_ptr<const LevelsChosen> chosen) {
  chosen_ = std::move(chosen);
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf)
    if (!leaves_[leaf].levels.empty() && read_[leaf] != level(leaf)) return true;
  return source_->around() > 0 && !environment_read_;
}

// Leaves that get fewer Gaussians come first: never are there more than before or after, if all are taken.
void StreamedSog::read(const Take& take, const std::function<bool()>& goes_on) {
  const std::array<std::vector<SogLevels::TakenOfFile>, 2> all = {to_read(true), to_read(false)};
  check_room(all);
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf) {
    const auto& levels = leaves_[leaf].levels;
    if (levels.empty() || read_[leaf] == level(leaf) || levels[level(leaf)].count > 0) continue;
    const auto before = std::exchange(read_[leaf], level(leaf));
    take({.part = leaf, .level = level(leaf), .before = before, .model = like_});
  }
  for (const std::vector<SogLevels::TakenOfFile>& taken : all) {
    std::vector<std::size_t> files;
    for (std::size_t i = 0; i < taken.size(); ++i)
      if (!taken[i].empty()) files.push_back(i);
    // Few Gaussians that mend much come before many that mend little.
    std::vector<double> first(taken.size());
    for (const std::size_t i : files) first[i] = worth(i, taken[i], goes_on != nullptr);
    std::ranges::stable_sort(files, std::greater<>(), [&](std::size_t i) { return first[i]; });
    if (files.empty()) continue;
    read_files(files, taken, take, goes_on);
    if (goes_on && !goes_on()) return;
  }
}

// One that takes long holds up no other: of those that are in no hurry only what follows it.
void StreamedSog::read_files(std::span<const std::size_t> files,
                             std::span<const SogLevels::TakenOfFile> taken, const Take& take,
                             const std::function<bool()>& goes_on) {
  std::vector<std::vector<Piece>> of_files(files.size());
  const auto begins = [&](std::size_t k) { return k < files.size() && (k == 0 || !goes_on || goes_on()); };
  const auto decode = [&](std::size_t k) { of_files[k] = read_file(files[k], taken[files[k]]); };
  const auto hand_over = [&](std::size_t k) {
    for (Piece& piece : std::exchange(of_files[k], {})) {
      if (piece.level) read_[piece.part] = piece.level;
      environment_read_ = environment_read_ || !piece.level;
      take(std::move(piece));
    }
  };
  parallel_stages(files_at_a_time, begins, decode, hand_over,
                  goes_on ? HandOver::as_done : HandOver::in_order);
}

std::vector<SogLevels::TakenOfFile> StreamedSog::to_read(bool shrinks) const {
  const auto level_of = [&](std::size_t leaf) {
    const auto& levels = leaves_[leaf].levels;
    if (levels.empty() || read_[leaf] == level(leaf)) return no_level;
    const std::size_t before = read_[leaf] ? levels[*read_[leaf]].count : 0;
    return (levels[level(leaf)].count < before) == shrinks ? levels[level(leaf)].number : no_level;
  };
  std::vector<SogLevels::TakenOfFile> taken = source_->levels.taken(level_of);
  if (source_->around() > 0 && !environment_read_ && !shrinks)
    taken.emplace_back().push_back({leaves_.size(), {0, source_->around(), 0}});
  return taken;
}

std::size_t StreamedSog::finest() const {
  return chooser_->count(std::vector<std::size_t>(leaves_.size(), 0));
}

double StreamedSog::saved(std::size_t leaf, std::optional<std::size_t> before) const {
  return before ? choice()->saved(leaf, *before, level(leaf)) : INFINITY;
}

double StreamedSog::worth(const Piece& piece) const {
  if (!choice() || piece.part >= leaves_.size() || !piece.before || *piece.before < *piece.level)
    return INFINITY;
  return saved(piece.part, piece.before) / static_cast<double>(std::max<std::size_t>(piece.model.count(), 1));
}

double StreamedSog::worth(std::size_t file, const SogLevels::TakenOfFile& taken, bool by_cache) const {
  if (taken.front().leaf >= leaves_.size()) return INFINITY;
  if (!choice()) return leaves_[taken.front().leaf].levels[level(taken.front().leaf)].number;
  double sum = 0.0;
  // In no hurry the order is the same whatever was read before.
  std::size_t count =
      by_cache && source_->cache.has(file) ? 0 : source_->files[file]->count() / decoded_for_one;
  for (const SogLevels::Taken& of_leaf : taken) {
    sum += saved(of_leaf.leaf, read_[of_leaf.leaf]);
    count += of_leaf.range.count;
  }
  return sum / static_cast<double>(std::max<std::size_t>(count, 1));
}

void StreamedSog::check_room(std::span<const std::vector<SogLevels::TakenOfFile>> all) const {
  for (const std::vector<SogLevels::TakenOfFile>& taken : all) {
    for (std::size_t i = 0; i < taken.size(); ++i)
      if (!taken[i].empty()) check_taken(source_->path, source_->name(i), *source_->files[i], taken[i]);
  }
  const std::size_t total = chooser_->count(chosen());
  if (total == 0) fail("{} holds no Gaussians ({})", source_->path.string(), like_.format);
  check_total(source_->path, total, source_->bytes);
}

PartModels StreamedSog::finest_of(std::span<const std::size_t> leaves) const {
  std::vector<int> numbers(leaves_.size(), no_level);
  for (const std::size_t leaf : leaves) numbers[leaf] = leaves_[leaf].levels.front().number;
  const auto taken = source_->levels.taken([&](std::size_t leaf) { return numbers[leaf]; });
  std::vector<std::vector<Piece>> of_files(taken.size());
  parallel_for(taken.size(), [&](std::size_t i) {
    if (taken[i].empty()) return;
    check_taken(source_->path, source_->name(i), *source_->files[i], taken[i]);
    of_files[i] = read_file(i, taken[i]);
  });
  PartModels finest;
  for (std::vector<Piece>& of_file : of_files) {
    for (Piece& piece : of_file) {
      finest.parts.push_back(piece.part);
      finest.models.push_back(std::move(piece.model));
    }
  }
  return finest;
}

std::vector<StreamedSog::Piece> StreamedSog::read_file(std::size_t file,
                                                       const SogLevels::TakenOfFile& taken) const {
  const SogSource& source = *source_->files[file];
  std::vector<Model> models =
      source.decode_each(like_, ranges_of(taken), *source_->cache.textures(file, source));
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const std::size_t leaf = taken[i].leaf;
    pieces.push_back({.part = leaf, .model = std::move(models[i])});
    if (leaf == leaves_.size()) continue;
    pieces.back().level = level(leaf);
    pieces.back().before = read_[leaf];
  }
  return pieces;
}

}  // namespace binosplat
