#pragma once
// The words by which files say how a model is sorted and projected: those of glTF's KHR_gaussian_splatting
// and of OpenUSD's ParticleField3DGaussianSplat.

#include <string>
#include <vector>

#include "formats/json_file.h"
#include "scene/model.h"

namespace binosplat {

/// Reads "sortingMethod" (cameraDistance or zDepth) and "projection" (perspective or tangential) of an
/// object. What it does not say is taken from `unless_said`, and so, with a warning, is a word that is not
/// known.
Perspective read_perspective(const JsonValue& holder, const Perspective& unless_said = {});

/// The same of two words, "" where a file does not say; `place` is its name.
Perspective read_perspective(const std::string& place, const std::string& order,
                             const std::string& projection, const Perspective& unless_said = {});

/// Adds them to an object where they are not 3D-GS's.
void write_perspective(const Perspective& perspective, nlohmann::ordered_json& holder);

/// The same of a ply's comments: "sortingMethod: cameraDistance", "projection: tangential".
Perspective read_perspective(const std::vector<std::string>& comments);

/// Such comments as lines of a ply's header.
std::string perspective_comments(const Perspective& perspective);

}  // namespace binosplat
