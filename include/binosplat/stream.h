#pragma once
// A model with levels of detail: of the Gaussians only as many are read, and kept on the GPU, as the views
// need. For models that are larger than the GPU's memory, or than what it draws in time.
//
//   binosplat::SplatStream stream("city/");  // as `binosplat levels` makes it
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

class Stream;  // the library's own

/// The request for levels of detail.
struct StreamOptions {
  /// dB, from 10 to 100: the PSNR that each view should have against the finest levels. A frame's own quality
  /// (Settings) comes on top of it.
  double quality = 40.0;
  std::optional<std::size_t> most = {};  // Gaussians at a time
  /// Memory is taken at once for so many, or `most` if that is fewer, so that no frame waits for it.
  std::size_t reserve = std::size_t{1} << 22;
};

/// A streamed SOG with errors of levels, as `binosplat levels` makes it. A thread of its own reads files; all
/// else happens in calls. Call everything from the thread where the context is current that its renderer was
/// made in, and destroy it there.
class SplatStream {
 public:
  /// Opens the files and reads the coarsest levels. Throws Error(bad_input) for what is no such model.
  explicit SplatStream(const std::filesystem::path& path, const StreamOptions& options = {});

  /// For the library's own code, which has streams open. Not null.
  explicit SplatStream(std::shared_ptr<Stream> stream);

  ~SplatStream();
  SplatStream(SplatStream&&) noexcept;
  SplatStream& operator=(SplatStream&&) noexcept;

  /// As SplatModel::placement().
  Placement placement(const glm::dvec3& origin = glm::dvec3(0.0), double units_per_metre = 1.0) const;

  /// To be called before each frame, with that frame's views. Within about `ms` it uploads what the thread
  /// has read, or draws one view of a visibility pass, by which the thread chooses what it reads next; the
  /// GPU's time is counted in. While views move, half of them is looked at where they will be in half a
  /// second. Once they rest and the model has what they need, one call takes longer: it measures what the
  /// levels truly lose. Give a head at 90 frames a second 2.5 ms at least, and 6 where there is time. Returns
  /// whether the model has changed. Throws Error: bad_input as Renderer::submit() does, between submit() and
  /// finish(), before a renderer was made of it, and where a file has become unreadable; out_of_memory.
  bool begin_frame(std::span<const View> views, const Placement& placement, const Settings& settings,
                   double ms);

  /// As SplatModel::bounds(), of the levels that it has now.
  Bounds bounds() const;

  /// Whether the model has all that the views of the last begin_frame() need.
  bool settled() const;

  /// Gaussians that the model has now.
  std::size_t count() const;

  /// The PSNR in dB of the views against the finest levels as it is predicted for the levels that the model
  /// has now. None until something was measured, and none of a model of at most 2^19 Gaussians, which is
  /// drawn whole as soon as it is read.
  std::optional<double> quality() const;

 private:
  friend class Renderer;
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace binosplat
