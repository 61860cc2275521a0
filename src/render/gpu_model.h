#pragma once
// A model on the GPU, which any number of frames draw.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "gl/buffer.h"
#include "render/anchors.h"
#include "render/frame_plan.h"
#include "render/scatter.h"
#include "scene/model_chunks.h"

namespace binosplat::render {

/// The model in one precision, in pages of Gaussians whose buffers a shader can reach. A page of a
/// Scaffold-GS model holds whole anchors, and each frame makes its Gaussians and their colours (as harmonics
/// of degree 0) anew, once for each decoding: (decoding, id).
struct ModelBuffers {
  struct Page {
    std::uint32_t first = 0;  // Gaussian of the model
    std::uint32_t count = 0;
    std::unique_ptr<gl::Buffer> gaussians;  // Gaussian, or Halves
    std::unique_ptr<gl::Buffer> harmonics;  // packed vec4s, or as many halves (sh.glsl)
    std::unique_ptr<AnchorBuffers> anchors;
  };

  /// Uploads the model. A page has at most `page_gaussians`; 0: as many as a shader reaches in one buffer.
  ModelBuffers(gl::Context& context, const Model& model, int precision, std::uint32_t page_gaussians);

  /// Uploads another model in the place of this one, into the same buffers where they are large enough.
  void upload(gl::Context& context, const Model& model);

  /// Uploads what has changed of the model, which may have grown but not shrunk; places that were never
  /// filled have an opacity of 0. Not for Scaffold-GS.
  void upload(gl::Context& context, const Model& model, const ModelChunks::Changes& changes);

  /// Makes room for what a frame of this plan decodes.
  void reserve(const FramePlan& plan);

  const int precision;  // PRECISION_ of shared/axes.h
  std::vector<Page> pages;
  NetworkBuffers networks;

 private:
  std::size_t page_step(gl::Context& context, const Model& model) const;
  void set_pages(gl::Context& context, const Model& model);
  void hide(const Page& page, std::int64_t first) const;
  std::int64_t room_in(const Page& page, const Model& model) const;  // Gaussians
  void upload_pages(gl::Context& context, const Scaffold& scaffold, std::size_t step);

  std::uint32_t page_gaussians_;
  std::size_t page_step_ = 0;            // Gaussians
  Scatter to_gaussians_, to_harmonics_;  // two, since each waits until the GPU has read its last upload
};

class GpuModel {
 public:
  /// Uploads the model in a PRECISION_ of shared/axes.h. Model and context must outlive it, and the context
  /// must be current in every call. `page_gaussians` is for tests (see ModelBuffers). Throws
  /// Error(out_of_memory) if the GPU has no room.
  GpuModel(gl::Context& context, const Model& model, int precision = PRECISION_FULL,
           std::uint32_t page_gaussians = 0);

  gl::Context& context() const { return context_; }
  const Model& model() const { return model_; }
  /// The model's size when it was uploaded last: frames draw that, whatever became of the model since.
  const ModelSize& size() const { return size_; }

  /// The model in that precision, which is uploaded where no frame holds it. It stays on the GPU as long as a
  /// frame holds it; the precision asked for last stays besides, until a reload while frames hold the other
  /// one only. Throws as the constructor does.
  std::shared_ptr<ModelBuffers> in(int precision);

  /// Uploads the model again, which has changed since: it is the same scene at other levels of detail.
  /// Buffers are used again where they are large enough. Frames see by `uploads` that what they measured is
  /// of another model. Throws as the constructor does.
  void reload();
  /// The same, but uploads these places only (ModelBuffers::upload).
  void reload(const ModelChunks::Changes& changes);
  int uploads() const { return uploads_; }

 private:
  /// Calls upload() for each precision that is held, and drops the other.
  template <typename Upload>
  void upload_all(const Upload& upload);

  gl::Context& context_;
  const Model& model_;
  std::uint32_t page_gaussians_;
  int uploads_ = 0;
  ModelSize size_;
  std::shared_ptr<ModelBuffers> latest_;
  std::array<std::weak_ptr<ModelBuffers>, 2> all_;  // by precision
};

}  // namespace binosplat::render
