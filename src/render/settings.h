#pragma once
// What a caller may choose about a frame.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "shared/axes.h"
#include "shared/limits.h"

namespace binosplat::render {

/// The stages of a frame, in order; `decode` of Scaffold-GS only. Each is a shader, a file here and a test of
/// one name.
enum class Stage { decode, project, order, pairs, tile_sort, ranges, blend };
constexpr const char* stage_names[] = {"decode", "project", "order", "pairs", "tile_sort", "ranges", "blend"};

struct FrameSettings {
  int tiles = TILES_ELLIPSE;              // TILES_ of shared/axes.h
  int th = TH_TAU;                        // TH_ of shared/axes.h
  int transmittance = TRANSMITTANCE_ONE;  // TRANSMITTANCE_ of shared/axes.h: where Th takes T_upper from
  int contrast = CONTRAST_OFF;            // CONTRAST_; with TH_SQUARED and a measured transmittance only
  float loss = 0.0f;         // K (alpha * px^2) of TH_PERIPHERAL, kappa (px * squared colour) of TH_SQUARED
  int decode = DECODE_EYES;  // DECODE_; of Scaffold-GS only
  bool anchor_cull = true;   // of Scaffold-GS: as trained; false: anchors out of sight are decoded, too
  int tile_size = TILE_SIZE_DEFAULT;  // px: 8, 16 or 32; the picture does not depend on it
  glm::vec3 background{0.0f};         // behind the scene, for contrast only: the pictures are without
  /// Stages up to this one are taken from the float64 reference on the CPU, the GPU does the rest: a wrong
  /// picture is bisected to its stage.
  std::optional<Stage> reference_until;
  /// Room to start with, in Gaussians in view and in pairs; 0: chosen by the frame. A frame that needs more
  /// grows its buffers and is drawn again.
  std::int64_t order_capacity = 0;
  std::int64_t pair_capacity = 0;
};

}  // namespace binosplat::render
