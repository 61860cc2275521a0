#pragma once
// The words of files for a model's order and projection, as in glTF's KHR_gaussian_splatting and OpenUSD's
// ParticleField3DGaussianSplat.

#include <string>
#include <vector>

#include "formats/json_file.h"
#include "scene/model.h"

namespace binosplat {

/// Reads "sortingMethod" (cameraDistance or zDepth) and "projection" (perspective or tangential) of an
/// object. Missing values are those of `defaults`; so are unknown words, with a warning.
Perspective read_perspective(const JsonValue& holder, const Perspective& defaults = {});

/// The same from two words, "" if missing; `place` names them in warnings.
Perspective read_perspective(const std::string& place, const std::string& order,
                             const std::string& projection, const Perspective& defaults = {});

/// Adds them to an object if they are not 3D-GS's.
void write_perspective(const Perspective& perspective, nlohmann::ordered_json& holder);

/// The same from a ply's comments: "sortingMethod: cameraDistance", "projection: tangential".
Perspective read_perspective(const std::vector<std::string>& comments);

/// Returns such comments as lines of a ply's header.
std::string perspective_comments(const Perspective& perspective);

}  // namespace binosplat
