#pragma once
// The variants that the shaders of a frame are compiled in, and which of them there are.

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "gl/context.h"
#include "render/frame_plan.h"
#include "shared/axes.h"
#include "shared/limits.h"

namespace binosplat::render {

/// The define of a PROJECTION_ of shared/axes.h.
gl::Number projection_number(int projection);

/// The define WITH_SUBGROUPS, for programs that use subgroups of 32 where there are some.
gl::Number subgroups_number(const gl::Context& context);

/// The variant of the programs that decide which pairs there are: project_cull.comp, project.comp,
/// bin_large.comp.
struct PairVariant {
  /// Of the plan's first model.
  explicit PairVariant(const FramePlan& plan);
  void take(const PlannedModel& model);

  int tiles, th, transmittance, tile_size;
  bool probed, regions, antialiased = false, half;
  std::uint32_t offset_count;
  int order, projection;
  bool between_pixels;
  float kernel_px2 = 0.0f;  // 0: that of shared/limits.h
  // Set for some of these programs only:
  bool measures = false;  // for later frames
  int eyes = 1;           // invocations along y of project_cull.comp
  int sh_degree = 0;
  bool subgroups = false;
  int list_views = 1;

  std::array<gl::Number, 18> numbers() const;
};

/// The define LIST_VIEWS of the programs that make lists (supertiles.glsl).
gl::Number list_views_number(const FramePlan& plan);

/// The programs of the blend, which draw the same bits: for any GPU, for software renderers, and for
/// subgroups of 32 invocations.
enum class BlendProgram { general, software, subgroups };

struct BlendVariant {
  BlendProgram program = BlendProgram::general;
  int tile_size = TILE_SIZE_DEFAULT;
  bool plain = false;       // whole views, no probe: as most frames are
  bool long_lists = false;  // LISTS of lists.glsl
  bool half = false;
  int measure = MEASURE_NONE;  // MEASURE_ of shared/limits.h
  bool debug_view = false;     // a number of each pixel in the place of its picture
  int depth = DEPTH_NONE;      // DEPTH_ of shared/limits.h
  bool approximate = false;
  bool canvases = false;  // pictures go into images of the caller's
  int projection = PROJECTION_AFFINE;
  bool broad = false;         // tiles are that wide splats may lie ahead of and behind
  bool mesh_depth = false;    // some splats lie behind meshes of the caller's
  bool large_splats = false;  // that touch many tiles: invocations draw more pixels

  bool draws() const { return measure <= MEASURE_TRANSMITTANCE && !debug_view; }
  /// Which combinations frames may ask for.
  bool is_legal() const;
  std::string_view shader() const;
  std::array<gl::Number, 14> numbers() const;
};

/// All variants that are legal.
std::vector<BlendVariant> blend_variants();

}  // namespace binosplat::render
