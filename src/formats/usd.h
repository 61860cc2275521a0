#pragma once
// OpenUSD's text files (.usda, or a .usdz archive of one) with Gaussians: prims of UsdVol's schema
// ParticleField3DGaussianSplat (OpenUSD 26.03), and ParticleField with the kernel of a Gaussian ellipsoid or
// of a flat Gaussian (a surflet), as 3DGRUT exports them. Frame: OpenUSD's, by its upAxis (RUB or RFU).

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "scene/model.h"

namespace binosplat {

/// Reads the Gaussians of all prims that are defined, active, visible and not guides; proxies count only if
/// no prim has the purpose `render`. They are mapped by the transforms of the prims above (xformOp, all kinds
/// that do not depend on time). Throws Error naming the line if something is damaged, missing, cannot be
/// drawn, or exists only as time samples. References and variants are not resolved: the error (or a warning,
/// if there are other Gaussians) names the command that does it.
Model load_usda(const std::filesystem::path& path, std::string_view text);

/// Returns the units per metre of a scene, if the file at `path` is one and has metersPerUnit.
std::optional<double> usd_units_per_metre(const std::filesystem::path& path);

/// Returns whether a zip archive is a .usdz, whose first file is an OpenUSD scene.
bool is_usdz(const std::filesystem::path& path, std::span<const std::byte> archive);

/// Reads the scene in the archive's first file. Throws Error as load_usda(), and for a binary scene.
Model load_usdz(const std::filesystem::path& path, std::span<const std::byte> archive);

/// Throws Error for a binary scene, with the command that converts it to text.
[[noreturn]] void refuse_usd_crate(const std::filesystem::path& path);

}  // namespace binosplat
