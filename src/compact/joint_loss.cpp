#include "compact/joint_loss.h"

#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/random.h"
#include "render/frame.h"
#include "render/squared_error.h"
#include "scene/camera.h"
#include "scene/model_chunks.h"
#include "scene/reduce.h"
#include "stream/level_choice.h"
#include "stream/visibility.h"

namespace binosplat::compact {

namespace {

constexpr double requested_db = 40.0;
constexpr int passes = 3;  // rounds of measuring visibility and choosing levels; later ones change little
// Pictures have a headset's field of view in few pixels, so that each shows many chunks.
constexpr int side = 512;     // px
constexpr double fov = 95.0;  // degrees
// Candidate eyes are checked in small pictures of the coarsest levels.
constexpr int candidate_side = 128, candidates_for_one = 24, candidates_at_once = 8;
constexpr double min_visible_area = 0.35;  // smallest visible area of all chunks, as a share of the picture
constexpr double min_relative_distance = 0.4;  // smallest mean of visible chunks, relative to the target
constexpr double hidden = 0.01;                // px; a chunk with a smaller visible area counts as hidden

/// Returns the chunk as lod-meta.json will describe it.
LodChunk lod_chunk(std::span<const Model> levels, const LevelErrors& errors) {
  LodChunk chunk;
  const Box box = bounds_of(levels.front());
  chunk.low = box.low;
  chunk.high = box.high;
  const auto flat = [](const std::vector<std::vector<double>>& by_direction) {
    std::vector<double> list;
    for (const auto& of : by_direction) list.insert(list.end(), of.begin(), of.end());
    return list;
  };
  for (std::size_t level = 0; level < levels.size(); ++level) {
    chunk.levels.push_back({static_cast<int>(level), levels[level].count(), flat(errors.of_level[level])});
  }
  chunk.pixels = errors.pixels;
  chunk.seen = flat(errors.seen);
  return chunk;
}

shared::View from(const glm::dvec3& eye, const glm::dvec3& at, int px, const Training& training) {
  const glm::dvec3 ahead = glm::normalize(at - eye);
  const glm::dvec3 up = std::abs(ahead.y) < 0.9 ? glm::dvec3(0, -1, 0) : glm::dvec3(1, 0, 0);
  return make_view(look_at(eye, at, up, fov, px, px), training.near_plane.value_or(near_default));
}

/// Calls `draw`. Returns false if memory was short, so that other pictures can still be drawn.
bool can_draw(const std::function<void()>& draw) {
  try {
    draw();
  } catch (const Error& error) {
    if (error.code() != ExitCode::out_of_memory) throw;
    return false;
  }
  return true;
}

/// All chunks in one model, each at any of its levels.
class JointModel {
 public:
  JointModel(gl::Context& context, std::span<const std::vector<Model>> levels_of_chunks,
             std::span<const LevelErrors> errors)
      : levels_of_chunks_(levels_of_chunks),
        layout_(levels_of_chunks.size()),
        model_(without_gaussians(levels_of_chunks[0][0])) {
    for (std::size_t i = 0; i < levels_of_chunks.size(); ++i)
      chunks_.push_back(lod_chunk(levels_of_chunks[i], errors[i]));
    set_levels(coarsest());
    gpu_model_ = std::make_shared<render::GpuModel>(context, model_);
    frame_.emplace(gpu_model_);
    visibility_.emplace(gpu_model_);
  }

  std::vector<std::size_t> coarsest() const {
    return std::vector<std::size_t>(levels_of_chunks_.size(), levels_of_chunks_[0].size() - 1);
  }

  void set_levels(const std::vector<std::size_t>& levels) {
    put(levels);
    const ModelChunks::Changes changes = layout_.take_changes();
    if (gpu_model_) gpu_model_->reload(changes);
  }

  /// Resets the model after memory was short, because the GPU's contents are then unknown.
  void reset() {
    put(coarsest());
    layout_.take_changes();
    gpu_model_->reload();
  }

  /// Finds views whose eyes lie among the chunks. All chunks must have their coarsest levels. Sets `all_fit`
  /// to whether memory sufficed.
  std::vector<shared::View> find_views(int pictures, bool& all_fit) {
    std::vector<shared::View> views;
    all_fit = true;
    Random random(1);
    const auto any = [&] {
      const Model& level = levels_of_chunks_[random.bits() % levels_of_chunks_.size()].back();
      return glm::dvec3(level.position[random.bits() % level.count()]);
    };
    for (int k = 0; k < candidates_for_one * pictures && std::ssize(views) < pictures;
         k += candidates_at_once) {
      std::vector<Candidate> candidates(candidates_at_once);
      for (Candidate& one : candidates) {
        one.at = any();
        one.eye = glm::mix(one.at, any(), random.uniform(0.3, 1.0));
      }
      std::erase_if(candidates, [](const Candidate& one) { return one.eye == one.at; });
      for (const Candidate& one : filled_views(candidates, all_fit)) {
        if (std::ssize(views) < pictures) views.push_back(from(one.eye, one.at, side, model_));
      }
    }
    return views;
  }

