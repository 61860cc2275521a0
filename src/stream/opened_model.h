#pragma once
// A model to draw: whole, or with levels of detail that follow the views.

#include <memory>

#include "render/gpu_model.h"
#include "scene/model.h"

namespace binosplat {

/// `Levels` is Stream or PictureStream.
template <typename Levels>
struct OpenedModel {
  std::unique_ptr<Levels> stream = {};  // owns the model if its levels follow the views; else null
  Model whole = {};

  const Model& model() const { return stream ? stream->model() : whole; }
  std::size_t gaussians() const { return stream ? stream->gaussians() : whole.count(); }
  /// Uploads the model; a stream does so once. This object must stay in place while the result is in use.
  std::shared_ptr<render::GpuModel> gpu_model(gl::Context& context, int precision) const {
    return stream ? stream->gpu_model(context, precision)
                  : std::make_shared<render::GpuModel>(context, whole, precision);
  }
};

}  // namespace binosplat
