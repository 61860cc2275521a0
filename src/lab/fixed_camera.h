#pragma once
// A camera, or both eyes, that stand still: their exact pictures, measured once, and every rule against them.

#include <vector>

#include "lab/stability.h"
#include "render/frame.h"
#include "render/squared_error.h"

namespace binosplat::lab {

class FixedCamera {
 public:
  /// Draws the exact pictures. Context and model must outlive it.
  FixedCamera(gl::Context& context, const Model& model, std::vector<shared::View> views);

  const gl::Context& context() const { return frame_.model()->context(); }
  const std::vector<shared::View>& views() const { return views_; }
  const std::vector<Picture>& exact() const { return exact_; }
  double exact_pairs() const { return exact_pairs_; }
  const render::DepthTable& depth_table() const { return table_; }  // measured in these views

  /// A rule's next frame goes by nothing that earlier ones measured.
  void forget() { frame_.forget(); }
  /// A rule's next frame, which measures as FrameSettings::record_every says.
  render::FrameReport draw(const Variant& variant, int record_every = 1);
  /// The frame, from nothing, after which it has settled.
  render::FrameReport settle(const Variant& variant);

  /// Of the last frame drawn against the exact one: the mean over all views together, and in dB.
  double squared_error() { return error_.mean(frame_.colours()); }
  double psnr() { return error_.psnr(frame_.colours()); }
  std::vector<Picture> pictures() { return frame_.read_pictures(); }

  /// The tolerance at which settle() comes to `target` dB, at most 0.1 dB above; 0 for --th tau, and where
  /// none does.
  float tolerance_at(Variant variant, double target);

 private:
  render::Frame frame_;
  std::vector<shared::View> views_;
  double exact_pairs_ = 0.0;
  std::vector<Picture> exact_;
  render::SquaredError error_;
  render::DepthTable table_;
};

}  // namespace binosplat::lab
