#pragma once
// The plan of a frame, complete before anything is drawn: views with tiles and offsets, shared resources.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "render/debug_options.h"
#include "render/frame_settings.h"
#include "render/instance.h"
#include "render/mesh_depth.h"
#include "scene/model.h"
#include "shared/types.h"

namespace binosplat::render {

/// Views in which each point has the same depth, projected together: [begin, end) of the frame's views.
struct OrderGroup {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// The error sample: tiles of one view that are drawn a second time, exactly, or with the tolerance if the
/// frame is exact. It measures the tolerance's error. It has one of every `step` x `step` tiles, starting at
/// `column` and `row`.
struct Probe {
  std::uint32_t view = 0;
  std::uint32_t step = 1;
  std::uint32_t column = 0;
  std::uint32_t row = 0;
};

struct ProbeResult {
  double squared_error = 0.0;  // mean over the probe's pixels and channels; 8-bit colours, from 0 to 1
  double unevenness = 0.0;     // variance of its tiles' errors, divided by their squared mean
  double tiles = 0.0;          // number of its tiles
  // Gaussian-tile pairs of its tiles, with the tolerance and exactly.
  double pairs = 0.0, exact_pairs = 0.0;
};

struct Meshes {
  std::vector<MeshDepth> depths;        // by requested view; empty without meshes
  std::vector<glm::uvec2> whole_sizes;  // px, by view: size of the whole picture, of which a window is a part
};

struct ModelSize {
  std::size_t gaussians = 0, capacity = 0;
};
inline ModelSize size_of(const Model& model) {
  return {model.count(), std::max(model.count(), model.capacity)};
}

/// One of a frame's models. The frame's instances [first_instance, first_instance + instances) draw it.
struct PlannedModel {
  int degree = 0;  // of the spherical harmonics
  double kernel_px2 = KERNEL_PX2;
  bool antialiased = false, linear = false, flat = false;
  ModelSize size;  // of one instance
  std::uint32_t first_instance = 0, instances = 1;
};
PlannedModel planned(const Model& model, const ModelSize& size);

/// make_plan() derives the plan from settings, views and model; history.h keeps the state that frames share.
struct FramePlan {
  FrameSettings settings;        // with a threshold and a transmittance
  std::uint32_t list_parts = 1;  // dispatches that share the lists; more than 1 if the driver ends long loops
  float tolerance = 0.0f;        // K or kappa: the settings', or found for a quality
  bool exact = false;            // only the probe has the tolerance
  bool between_pixels = false;   // DebugOptions::between_pixels
  bool visibility_as_depth = false;  // DebugOptions::visibility_as_depth
  Perspective perspective;
  std::vector<PlannedModel> models;
  std::vector<InstancePlace> instances;  // grouped by model; empty: one model in its own world
  std::uint32_t gaussian_count = 0;      // of all instances
  std::uint32_t gaussian_capacity = 0;   // at least gaussian_count; larger if a model may grow
  std::vector<shared::View> views;       // the requested views, then the probe's
  std::uint32_t requested_views = 0;
  std::optional<Probe> probe;
  std::vector<OrderGroup> groups;
  /// By row of tiles of all views (tiles/regions.glsl); empty if no view has a region.
  std::vector<glm::uvec2> region_rows;
  std::vector<Canvas> canvases;  // destinations of the pictures; empty: the frame's own buffer
  int depth_rows = 1;            // with canvases: 1 stores depths of every row, 2 of every second row
  Meshes meshes;
  std::uint32_t supertile_count = 0;  // over all views
  int list_views = 1;                 // number of views that share a list, set by share_lists()
  std::int64_t pixel_count = 0;       // over all views
  // For Scaffold-GS; K is 0 for other models.
  std::uint32_t offset_count = 0;  // K
  std::int64_t anchor_bytes = 0;

  bool draws_regions() const { return !region_rows.empty(); }
  /// DEPTH_ of shared/limits.h: the depth that the blend computes.
  int depth() const;
  /// Whether depths of flat Gaussians are on their planes. In half precision, whose fast blend has one depth
  /// per splat, and along rays between pixels (RayBlend) they are those of the means.
  bool has_discs() const;
  /// Whether `z_sums` holds final depths instead of sums.
  bool has_final_depths() const { return !canvases.empty() || !meshes.depths.empty(); }
  /// Whether a focal length is less than two tiles, so that a tile may be over 28 degrees wide. With the
  /// tangent projection a splat is visible up to 69 degrees from its direction (docs/method.md 2.2). So such
  /// a tile may show a splat along one ray while the splat lies behind another ray, over 90 degrees away.
  bool has_broad_tiles() const;
  /// How much nearer a splat may be than its predecessors in a list, in world units; infinite: no limit.
  float depth_slack() const;
  /// Whether splats are blended by blocks that stop at dark pixels (docs/method.md 5.2).
  bool is_approximate(bool is_probe) const {
    return settings.threshold == Threshold::squared && settings.tiles == TILES_ELLIPSE && is_probe == exact &&
           list_parts == 1;
  }
  std::uint32_t view_count() const { return static_cast<std::uint32_t>(views.size()); }
  /// The tiles of all supertiles: slightly more than the tiles of the pictures.
  std::uint32_t tile_count() const { return supertile_count * SUPERTILE_SIDE * SUPERTILE_SIDE; }
  std::uint32_t supertiles_of(std::uint32_t view) const {
    return (view + 1 < view_count() ? views[view + 1].supertile_offset : supertile_count) -
           views[view].supertile_offset;
  }
};

/// The order and projection of the settings, or else of the model's training.
Perspective perspective_of(const FrameSettings& settings, const Model& model);

/// Inputs of a plan besides settings.
struct PlanRequest {
  std::vector<PlannedModel> models;      // empty: the model that make_plan() is given
  std::vector<InstancePlace> instances;  // as FramePlan::instances
  std::optional<Probe> probe;
  std::optional<Threshold> threshold;  // replaces the settings' threshold
  std::optional<float> tolerance;      // replaces the settings' tolerance
  bool exact = false;                  // as FramePlan::exact
  CallersTextures textures;
};

/// Lets eye pairs, views 2k and 2k + 1, share lists (supertiles.glsl), if possible. The eyes of a pair must
/// share an order group, focal lengths and grid sizes, and entries must have enough bits for `slots`
/// Gaussians. Shifts the second eye's grid by the disparity at `middle_depth` (world units; 0 or less: no
/// shift).
void share_lists(FramePlan& plan, std::int64_t slots, double middle_depth);

/// Makes the plan for `size` instead of model.count(), because the model in memory may have changed since its
/// upload. Throws Error(bad_input) for no views, more than MAX_VIEWS, an empty or huge picture, and settings
/// that contradict the views.
FramePlan make_plan(std::span<const shared::View> views, const FrameSettings& settings, const Model& model,
                    const ModelSize& size, const DebugOptions& debug, const PlanRequest& request = {});
inline FramePlan make_plan(std::span<const shared::View> views, const FrameSettings& settings,
                           const Model& model, const DebugOptions& debug = {},
                           const PlanRequest& request = {}) {
  return make_plan(views, settings, model, size_of(model), debug, request);
}

}  // namespace binosplat::render
