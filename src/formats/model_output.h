#pragma once
// Models as files, in the formats that other programs read.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/registry.h"

namespace binosplat {

/// ".ply, .sog or .spz".
std::string written_endings();

/// The format that is written, by the end of a name, in any case; none for .compressed.ply, which is read and
/// not written.
std::optional<ModelFormat> model_format_of(const std::filesystem::path& path);

/// Bytes that a model takes in a format (FormatRow::bytes).
std::uint64_t bytes_in(ModelFormat format, std::size_t count, int degree);

/// Writes a model whose axes are FormatRow::axes (bring_into_axes does that) to `file`, which the caller
/// commits. Returns what the format could not keep, a line each: quantisation within its range, which the
/// format is for, is none of it.
///  - ply: INRIA's (formats/ply.h), all numbers as floats: a model that came from a ply reads back the same
///    to the bit.
///  - spz: version 3 within gzip (formats/spz.h). `harmonic_bits`, 1 to 8, are those of a coefficient of
///    degrees 2 and 3; degree 1 has one more where 8 leave it. Niantic's own writer takes 4. An extension
///    names the axes.
///  - SOG: version 2 as an archive (formats/sog.h), in Morton order (formats/morton.h); harmonics of degrees
///  1 to 3 from a palette
///    of 65,536 at most (formats/codebook.h).
/// Progress is shown where it takes long. Throws Error where the disk is full, for a model that the format
/// cannot hold at all, and for a Scaffold-GS model, whose Gaussians no file has.
std::vector<std::string> write_model(OutputFile& file, const Model& model, ModelFormat format,
                                     int harmonic_bits = 8);

/// Of that, what is said of the model's low-pass: nothing where the format keeps it.
std::vector<std::string> kernel_loss(const Model& model, ModelFormat format);

/// Reads back what write_model() wrote of `model`, before it is committed: numbers that a format has no room
/// for show here. Throws Error where the file cannot be read or has another count; takes the model's memory
/// once more, and only warns where that is not there.
void read_back(OutputFile& file, const Model& model, ModelFormat format);

}  // namespace binosplat
