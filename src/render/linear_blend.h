#pragma once
// A picture is linear in the colours of its splats: C = W c. An element of W is alpha * T of a splat in a
// pixel (docs/method.md 3). `trim` and `refit` use W and its transpose to measure each Gaussian's
// contribution, and to fit colours to pictures.

#include <span>
#include <vector>

#include "render/frame.h"

namespace binosplat::render {

/// A Gaussian that is in a tile's list of a view.
struct GaussianInView {
  std::uint32_t index = 0;  // in the model
  /// px: three standard deviations along the splat's longer axis, for `tangent` as if the picture were flat
  /// around its middle; infinite for wide splats (docs/method.md 2.2).
  float radius = 0.0f;
  std::int32_t tiles = 0;     // whose lists have it
  float transmittance = 0.0;  // max(T); 0 if no pixel blends the Gaussian
  double contribution = 0.0;  // alpha T, summed over the pixels that blend it, px
};

/// Applies W of one view at a time, exact and in full precision.
class LinearBlend {
 public:
  /// Context and model must outlive the LinearBlend, and the context must be current in every call. Throws as
  /// GpuModel does.
  LinearBlend(gl::Context& context, const Model& model)
      : LinearBlend(std::make_shared<GpuModel>(context, model)) {}
  explicit LinearBlend(std::shared_ptr<GpuModel> model);

  /// Sets W to a view's matrix; the picture becomes undefined. Uses the settings that exact_of() keeps.
  /// Throws as Frame::draw() does.
  void set_view(const shared::View& view, const FrameSettings& settings = {}, const DebugOptions& debug = {});

  /// Measures each Gaussian of drawn(), which becomes that of `settings`: with their threshold and tile test.
  /// All pixels of a paired tile count, also those that `squared` skips by blocks (docs/method.md 5.2).
  std::vector<GaussianInView> measure(const shared::View& view, const FrameSettings& settings);

  /// The Gaussians that the view draws, in index order; each has a column in W.
  const std::vector<DrawnGaussian>& drawn() const { return drawn_; }

  /// Sets the picture to W c. `colours` has one colour per element of drawn(); colours may be negative.
  /// Throws Error(out_of_memory) if lists of splats are too long for the driver, as does transposed().
  void set_colours(std::span<const glm::vec3> colours);

  /// Replaces the picture: one vec4 per pixel of the view, rows from the top.
  void set_picture(std::span<const glm::vec4> pixels) {
    frame_.buffers().pictures.colours.upload_part(pixels, 0);
  }

  /// vec4 by pixel. After set_colours(), .a is the transmittance behind all splats.
  std::vector<glm::vec4> read_picture();

  /// Returns W^T times the picture: for each element of drawn(), a sum per channel. Each pixel's summand is
  /// rounded to a multiple of `largest` / TRANSPOSED_SCALE, so sums do not depend on their order. No channel
  /// of the picture may exceed `largest`.
  std::vector<glm::dvec4> transposed(float largest);

  /// Returns for each element of drawn() the squared change of the picture if this Gaussian alone is removed,
  /// summed over pixels and channels. Uses the last set_colours(), or else the model's colours. Each pixel's
  /// summand is rounded to a multiple of 1 / CHANGE_SCALE, and is at most CHANGE_MAX.
  std::vector<double> changes();

 private:
  void set_lists(const shared::View& view, const FrameSettings& settings, const DebugOptions& debug);
  template <typename Record>
  void run(const Record& record);
  std::uint32_t slots() const { return drawn_.empty() ? 0 : drawn_.back().slot + 1; }
  template <typename Record>
  std::vector<std::int64_t> sums(const Record& record);

  Frame frame_;
  FramePlan plan_;  // of frame_, but without blocks, which have no matrix
  gl::Dispatcher dispatcher_;
  std::vector<DrawnGaussian> drawn_;
  gl::Buffer colours_;  // vec4 by slot
  gl::Buffer sums_;     // ivec2 by (slot, channel): 64 bits, low word first
};

}  // namespace binosplat::render
