#pragma once
// Functions that sub-commands share for writing models.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "compact/trim.h"
#include "formats/models/model_output.h"
#include "scene/model.h"

namespace binosplat::app {

/// The format by the output's ending. For an unknown ending, throws Error with the known ones and `hint`.
ModelFormat output_format(const std::string& output, const std::string& hint = "");

/// The file that `scene` names, or the only model in that folder; empty if the folder has none or several.
std::filesystem::path model_file(const std::string& scene);

/// Throws Error for a Scaffold-GS model, which no file of Gaussians can hold.
void refuse_scaffold(const Model& model, const std::string& scene);

void check_harmonic_bits(const std::optional<int>& bits, ModelFormat format);

/// Returns a function that writes candidates to a temporary file beside the output, and removes the file.
compact::TrialWriter trial_writer(const std::string& output, ModelFormat format);

/// Writes a model, whose axes must be those of the format (write_model), and reads it back. A signal leaves
/// no partial file. Returns the losses of the format.
std::vector<std::string> write_model_file(const std::string& output, const Model& model, ModelFormat format,
                                          int harmonic_bits);

}  // namespace binosplat::app
