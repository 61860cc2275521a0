#pragma once
// The words by which files keep how a model was trained (Training): sort order and projection as in
// KHR_gaussian_splatting, and binosplat's own lowPass (px^2) and nearPlane (world units).

#include <string>
#include <vector>

#include "formats/containers/json_file.h"
#include "scene/model.h"

namespace binosplat {

/// The word of "colorSpace" for linear light (Training::linear).
constexpr const char* linear_word = "lin_rec709_display";

/// Reads "sortingMethod" (cameraDistance or zDepth) and "projection" (perspective or tangential) of an
/// object. `defaults` replaces missing words and, with a warning, unknown words.
Perspective read_perspective(const JsonValue& holder, const Perspective& defaults = {});

/// Adds the words that differ from 3D-GS's to a SOG's meta.json. `flat`: all Gaussians are discs.
void write_training(const Training& training, bool flat, nlohmann::ordered_json& meta);

/// Reads the words in a ply's comments: "sortingMethod: cameraDistance", "projection: tangential".
Perspective read_perspective(const std::vector<std::string>& comments);

/// Returns the comments with these words as lines of a ply's header. Says that a model was trained without
/// anti-aliasing only if a file or an option does: else readers follow the training run beside the ply.
std::string training_comments(const Training& training, bool flat);

}  // namespace binosplat
