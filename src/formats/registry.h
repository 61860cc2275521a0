#pragma once
// The registry of model formats: one row a format. Reading, writing, help, errors, sizes and the lists on the
// pages follow from its rows.

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

/// In the order of the rows, which is the order in which they are tried on a file.
enum class ModelFormat {
  scaffold,
  compressed_ply,
  ply,
  streamed_sog,
  openusd,
  sog,
  spz,
  gltf,
  ksplat,
  splat
};

/// A file whose format is to be found.
struct ModelBytes {
  std::filesystem::path path;
  std::span<const std::byte> bytes;
  Content content = Content::unknown;
  nlohmann::json json;  // what a JSON file holds
};

struct FormatRow {
  const char* name;     // in help, errors, and on the pages
  const char* endings;  // of its files; none where another row's files have the same
  bool (*recognises)(const ModelBytes&);
  Model (*read)(const ModelBytes&, const ModelOptions&);
  /// The files that it is read from besides the one that names them; null where there are none.
  std::vector<std::filesystem::path> (*named_by)(const ModelBytes&) = nullptr;

  /// Null where the format is not written. `harmonic_bits` are spz's. Returns what the format cannot keep.
  std::vector<std::string> (*write)(OutputFile&, const Model&, int harmonic_bits) = nullptr;
  /// Bytes of `count` Gaussians with `higher` numbers of higher harmonics each, but for the header; of spz
  /// before gzip and of SOG before WebP, each of which takes off more than a third of trained models.
  std::uint64_t (*bytes)(std::uint64_t count, std::uint64_t higher) = nullptr;
  const char* axes = "RDF";  // of what is written
};

std::span<const FormatRow> format_rows();
const FormatRow& row_of(ModelFormat format);

/// The rows that have a writer.
std::vector<ModelFormat> written_formats();

/// The word that options, reports and JSON have for a format that is written: its ending without the dot.
std::string word_of(ModelFormat format);

/// What a file is; none where no row recognises it.
const FormatRow* format_of(const ModelBytes& file);

/// The bytes of a file at `path`, with its JSON parsed. Throws Error for JSON that is damaged.
ModelBytes examine(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// The rows' names, as in "ply, SOG or spz".
std::string names_of_formats();

}  // namespace binosplat
