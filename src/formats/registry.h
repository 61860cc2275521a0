#pragma once
// The registry of model formats, with a row for each format. Reading, writing, help, errors, sizes and the
// lists in the documentation use its rows.

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/output_file.h"
#include "formats/content.h"
#include "scene/model.h"

namespace binosplat {

/// The model formats, in the order of the rows. Readers try formats on a file in this order.
enum class ModelFormat { scaffold, compressed_ply, ply, streamed_sog, sog, spz, gltf, ksplat, splat };

/// The contents of a file whose format is to be recognised.
struct ModelBytes {
  std::filesystem::path path;
  std::span<const std::byte> bytes;
  Content content = Content::unknown;
  nlohmann::json json;  // parsed contents of a JSON file
};

struct FormatRow {
  const char* name;     // in help, errors and the documentation
  const char* endings;  // of the format's files; "" if another row has the same endings
  bool (*recognises)(const ModelBytes&);
  Model (*read)(const ModelBytes&, const ModelOptions&);
  /// Returns the files that a model's file names. Null if files of this format never name others.
  std::vector<std::filesystem::path> (*named_by)(const ModelBytes&) = nullptr;

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

/// Returns the row that recognises a file, or null.
const FormatRow* format_of(const ModelBytes& file);

/// Returns the bytes of a file at `path`, with parsed JSON. Throws Error for damaged JSON.
ModelBytes examine(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Returns the rows' names, as in "ply, SOG or spz".
std::string names_of_formats();

}  // namespace binosplat
