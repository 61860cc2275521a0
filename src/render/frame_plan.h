#pragma once
// What a frame is made of before anything is drawn: its views with tiles and offsets, and what they share.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "render/instance.h"
#include "render/mesh_depth.h"
#include "render/settings.h"
#include "render/workings.h"
#include "scene/model.h"
#include "shared/types.h"

namespace binosplat::render {

/// Views that see equal depths and are projected together: [begin, end) of the frame's views.
struct OrderGroup {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// Tiles of one of a frame's views that are drawn exactly, too, to see what the frame's tolerance costs: one
/// of every `step` x `step`, from the one in this column and row on.
struct Probe {
  std::uint32_t view = 0;
  std::uint32_t step = 1;
  std::uint32_t column = 0;
  std::uint32_t row = 0;
};

/// What a probe showed.
struct Probed {
  double squared_error = 0.0;  // mean over its pixels and channels, 8 bits
  double unevenness = 0.0;     // variance of its tiles' errors, in squares of their mean
};

/// Meshes of the caller's among the splats.
struct Meshes {
  std::vector<MeshDepth> depths;        // by view that is asked for; empty: there are none
  std::vector<glm::uvec2> whole_sizes;  // px, by view: of the picture that a window is a part of
};

/// Gaussians of a model, and how many it has room for.
struct ModelSize {
  std::size_t gaussians = 0, room = 0;
};
inline ModelSize size_of(const Model& model) { return {model.count(), std::max(model.count(), model.room)}; }

/// One of a frame's models. It is drawn by `instances` of the frame's, from `first_instance` on.
struct PlannedModel {
  int degree = 0;  // of its SH
  double kernel_px2 = KERNEL_PX2;
  bool antialiased = false;
  ModelSize size;  // of one instance
  std::uint32_t first_instance = 0, instances = 1;
};
PlannedModel planned(const Model& model, const ModelSize& size);

/// What a frame derives from its settings, its views and its model before anything is drawn. It is made once,
/// by make_plan(); what frames remember of one another is history.h's.
struct FramePlan {
  FrameSettings settings;
  float tolerance = 0.0f;            // K or kappa: the settings', or one that was found for a quality
  bool between_pixels = false;       // likewise
  bool visibility_as_depth = false;  // likewise
  Perspective perspective;
  std::vector<PlannedModel> models;
  std::vector<InstancePlace> instances;  // by model; empty: one model, once, in its own world
  std::uint32_t gaussian_count = 0;      // of all instances
  std::uint32_t gaussian_room = 0;       // as many, or more where a model grows
  std::vector<shared::View> views;       // those asked for, then the probe's
  std::uint32_t asked = 0;
  std::optional<Probe> probe;
  std::vector<OrderGroup> groups;
  std::vector<glm::uvec2>
      region_rows;  // by row of tiles of all views (tiles/regions.glsl), where any view is not drawn whole
  std::vector<Canvas> canvases;  // where pictures go; empty: into the frame's own buffer
  int depth_rows = 1;            // with canvases: depths are wanted in every row, or every second one
  Meshes meshes;
  std::uint32_t supertile_count = 0;  // over all views
  int list_views = 1;                 // views that share lists, by share_lists()
  std::int64_t pixel_count = 0;       // over all views
  // For Scaffold-GS; K is 0 for other models.
  std::uint32_t offset_count = 0;        // K
  std::uint32_t views_per_decoding = 1;  // views that share what the networks made
  std::int64_t anchor_bytes = 0;

  bool draws_regions() const { return !region_rows.empty(); }
  /// DEPTH_ of shared/limits.h, what the blend tells of a pixel's depth.
  int depth() const;
  /// Whether `z_sums` are depths: where pictures are final.
  bool tells_depths() const { return !canvases.empty() || !meshes.depths.empty(); }
  /// How much nearer splats may be than those before them in a list, world units; infinite: any.
  float depth_slack() const;
  /// Whether splats are blended by blocks, which end once they are dark (docs/method.md 5.2).
  bool is_approximate() const { return settings.th == TH_SQUARED && settings.tiles == TILES_ELLIPSE; }
  std::uint32_t view_count() const { return static_cast<std::uint32_t>(views.size()); }
  /// Tiles of all supertiles: a few more than the pictures have.
  std::uint32_t tile_count() const { return supertile_count * SUPERTILE_SIDE * SUPERTILE_SIDE; }
  std::uint32_t supertiles_of(std::uint32_t view) const {
    return (view + 1 < view_count() ? views[view + 1].supertile_offset : supertile_count) -
           views[view].supertile_offset;
  }
  /// How often each anchor is decoded. A probe shares the Gaussians of its view.
  std::uint32_t decoding_count() const { return (asked + views_per_decoding - 1) / views_per_decoding; }
  std::uint32_t decoding_of_probe() const { return probe ? probe->view / views_per_decoding : 0; }
};

/// What the settings ask for, and otherwise what the model was trained with.
Perspective perspective_of(const FrameSettings& settings, const Model& model);

/// What is asked of a plan besides settings.
struct PlanRequest {
  std::vector<PlannedModel> models;      // empty: the model that make_plan() is given
  std::vector<InstancePlace> instances;  // as FramePlan's
  std::optional<Probe> probe;
  std::optional<float> tolerance;  // in the place of the settings'
  CallersTextures textures;
};

/// Lets both eyes, views 2k and 2k + 1, share lists (supertiles.glsl), if all of these see equal depths
/// through equal lenses in grids of equal size, and entries have enough bits for `slots` Gaussians. The
/// second eye's grid is moved by the disparity at `middle_depth`, world units; unless it is above 0, not at
/// all.
void share_lists(FramePlan& plan, std::int64_t slots, double middle_depth);

/// Makes the plan for a model of this size, whatever model.count() says: the model in memory may have changed
/// since it was uploaded. Throws Error(bad_input) for no views, more than MAX_VIEWS, an empty or huge
/// picture, and settings that contradict each other or the views.
FramePlan make_plan(std::span<const shared::View> views, const FrameSettings& settings, const Model& model,
                    const ModelSize& size, const Workings& workings, const PlanRequest& request = {});
inline FramePlan make_plan(std::span<const shared::View> views, const FrameSettings& settings,
                           const Model& model, const Workings& workings = {},
                           const PlanRequest& request = {}) {
  return make_plan(views, settings, model, size_of(model), workings, request);
}

}  // namespace binosplat::render
