#pragma once
// A trained 3D Gaussian Splatting model (Kerbl et al. 2023) in memory, read from a file.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <binosplat/eyes.h>

namespace binosplat {

struct Model;  // the library's own

/// Which of the models in a file is meant, where it has several.
struct ModelOptions {
  /// The level of detail of a streamed SOG; 0 is the finest. Where none is named: the finest of which all
  /// files are there.
  std::optional<int> lod = {};
  std::optional<std::size_t> appearance = {};  // for Scaffold-GS models; none: the first
};

/// The Gaussians of a model in memory, an element of each array for each of them. Only read while a
/// SplatModel is made of them.
struct Gaussians {
  std::span<const glm::vec3> means = {};   // world units
  std::span<const glm::vec4> quats = {};   // quaternions w, x, y, z, of any length but 0
  std::span<const glm::vec3> scales = {};  // standard deviations, world units: exp() of what trainers store
  std::span<const float> opacities = {};   // from 0 to 1: the sigmoid of what trainers store
  /// RGB coefficients of the spherical harmonics, the constant one first: 1, 4, 9 or 16 for each Gaussian.
  std::span<const glm::vec3> sh = {};
  std::string axes = "RDF";  // where x, y and z point: right, down, forward, as COLMAP's; OpenGL's is "RUB"
  bool antialiased = false;  // trained with Mip-Splatting's compensation
};

/// A box with sides along the axes of the model's world.
struct Bounds {
  glm::dvec3 low{0.0};  // world units
  glm::dvec3 high{0.0};
};

/// A model, which never changes. Copies are cheap, and share the numbers; so does a Renderer, which may
/// outlive what it was made from. Everything here may be called from any thread, and needs no context.
class SplatModel {
 public:
  /// Reads a file, or a folder that holds a model. The content decides the format, never the name:
  /// INRIA's ply and PlayCanvas' compressed ply, spz, .splat, .ksplat, SOG (a folder or .sog), streamed SOG
  /// (by a lod-meta.json), glTF and OpenUSD's text with Gaussians, and Scaffold-GS's ply with the networks
  /// beside it. Gaussians whose numbers are not finite are left out, and counted on standard error. The
  /// anti-aliasing and the low-pass are those of the file, or else of the trainer's file beside it; standard
  /// error has what the training did and is not drawn. Throws Error(bad_input) for a path that is no such
  /// model; the text says what it looks like instead.
  explicit SplatModel(const std::filesystem::path& path, const ModelOptions& options = {});

  /// Copies Gaussians from arrays. Throws Error(bad_input), naming the array and the row, for arrays of
  /// different lengths, and numbers that are no Gaussian.
  explicit SplatModel(const Gaussians& gaussians, const std::string& name = "arrays");

  /// For the library's own code, which has models in memory. Not null.
  explicit SplatModel(std::shared_ptr<const Model> model);

  const std::string& name() const;  // for people: that of the file
  std::size_t count() const;        // Gaussians; of a Scaffold-GS model anchors

  /// The 2nd to the 98th percentile of the Gaussians' positions along each axis of the world, those left
  /// aside that are wholly transparent: what the model is about, in spite of far outliers. Takes as long as
  /// sorting the positions.
  Bounds bounds() const;

  /// Places the eyes' space at a point of the world in which the model's cameras live (x right, y down, z
  /// forward, as COLMAP leaves it), upright as they were, whichever way the axes of the file point. `origin`
  /// is in units of the world.
  Placement placement(const glm::dvec3& origin = glm::dvec3(0.0), double units_per_metre = 1.0) const;

 private:
  friend class Calibration;
  friend class Renderer;
  std::shared_ptr<const Model> model_;
};

}  // namespace binosplat
