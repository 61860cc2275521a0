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

struct Model;  // internal

/// How to read a file, and which model of several in it.
struct ModelOptions {
  /// The level of detail of a streamed SOG; 0 is the finest. None: the finest one that has all its files.
  std::optional<int> lod = {};
  std::optional<std::size_t> appearance = {};  // index, for Scaffold-GS models; none: the first
  std::string format = {};  // "spz", ".splat", ...: reads the file as this; empty: as its content says
};

/// Gaussians in memory: each array has one element per Gaussian. The constructor of SplatModel copies them.
struct Gaussians {
  std::span<const glm::vec3> means = {};   // world units
  std::span<const glm::vec4> quats = {};   // quaternions w, x, y, z; lengths are above 0
  std::span<const glm::vec3> scales = {};  // standard deviations, world units: exp() of the trainers' values
  std::span<const float> opacities = {};   // from 0 to 1: the sigmoid of the trainers' values
  /// RGB coefficients of the spherical harmonics, the constant one first: 1, 4, 9 or 16 per Gaussian.
  std::span<const glm::vec3> sh = {};
  std::string axes = "RDF";  // directions of x, y and z: right, down, forward (COLMAP); OpenGL's are "RUB"
  bool antialiased = false;  // trained with Mip-Splatting's compensation
};

/// A box with sides along the axes of the model's world.
struct Bounds {
  glm::dvec3 low{0.0};  // world units
  glm::dvec3 high{0.0};
};

/// A model, which never changes. Copies are cheap and share the numbers. A Renderer shares them too, and may
/// outlive the model. Any thread may call these functions; they need no context.
class SplatModel {
 public:
  /// Reads a file, or a folder that holds a model. The content decides the format, never the name. The
  /// formats are INRIA's ply, PlayCanvas' compressed ply, spz, .splat, .ksplat, SOG (a folder or .sog),
  /// streamed SOG (a folder or its lod-meta.json), glTF with Gaussians, and Scaffold-GS's ply with its
  /// networks in the same folder. Removes Gaussians with numbers that are not finite, and reports their count
  /// on standard error. Reads near plane, low-pass and anti-aliasing from the file or else from the trainer's
  /// file in its folder. Reports on standard error which effects of the training are not drawn.
  /// Throws Error(bad_input) if the path holds no such model; the text describes the file.
  explicit SplatModel(const std::filesystem::path& path, const ModelOptions& options = {});

  /// Copies Gaussians from arrays. Throws Error(bad_input) for arrays of different lengths and for invalid
  /// numbers; the text names the array and the row.
  explicit SplatModel(const Gaussians& gaussians, const std::string& name = "arrays");

  /// For the library's own code, which has models in memory. `model` is not null.
  explicit SplatModel(std::shared_ptr<const Model> model);

  const std::string& name() const;  // the file's name, for messages
  std::size_t count() const;        // number of Gaussians, or of a Scaffold-GS model's anchors

  /// The 2nd to the 98th percentile of the Gaussians' positions along each axis of the world: the subject
  /// without sky and far outliers. Ignores Gaussians of opacity 0. Sorts all positions.
  Bounds bounds() const;

  /// The box around the positions of all Gaussians.
  Bounds all_bounds() const;

  /// Returns an upright placement in which an eye at `eye` (m, in the eyes' space), looking straight ahead,
  /// sees the model as `binosplat render` shows it first: a model that ends is whole in the frustum `fov`, a
  /// scene is seen from within. Finds the up direction and the floor in the model.
  Placement framing(const Fov& fov, const glm::dvec3& eye = glm::dvec3(0.0),
                    double units_per_metre = 1.0) const;

  /// Returns an upright placement of the eyes' space at `origin`, whatever axes the file has. `origin` is in
  /// the model's units, but always has x right, y down and z forward, as in COLMAP.
  Placement placement(const glm::dvec3& origin = glm::dvec3(0.0), double units_per_metre = 1.0) const;

 private:
  friend class Calibration;
  friend class Renderer;
  std::shared_ptr<const Model> model_;
};

}  // namespace binosplat
