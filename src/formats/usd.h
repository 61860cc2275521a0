#pragma once
// OpenUSD's text files (.usda, or a .usdz archive of one) with Gaussians: prims of UsdVol's schema
// ParticleField3DGaussianSplat (OpenUSD 26.03), and ParticleField with the kernel of a Gaussian ellipsoid or
// of a flat Gaussian (a surflet), as 3DGRUT exports them. Axes: OpenUSD's, by the file's upAxis (RUB or RFU).

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "scene/model.h"

namespace binosplat {

/// Reads the Gaussians of all prims that are defined, active, visible and not guides. Reads proxies only if
/// no prim has the purpose `render`. Applies the transforms of the prims and of those above (xformOp, all
/// kinds that do not depend on time). Throws Error naming the line if something is damaged, missing, cannot
/// be drawn, or exists only as time samples. References and variants are not resolved; the error, or a
/// warning if there are other Gaussians, names the command that resolves them.
Model load_usda(const std::filesystem::path& path, std::string_view text);

/// Returns a scene's units per metre; none if the file at `path` is no scene or lacks metersPerUnit.
std::optional<double> usd_units_per_metre(const std::filesystem::path& path);

/// Returns whether a zip archive is a .usdz, whose first file is an OpenUSD scene.
bool is_usdz(const std::filesystem::path& path, std::span<const std::byte> archive);

/// Reads the scene in the archive's first file. Throws Error as load_usda(), and for a binary scene.
Model load_usdz(const std::filesystem::path& path, std::span<const std::byte> archive);

/// Throws the Error for a binary scene; the text names the command that converts the scene to text.
[[noreturn]] void refuse_usd_crate(const std::filesystem::path& path);

}  // namespace binosplat
