#pragma once
// A picture is linear in the colours of its splats: C = W c, where W has alpha * T of each pixel and splat
// (docs/method.md 3). Here are W and its transpose, which tell what each Gaussian is worth and which colours
// fit a picture best.

#include <span>
#include <vector>

#include "render/frame.h"

namespace binosplat::render {

/// W of one view at a time, exact and in full precision.
class LinearBlend {
 public:
  /// Context and model must outlive it, and the context must be current in every call. Throws as GpuModel
  /// does.
  LinearBlend(gl::Context& context, const Model& model)
      : LinearBlend(std::make_shared<GpuModel>(context, model)) {}
  /// The same for a model that others draw, too.
  explicit LinearBlend(std::shared_ptr<GpuModel> model);

  /// W becomes that of a view, and the picture undefined. Uses the settings that exact_of() keeps. Throws as
  /// Frame::draw() does.
  void set_view(const shared::View& view, const FrameSettings& settings = {}, const Workings& workings = {});

  /// The Gaussians that the view draws, in index order: W has a column for each.
  const std::vector<DrawnGaussian>& drawn() const { return drawn_; }

  /// The picture becomes W c. `colours` has one for each of drawn(), of either sign. Throws
  /// Error(out_of_memory) for lists of splats that are too long for the driver, as does transposed().
  void set_colours(std::span<const glm::vec3> colours);

  /// Another picture in its place: a vec4 for each of the view's pixels, rows from the top.
  void set_picture(std::span<const glm::vec4> pixels) {
    frame_.buffers().pictures.colours.upload_part(pixels, 0);
  }

  /// vec4 by pixel: after set_colours() with the transmittance left in a.
  std::vector<glm::vec4> read_picture();

  /// W^T of the picture, by channel, for each of drawn(): whole multiples of `largest` / TRANSPOSED_SCALE,
  /// each pixel's to the nearest, the same bits always. No channel may be larger than `largest`.
  std::vector<glm::dvec4> transposed(float largest);

  /// The change of the picture without each of drawn() alone, in the model's colours or those that were set
  /// last: squared, summed over pixels and channels, each pixel's to the nearest 1 / CHANGE_SCALE and no more
  /// than CHANGE_MOST.
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
