#pragma once
// The variants of the frame's shaders, and which of them are legal.

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "gl/context.h"
#include "render/frame_plan.h"
#include "shared/limits.h"

namespace binosplat::render {

gl::Number projection_number(Projection projection);

/// The define WITH_SUBGROUPS, for programs that use subgroups of 32 if the GPU has them.
gl::Number subgroups_number(const gl::Context& context);

/// The variant of the programs that decide which pairs exist: project_cull.comp, project.comp,
/// bin_large.comp.
struct PairVariant {
  /// The variant for the plan's first model.
  explicit PairVariant(const FramePlan& plan);
  void take(const PlannedModel& model);

  int tiles;
  Threshold threshold;
  Transmittance transmittance;
  bool probed, regions, antialiased = false, half;
  std::uint32_t offset_count;
  Order order;
  Projection projection;
  bool between_pixels;
  float kernel_px2 = 0.0f;  // 0: the default of shared/limits.h
  // Only some of these programs use the following:
  bool measures = false;  // the frame measures transmittance for later frames
  int eyes = 1;           // invocations along y of project_cull.comp
  int sh_degree = 0;
  bool subgroups = false;
  int list_views = 1;
  bool discs = false;  // also computes the planes of flat Gaussians

  std::array<gl::Number, 18> numbers() const;
};

/// The define LIST_VIEWS of the programs that make lists (supertiles.glsl).
gl::Number list_views_number(const FramePlan& plan);

/// The programs of the blend: for any GPU, for software renderers, and for subgroups of 32 invocations. All
/// draw the same bits.
enum class BlendProgram { general, software, subgroups };

struct BlendVariant {
  BlendProgram program = BlendProgram::general;
  bool plain = false;       // whole views without a probe, as in most frames
  bool long_lists = false;  // LISTS of list_lengths.glsl
  bool half = false;
  int measure = MEASURE_NONE;  // MEASURE_ of shared/limits.h
  bool debug_view = false;     // writes a value per pixel instead of the picture
  int depth = DEPTH_NONE;      // DEPTH_ of shared/limits.h
  bool approximate = false;
  bool canvases = false;  // pictures go to the caller's images
  Projection projection = Projection::affine;
  bool mesh_depth = false;    // meshes of the caller may hide splats
  bool discs = false;         // depths of flat Gaussians are on their planes
  bool large_splats = false;  // splats touch many tiles: each invocation draws more pixels
  bool many_splats = false;   // tiles have many splats: blocks end within a round

  bool draws() const { return measure <= MEASURE_TRANSMITTANCE && !debug_view; }
  /// Whether frames may request this combination.
  bool is_legal() const;
  std::string_view shader() const;
  std::array<gl::Number, 14> numbers() const;
};

/// All legal variants.
std::vector<BlendVariant> blend_variants();

}  // namespace binosplat::render
