#pragma once
// The words of a model's sort order and projection, as in KHR_gaussian_splatting.

#include <string>
#include <vector>

#include "formats/json_file.h"
#include "scene/model.h"

namespace binosplat {

/// Reads "sortingMethod" (cameraDistance or zDepth) and "projection" (perspective or tangential) of an
/// object. `defaults` replaces missing words and, with a warning, unknown words.
Perspective read_perspective(const JsonValue& holder, const Perspective& defaults = {});

/// Adds the words that differ from 3D-GS's (zDepth, perspective) to an object.
void write_perspective(const Perspective& perspective, nlohmann::ordered_json& holder);

/// Reads the words in a ply's comments: "sortingMethod: cameraDistance", "projection: tangential".
Perspective read_perspective(const std::vector<std::string>& comments);

/// Returns the comments with these words as lines of a ply's header.
std::string perspective_comments(const Perspective& perspective);

}  // namespace binosplat
