#pragma once
// The registry of model formats, with a row for each format. Reading, writing, help, errors, sizes and the
// lists in the documentation use its rows.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/output_file.h"
#include "formats/containers/opened_file.h"
#include "scene/model.h"

namespace binosplat {

/// The model formats, in the order of the rows. Readers try formats on a file in this order.
enum class ModelFormat { scaffold, compressed_ply, ply, streamed_sog, sog, spz, gltf, ksplat, splat };

struct FormatRow {
  const char* name;     // in help, errors and the documentation
  const char* endings;  // of the format's files; "" if another row has the same endings
  bool (*recognises)(const OpenedFile&);
  Model (*read)(const OpenedFile&, const ModelOptions&);
  /// Returns the files that a model's file names. Null if files of this format never name others.
  std::vector<std::filesystem::path> (*named_by)(const OpenedFile&) = nullptr;

  /// Null if the format is only read. Only spz uses `harmonic_bits`. Returns the properties that are lost.
  std::vector<std::string> (*write)(OutputFile&, const Model&, int harmonic_bits) = nullptr;
  /// Returns the bytes of `count` Gaussians with `higher` numbers of higher harmonics each, without the
  /// header, before spz's gzip and SOG's WebP, which save more than a third for trained models.
  std::uint64_t (*bytes)(std::uint64_t count, std::uint64_t higher) = nullptr;
  const char* axes = "RDF";  // of written files
};

std::span<const FormatRow> format_rows();
const FormatRow& row_of(ModelFormat format);
const FormatRow& row_named(const std::string& name);  // throws Error for an unknown name

std::vector<ModelFormat> written_formats();

/// Returns the word for a written format in options, reports and JSON: its ending without the dot.
std::string word_of(ModelFormat format);

/// Returns the row that recognises a file, or null. Throws Error for damaged JSON and damaged headers of a
/// ply.
const FormatRow* format_of(const OpenedFile& file);

/// Returns the rows' names, as in "ply, SOG or spz".
std::string names_of_formats();

}  // namespace binosplat
