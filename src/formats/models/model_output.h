#pragma once
// Writes models in the formats that other programs read.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/models/registry.h"

namespace binosplat {

/// Returns ".ply, .sog or .spz".
std::string written_endings();

/// Returns the written format of a name's ending, in any case; none for .compressed.ply, which is only read.
std::optional<ModelFormat> model_format_of(const std::filesystem::path& path);

/// Returns a model's size in a format, in bytes (FormatRow::bytes).
std::uint64_t bytes_in(ModelFormat format, std::size_t count, int degree);

/// Writes a model to `file`, which the caller commits. The model's axes must be FormatRow::axes
/// (bring_into_axes converts them). Returns a line for each property that the format loses, except
/// quantisation within the format's range.
/// - ply: INRIA's (formats/models/ply.h), all numbers as floats: a model from a ply is read back bit for bit.
/// - spz: version 3 within gzip (formats/models/spz.h). Harmonics of degrees 2 and 3 have `harmonic_bits`, 1
/// to 8;
///   degree 1 has one bit more, up to 8. Niantic's writer uses 4. An extension names the axes.
/// - SOG: version 2 as an archive (formats/models/sog.h), in Morton order (formats/models/morton.h).
/// Harmonics of degrees 1
///   to 3 are in a palette of at most 65,536 entries (formats/models/codebook.h).
/// Shows progress if it takes long. Throws Error if the disk is full, for models that the format cannot
/// represent, and for Scaffold-GS models, which have anchors instead of Gaussians.
std::vector<std::string> write_model(OutputFile& file, const Model& model, ModelFormat format,
                                     int harmonic_bits = 8);

/// Returns a line for each setting of the model's training that the format does not keep.
std::vector<std::string> training_losses(const Model& model, ModelFormat format);

/// Reads back the file that write_model() has written for `model`, before the caller commits it. Reading
/// exposes numbers beyond the format's range. Throws Error if the file cannot be read or has another number
/// of Gaussians. Needs as much memory as the model; if that is not available, only warns.
void read_back(OutputFile& file, const Model& model, ModelFormat format);

/// Writes a model to a path by write_model(), and commits the file once read_back() has read it.
std::vector<std::string> write_model_file(const std::filesystem::path& path, const Model& model,
                                          ModelFormat format, int harmonic_bits = 8);

}  // namespace binosplat
