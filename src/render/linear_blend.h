#pragma once
// A picture is linear in the colours of its splats: C = W c. W has alpha * T of each pixel and splat
// (docs/method.md 3). This class applies W and its transpose. `trim` and `refit` use them to measure each
// Gaussian's contribution, and to fit colours to pictures.

#include <span>
#include <vector>

#include "render/frame.h"

namespace binosplat::render {

/// Applies W of one view at a time, exact and in full precision.
class LinearBlend {
 public:
  /// Context and model must outlive it, and the context must be current in every call. Throws as GpuModel
  /// does.
  LinearBlend(gl::Context& context, const Model& model)
      : LinearBlend(std::make_shared<GpuModel>(context, model)) {}
  /// The same for a shared model.
  explicit LinearBlend(std::shared_ptr<GpuModel> model);

  /// Sets W to that of a view; the picture becomes undefined. Uses the settings that exact_of() keeps. Throws
  /// as Frame::draw() does.
  void set_view(const shared::View& view, const FrameSettings& settings = {}, const DebugOptions& debug = {});

  /// The Gaussians that the view draws, in index order; each has a column in W.
  const std::vector<DrawnGaussian>& drawn() const { return drawn_; }

  /// Sets the picture to W c. `colours` has one per element of drawn(), of either sign. Throws
  /// Error(out_of_memory) if lists of splats are too long for the driver, as does transposed().
  void set_colours(std::span<const glm::vec3> colours);

  /// Replaces the picture: one vec4 per pixel of the view, rows from the top.
  void set_picture(std::span<const glm::vec4> pixels) {
    frame_.buffers().pictures.colours.upload_part(pixels, 0);
  }

  /// vec4 by pixel. After set_colours(), a is the transmittance left.
  std::vector<glm::vec4> read_picture();

  /// W^T times the picture, by channel, for each of drawn(). Each pixel adds a multiple of `largest` /
  /// TRANSPOSED_SCALE, so the result is the same bits every time. No channel may exceed `largest`.
  std::vector<glm::dvec4> transposed(float largest);

  /// For each of drawn(): the squared change of the picture if it alone is removed, summed over pixels and
  /// channels. Uses the model's colours, or the colours set last. Each pixel adds a multiple of 1 /
  /// CHANGE_SCALE, and at most CHANGE_MOST.
  std::vector<double> changes();

 private:
  template <typename Record>
  void run(const Record& record);
  std::uint32_t slots() const { return drawn_.empty() ? 0 : drawn_.back().slot + 1; }
  template <typename Record>
  std::vector<std::int64_t> sums(const Record& record);

  Frame frame_;
  gl::Dispatcher dispatcher_;
  std::vector<DrawnGaussian> drawn_;
  gl::Buffer colours_;  // vec4 by slot
  gl::Buffer sums_;     // ivec2 by slot and channel: 64 bits, low first
};

}  // namespace binosplat::render