  void draw(const shared::View& view) { frame_->draw({&view, 1}); }
  const gl::Buffer& colours() const { return frame_->colours(); }

  /// Sets the levels that a view needs for requested_db, and returns their predicted loss.
  double settle(const shared::View& view) {
    set_levels(coarsest());
    LevelChoice choice;
    shows_.assign(levels_of_chunks_.size(), 0.0);
    for (int pass = 0; pass < passes; ++pass) {
      const VisibleChunks seen{visibility_->measure({&view, 1}, {}, layout_), levels_};
      for (std::size_t i = 0; i < shows_.size(); ++i)
        shows_[i] = std::max(shows_[i], seen.by_view[0][i].area);
      choice = choose_by_error(chunks_, detail_views({&view, 1}),
                               {.error = error_of_psnr(requested_db), .heads_turn = false}, seen);
      if (choice.levels == levels_) break;
      set_levels(choice.levels);
    }
    return choice.error();
  }

  /// Sets the chunks that the settled view shows to their finest levels.
  void refine() {
    std::vector<std::size_t> levels = levels_;
    for (std::size_t i = 0; i < levels.size(); ++i)
      if (shows_[i] > hidden) levels[i] = 0;
    set_levels(levels);
  }

 private:
  void put(const std::vector<std::size_t>& levels) {
    std::vector<ModelChunks::Replacement> replacements;
    for (std::size_t i = 0; i < levels_of_chunks_.size(); ++i)
      if (levels_.empty() || levels[i] != levels_[i])
        replacements.push_back({i, &levels_of_chunks_[i][levels[i]]});
    levels_ = levels;
    layout_.replace(model_, replacements);
  }

  struct Candidate {
    glm::dvec3 eye, at;
  };

  /// Returns the candidates whose views are well filled, with nothing close in front of their target.
  std::vector<Candidate> filled_views(std::span<const Candidate> candidates, bool& all_fit) {
    std::vector<shared::View> views;
    for (const Candidate& one : candidates) views.push_back(from(one.eye, one.at, candidate_side, model_));
    std::vector<std::vector<ChunkVisibility>> seen;
    if (views.empty()) return {};
    if (!can_draw([&] { seen = visibility_->measure(views, {}, layout_); })) {
      all_fit = false;
      return {};
    }
    std::vector<Candidate> found;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      double area = 0.0, logarithms = 0.0;
      for (const ChunkVisibility& chunk : seen[k]) {
        if (chunk.area == 0.0) continue;
        area += chunk.area;
        logarithms += chunk.area * std::log(chunk.distance);
      }
      if (area > min_visible_area * candidate_side * candidate_side &&
          std::exp(logarithms / area) >
              min_relative_distance * glm::distance(candidates[k].eye, candidates[k].at))
        found.push_back(candidates[k]);
    }
    return found;
  }

  std::span<const std::vector<Model>> levels_of_chunks_;
  std::vector<LodChunk> chunks_;
  ModelChunks layout_;
  std::vector<std::size_t> levels_;
  std::vector<double> shows_;  // visible area of each chunk in the settled view, px
  Model model_;
  std::shared_ptr<render::GpuModel> gpu_model_;
  std::optional<render::Frame> frame_;
  std::optional<Visibility> visibility_;
};

}  // namespace

std::vector<JointLoss> joint_losses(gl::Context& context,
                                    std::span<const std::vector<Model>> levels_of_chunks,
                                    std::span<const LevelErrors> errors, int pictures) {
  JointModel joint(context, levels_of_chunks, errors);
  bool all_fit = true;
  const std::vector<shared::View> views = joint.find_views(pictures, all_fit);
  std::vector<JointLoss> losses;
  for (const shared::View& view : views) {
    JointLoss loss;
    render::SquaredError error(context);
    const auto draw = [&] {
      loss.predicted = joint.settle(view);
      joint.draw(view);
      error.add(joint.colours(), side * side);
      joint.refine();
      joint.draw(view);
      loss.measured = error.mean(joint.colours());
    };
    loss.drawn = can_draw(draw);
    if (!loss.drawn) joint.reset();
    losses.push_back(loss);
  }
  if (!all_fit) losses.resize(static_cast<std::size_t>(pictures), {.drawn = false});
  return losses;
}

}  // namespace binosplat::compact
