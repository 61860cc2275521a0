#pragma once
// What sub-commands that write models share.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/cli.h"
#include "compact/trim.h"
#include "formats/model_output.h"
#include "scene/model.h"

namespace binosplat::app {

/// By the output's ending. Throws Error for one that names no format; it says what there is, and `hint`.
ModelFormat output_format(const std::string& output, const std::string& hint = "");

/// The file that is read where `scene` names a model, in a folder or as it stands; that name where there is
/// none.
std::filesystem::path model_file(const std::string& scene);

/// Throws Error for a Scaffold-GS model, which no file of Gaussians can hold.
void refuse_scaffold(const Model& model, const std::string& scene);

/// Adds --sh-bits; `bits` must outlive the parsing. Where it is given, the format must be spz, or Error.
void add_harmonic_bits_option(CLI::App& sub, std::optional<int>& bits);
void check_harmonic_bits(const std::optional<int>& bits, ModelFormat format);

/// Reads what was written of a model, to be seen as that model is, which some formats do not tell, and from
/// its origin.
Model load_written(const std::filesystem::path& file, const Model& model);

/// Writes to a file beside the output, which is never committed.
compact::TrialWriter trial_writer(const std::string& output, ModelFormat format);

/// Writes a model in the axes of the format (write_model), and reads it back; a signal leaves nothing
/// half-written. Returns what the format could not keep.
std::vector<std::string> write_model_file(const std::string& output, const Model& model, ModelFormat format,
                                          int harmonic_bits);

}  // namespace binosplat::app
