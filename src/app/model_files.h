#pragma once
// What sub-commands that write models share.

#include <filesystem>
#include <string>
#include <vector>

#include "formats/model_output.h"
#include "scene/model.h"
#include "study/trim.h"

namespace binosplat::app {

/// By the output's ending. Throws Error for one that names no format; it says what there is, and `hint`.
ModelFormat output_format(const std::string& output, const std::string& hint = "");

/// The file that is read where `scene` names a model, in a folder or as it stands; that name where there is
/// none.
std::filesystem::path model_file(const std::string& scene);

/// Throws Error for a Scaffold-GS model, which no file of Gaussians can hold.
void refuse_scaffold(const Model& model, const std::string& scene);

/// Writes to a file beside the output, which is never committed.
study::TrialWriter trial_writer(const std::string& output, ModelFormat format);

/// Writes a model in the axes of the format (write_model), and reads it back; a signal leaves nothing
/// half-written. Returns what the format could not keep.
std::vector<std::string> write_model_file(const std::string& output, const Model& model, ModelFormat format,
                                          int harmonic_bits);

}  // namespace binosplat::app
