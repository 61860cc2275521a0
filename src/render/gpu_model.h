#pragma once
// A model on the GPU, which any number of frames draw.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "gl/buffer.h"
#include "render/anchors.h"
#include "render/frame_plan.h"
#include "render/scattered_upload.h"
#include "scene/model_chunks.h"

namespace binosplat::render {

/// The model in one precision, in pages small enough for a shader to address each buffer. A page of a
/// Scaffold-GS model holds complete anchors. Each frame decodes the anchors' Gaussians, and their colours as
/// harmonics of degree 0, into the order (view, index).
struct ModelBuffers {
  struct Page {
    std::uint32_t first = 0;  // index of its first Gaussian in the model
    std::uint32_t count = 0;
    std::unique_ptr<gl::Buffer> gaussians;  // Gaussian, or Halves
    std::unique_ptr<gl::Buffer> harmonics;  // packed vec4s, or as many halves (sh.glsl)
    std::unique_ptr<AnchorBuffers> anchors;
  };

  /// A page has at most `page_gaussians` Gaussians; 0: as many as a shader can address in one buffer.
  ModelBuffers(gl::Context& context, const Model& model, int precision, std::uint32_t page_gaussians);

  /// Replaces the model by another one. Reuses buffers that are large enough.
  void upload(gl::Context& context, const Model& model);

  /// Uploads the changes of the model, which may have grown but not shrunk. Gaussians of places that were
  /// never filled have opacity 0. Not for Scaffold-GS.
  void upload(gl::Context& context, const Model& model, const ModelChunks::Changes& changes);

  /// Allocates room for the Gaussians that a frame of this plan decodes.
  void reserve(const FramePlan& plan);

  const int precision;  // PRECISION_ of shared/choices.h
  std::vector<Page> pages;
  NetworkBuffers networks;

 private:
  std::size_t page_step(gl::Context& context, const Model& model) const;
  void set_pages(gl::Context& context, const Model& model);
  void clear_from(const Page& page, std::int64_t first) const;
  std::int64_t capacity_of(const Page& page, const Model& model) const;  // Gaussians
  void upload_pages(gl::Context& context, const Scaffold& scaffold, std::size_t step);

  std::uint32_t page_gaussians_;
  std::size_t page_step_ = 0;                    // Gaussians
  ScatteredUpload to_gaussians_, to_harmonics_;  // two, as each waits until the GPU has read its last upload
};

class GpuModel {
 public:
  /// Uploads the model in a PRECISION_ of shared/choices.h. Model and context must outlive the GpuModel, and
  /// the context must be current in every call. `page_gaussians` is for tests (see ModelBuffers). Throws
  /// Error(out_of_memory) if the GPU has no room.
  GpuModel(gl::Context& context, const Model& model, int precision = PRECISION_FULL,
           std::uint32_t page_gaussians = 0);

  gl::Context& context() const { return context_; }
  const Model& model() const { return model_; }
  /// The model's size at its last upload. Frames use it, because the model may have changed since.
  const ModelSize& size() const { return size_; }

  /// Returns the model in `precision`, and uploads it if no frame holds it. The buffers stay on the GPU while
  /// a frame holds them. Those of the last requested precision stay, too, but a reload frees them if frames
  /// hold only the other precision. Throws as the constructor does.
  std::shared_ptr<ModelBuffers> buffers_in(int precision);

  /// Uploads the model again after a change of its levels of detail. Reuses buffers that are large enough.
  /// Frames compare uploads() to detect measurements of another state. Throws as the constructor does.
  void reload();
  void reload(const ModelChunks::Changes& changes);
  int uploads() const { return uploads_; }

 private:
  /// Calls upload() for each precision on the GPU. First frees the last requested precision if frames hold
  /// only the other one.
  template <typename Upload>
  void upload_all(const Upload& upload);

  gl::Context& context_;
  const Model& model_;
  std::uint32_t page_gaussians_;
  int uploads_ = 0;
  ModelSize size_;
  std::shared_ptr<ModelBuffers> latest_;
  std::array<std::weak_ptr<ModelBuffers>, 2> by_precision_;  // by precision
};

}  // namespace binosplat::render
