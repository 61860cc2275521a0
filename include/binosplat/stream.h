#pragma once
// A model with levels of detail. It reads only the Gaussians that the views need, and keeps only these on the
// GPU. Use it for models that exceed the GPU's memory, or that the GPU cannot draw in time.
//
//   binosplat::SplatStream stream("city/");  // written by `binosplat levels`
//   binosplat::Renderer renderer(eglGetProcAddress, stream);
//   // Each frame:
//   stream.begin_frame(views, placement, settings, 2.5);
//   renderer.submit(views, placement, settings);

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include <binosplat/renderer.h>

namespace binosplat {

class Stream;  // internal

/// The request for levels of detail.
struct StreamOptions {
  /// dB, from 10 to 100: the PSNR that each view should have against the finest levels. The loss that
  /// Settings::quality accepts is added to that of the levels.
  double quality = 40.0;
  std::optional<std::size_t> max_gaussians = {};  // maximum number of Gaussians on the GPU
  /// At the start, memory is allocated for this many Gaussians, or for `max_gaussians` if that is fewer. So
  /// no frame waits for an allocation.
  std::size_t reserve = std::size_t{1} << 22;
};

/// A streamed SOG that contains the errors of its levels, as `binosplat levels` writes it. One thread of the
/// stream reads files; all other work happens inside calls. Make all calls on the thread of the renderer's
/// context while it is current, and destroy the stream there.
class SplatStream {
 public:
  /// Opens the files and reads the coarsest levels. Throws Error(bad_input) if the path holds no such model.
  explicit SplatStream(const std::filesystem::path& path, const StreamOptions& options = {});

  /// For the library's own code, which has streams open. `stream` is not null.
  explicit SplatStream(std::shared_ptr<Stream> stream);

  ~SplatStream();
  SplatStream(SplatStream&&) noexcept;
  SplatStream& operator=(SplatStream&&) noexcept;

  /// Same as SplatModel::placement().
  Placement placement(const glm::dvec3& origin = glm::dvec3(0.0), double units_per_metre = 1.0) const;

  /// Updates the levels. Call it before each frame, with that frame's views. Within about `ms`, including the
  /// GPU's time, it uploads what the thread has read, or draws one view of a visibility pass. The thread uses
  /// these passes to choose the levels that it reads next. While the views move, the first half of a pass
  /// draws the current views, and the second half those predicted for 0.5 s later. When the views rest and
  /// the model has all levels that they need, one call takes longer, because it measures the true loss of the
  /// levels. At 90 frames a second allow at least 2.5 ms, and 6 if there is time. Returns whether the model
  /// has changed.
  ///
  /// Throws Error. bad_input: as Renderer::submit() does; between submit() and finish(); before a renderer
  /// exists; if a file has become unreadable. out_of_memory.
  bool begin_frame(std::span<const View> views, const Placement& placement, const Settings& settings,
                   double ms);

  /// Same as SplatModel::bounds(), for the current levels.
  Bounds bounds() const;

  /// Whether the model has all levels that the views of the last begin_frame() need.
  bool settled() const;

  /// Gaussians in the model now.
  std::size_t count() const;

  /// The predicted PSNR in dB of the current levels against the finest, in the views. None before the first
  /// visibility pass. Also none for a model of at most 2^19 Gaussians, which is drawn in full once it is
  /// read.
  std::optional<double> quality() const;

 private:
  friend class Renderer;
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace binosplat
