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

/// Reads the Gaussians of all prims that are defined, active, not invisible and not guides (nor proxies,
/// where others have the purpose `render`), moved by the transforms of those above them (xformOp, of all
/// kinds that need no time). Throws Error naming the line where something is damaged, missing, cannot be
/// drawn, or is only there at points in time. What references name and variants hold is not put together: an
/// error, or a warning where there are Gaussians without it, names the command that does so.
Model load_usda(const std::filesystem::path& path, std::string_view text);

/// How many units of a scene make a metre, where the file at `path` is one and says so by its metersPerUnit.
std::optional<double> usd_units_per_metre(const std::filesystem::path& path);

/// Whether a zip archive is a .usdz, whose first file is an OpenUSD scene.
bool is_usdz(const std::filesystem::path& path, std::span<const std::byte> archive);

/// Reads the scene that is the archive's first file. Throws Error as load_usda(), and for a binary one.
Model load_usdz(const std::filesystem::path& path, std::span<const std::byte> archive);

/// Throws the Error of a binary scene, with the command that makes text of it.
[[noreturn]] void refuse_usd_crate(const std::filesystem::path& path);

}  // namespace binosplat
