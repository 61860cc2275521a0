#include "stream/streamed_model.h"

#include <algorithm>
#include <utility>

#include "base/clock.h"

namespace binosplat {

namespace {

// Limits of a calibration sample's Gaussians at the finest levels: for single pictures, and if heads turn.
constexpr std::size_t max_sample_of_picture = 1 << 17, max_sample_of_stream = 1 << 14;

/// For each chunk that `other` shows more, takes the visibility from `other`.
void merge_visibility(VisibleChunks& visible, const VisibleChunks& other) {
  for (std::size_t v = 0; v < visible.by_view.size(); ++v) {
    for (std::size_t c = 0; c < visible.by_view[v].size(); ++c)
      if (other.by_view[v][c].area > visible.by_view[v][c].area) visible.by_view[v][c] = other.by_view[v][c];
  }
}

}  // namespace

StreamedModel::StreamedModel(const std::filesystem::path& path, StreamSettings settings)
    : settings_(std::move(settings)),
      files_(path),
      model_(files_.properties()),
      chunks_(files_.chunks().size() + 1),
      chooser_(files_) {
  files_.check(settings_.detail);
  const std::size_t most = request_for({}).max_gaussians, finest = files_.finest();
  draws_finest_ = finest <= std::min(settings_.finest_up_to, most);
  if (settings_.reserve > 0) {
    model_.capacity = std::min(finest, most < finest ? most : settings_.reserve) + files_.extra_capacity();
    // Writes to the memory now. The system provides each page at its first write, which is slow while other
    // threads decode (10 ms a frame).
    model_.reserve(model_.capacity);
    model_.resize(std::min(model_.capacity, settings_.reserve));
  }
  start_over();
  read_levels(chooser_.choose({}, {}, {}));
}

std::shared_ptr<render::GpuModel> StreamedModel::gpu_model(gl::Context& context, int precision) {
  if (!gpu_model_) gpu_model_ = std::make_shared<render::GpuModel>(context, model_, precision);
  return gpu_model_;
}

std::optional<double> StreamedModel::levels_db_for(std::optional<float> quality) const {
  if (draws_finest_) return std::nullopt;
  if (settings_.shares_quality && quality && files_.has_errors()) return levels_target_db(*quality);
  return settings_.detail.db;
}

bool StreamedModel::equal_last_views(std::span<const shared::View> views) const {
  return std::ranges::equal(std::as_bytes(views), std::as_bytes(std::span(views_)));
}

DetailRequest StreamedModel::request_for(std::span<const shared::View> views, double lost) const {
  DetailRequest request = settings_.detail;
  request.db = levels_db_for(quality_);
  request.loss_correction = lost * loss_correction_.factor_for_choice();
  if (settings_.max_in_memory) {
    const std::size_t fit = settings_.max_in_memory(views, model_.degree);
    request.max_gaussians = std::min(request.max_gaussians, fit - std::min(fit, files_.extra_capacity()));
  }
  return request;
}

std::optional<float> StreamedModel::frame_quality(std::optional<float> together_db) const {
  const auto levels_db = levels_db_for(together_db);
  if (!together_db || !levels_db) return together_db;
  return static_cast<float>(frame_target_db(*together_db, *levels_db));
}

double StreamedModel::reported(double error, double lost) const {
  return psnr_of_error(std::max(lost * loss_correction_.factor() * error, sample_error_));
}

void StreamedModel::put(std::span<const LodFiles::LoadedChunk> loaded_chunks) {
  std::vector<ModelChunks::Replacement> replacements;
  for (const LodFiles::LoadedChunk& loaded : loaded_chunks) {
    replacements.push_back({loaded.chunk, &loaded.model});
    drawn_[loaded.chunk] = loaded.level;
  }
  chunks_.replace(model_, replacements);
}

// Adds a sample to the calibration. If the sample has all chunks that are not at their finest level, each
// chunk's visibility is the larger of the two pictures', because a chunk may be hidden or out of view in one
// of them. For fewer chunks, the larger visibility would overrate the sample.
VisibleChunks StreamedModel::calibrate(std::span<const shared::View> views,
                                       const render::FrameSettings& settings, LevelChoice& choice) {
  const std::size_t gaussians = settings_.detail.heads_turn ? max_sample_of_stream : max_sample_of_picture;
  const std::size_t most =
      std::max<std::size_t>(gaussians * chunks_.size() / std::max<std::size_t>(files_.finest(), 1), 1);
  sample_error_ = 0.0;
  ChunkModels finest = files_.read_finest(sample_of(choice, drawn_, most, samples_++));
  if (settings_.max_in_memory) drop_beyond_capacity(finest, model_, chunks_);
  if (finest.chunks.empty()) return {};
  visibility_->keep_picture(views.front(), settings);
  VisibleChunks visible = measure(views, settings);
  const ChunkModels before = swap_chunks(finest, model_, chunks_);
  gpu_model_->reload(chunks_.take_changes());
  sample_error_ = visibility_->picture_error(views.front(), settings);
  const auto finest_already = static_cast<std::size_t>(std::ranges::count(drawn_, 0u));
  if (finest.chunks.size() + finest_already == drawn_.size())
    merge_visibility(visible, measure(views, settings));
  swap_chunks(before, model_, chunks_);
  gpu_model_->reload(chunks_.take_changes());
  choice = chooser_.choose(views, request_for(views), visible);
  choice.levels = drawn_;
  loss_correction_.add(sample_error(choice, drawn_, finest.chunks, sample_error_));
  return visible;
}

VisibleChunks StreamedModel::measure(std::span<const shared::View> views,
                                     const render::FrameSettings& settings) {
  if (!visibility_) visibility_.emplace(gpu_model_);
  return {visibility_->measure(views, settings, chunks_), drawn_};
}

void StreamedModel::start_over() {
  model_.resize(0);
  chunks_ = ModelChunks(chunks_.size());
  drawn_.clear();
  for (const LodChunk& chunk : files_.chunks())
    drawn_.push_back(chunk.levels.empty() ? 0 : LodFiles::not_read);  // chunks without levels are never read
  chunks_.replace(model_, files_.chunks().size(), files_.environment());
}

void StreamedModel::read_levels(const LevelChoice& choice) {
  const auto reading = Clock::now();
  const std::vector<std::size_t> from = drawn_;
  files_.read(from, choice, [&](const LodFiles::LoadedChunk& loaded) { put({&loaded, 1}); });
  times_.read_ms += ms_since(reading);
  const ModelChunks::Changes changes = chunks_.take_changes();
  if (!gpu_model_) return;
  const auto uploading = Clock::now();
  if (settings_.detail.heads_turn) {
    gpu_model_->reload(changes);
  } else {
    gpu_model_->reload();
  }
  times_.upload_ms += ms_since(uploading);
}

}  // namespace binosplat
