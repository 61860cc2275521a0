#include "formats/models/registry.h"

#include <algorithm>
#include <iterator>

#include "base/text.h"
#include "formats/models/compressed_ply.h"
#include "formats/models/files_of_model.h"
#include "formats/models/gltf.h"
#include "formats/models/ksplat.h"
#include "formats/models/model_writers.h"
#include "formats/models/ply.h"
#include "formats/models/scaffold_file.h"
#include "formats/models/sog.h"
#include "formats/models/splat.h"
#include "formats/models/spz.h"
#include "formats/models/streamed_sog.h"

namespace binosplat {

namespace {

using Files = std::vector<std::filesystem::path>;

bool is_ply_with(const OpenedFile& f, bool (*has)(const PlyHeader&)) {
  return f.content == Content::ply && has(f.ply());
}

bool is_json_with(const OpenedFile& f, bool (*is)(const nlohmann::json&)) {
  return f.content == Content::json && is(f.json());
}

/// Recognises a format that has no magic number by the file's values. If no other content was recognised,
/// also accepts a file by its name, so that the reader can explain the fault of a damaged file.
bool is_unmarked(const OpenedFile& f, const char* ending, bool (*is)(std::span<const std::byte>)) {
  return f.content == Content::unknown && (is(f.bytes()) || lowered_ending(f.path) == ending);
}

Model read_scaffold(const OpenedFile& f, const ModelOptions& options) {
  const std::shared_ptr<Scaffold> scaffold = load_scaffold(f);
  if (options.appearance) choose_appearance(*scaffold, *options.appearance);
  return placeholder_model(scaffold);
}

Model read_ply(const OpenedFile& f, const ModelOptions&) { return load_ply(f); }

Files files_of_levels(const OpenedFile& f) {
  const SogLevels levels(f.path, f.json());
  Files files = levels.files();
  if (levels.environment()) files.push_back(*levels.environment());
  return files;
}

constexpr FormatRow rows[] = {
    {"Scaffold-GS", "", [](const OpenedFile& f) { return is_ply_with(f, is_scaffold); }, read_scaffold,
     [](const OpenedFile& f) { return files_of_networks(f.path); }},
    {"compressed ply", "", [](const OpenedFile& f) { return is_ply_with(f, is_compressed_ply); }, read_ply},
    {"ply", ".ply", [](const OpenedFile& f) { return f.content == Content::ply; }, read_ply, nullptr,
     [](OutputFile& file, const Model& model, int) { return write_ply(file, model); },
     [](std::uint64_t count, std::uint64_t higher) { return count * 4 * (17 + higher); }},
    {"streamed SOG", "", [](const OpenedFile& f) { return is_json_with(f, is_sog_levels); },
     [](const OpenedFile& f, const ModelOptions& options) {
       return load_streamed_sog(f.path, f.json(), options.lod);
     },
     files_of_levels},
    {"SOG", ".sog",
     [](const OpenedFile& f) { return is_json_with(f, is_sog_meta) || f.content == Content::zip; },
     [](const OpenedFile& f, const ModelOptions&) { return load_sog(f); },
     [](const OpenedFile& f) {
       return f.content == Content::zip ? Files() : pictures_of_sog(f.path, f.json());
     },
     [](OutputFile& file, const Model& model, int) { return write_sog(file, model); },
     [](std::uint64_t count, std::uint64_t higher) {
       return count * (higher > 0 ? 19 : 17) + std::min<std::uint64_t>(count, max_sog_palette) * higher;
     }},
    {"spz", ".spz",
     [](const OpenedFile& f) { return f.content == Content::gzip || f.content == Content::spz; },
     [](const OpenedFile& f, const ModelOptions&) { return load_spz(f.path.string(), f.bytes()); }, nullptr,
     write_spz, [](std::uint64_t count, std::uint64_t higher) { return count * (20 + higher); }, "RUB"},
    {"glTF", ".gltf .glb",
     [](const OpenedFile& f) { return f.content == Content::glb || is_json_with(f, is_gltf); },
     [](const OpenedFile& f, const ModelOptions&) { return load_gltf(f); }, files_of_gltf},
    {".ksplat", ".ksplat", [](const OpenedFile& f) { return is_unmarked(f, ".ksplat", is_ksplat); },
     [](const OpenedFile& f, const ModelOptions&) { return load_ksplat(f.path.string(), f.bytes()); }},
    {".splat", ".splat", [](const OpenedFile& f) { return is_unmarked(f, ".splat", is_splat); },
     [](const OpenedFile& f, const ModelOptions&) { return load_splat(f.path.string(), f.bytes()); }},
};
static_assert(std::size(rows) == static_cast<std::size_t>(ModelFormat::splat) + 1);

}  // namespace

std::span<const FormatRow> format_rows() { return rows; }

const FormatRow& row_of(ModelFormat format) { return rows[static_cast<std::size_t>(format)]; }

std::vector<ModelFormat> written_formats() {
  std::vector<ModelFormat> found;
  for (std::size_t k = 0; k < std::size(rows); ++k) {
    if (rows[k].write != nullptr) found.push_back(static_cast<ModelFormat>(k));
  }
  return found;
}

std::string word_of(ModelFormat format) { return row_of(format).endings + 1; }

const FormatRow* format_of(const OpenedFile& file) {
  const FormatRow* const found =
      std::ranges::find_if(rows, [&](const FormatRow& row) { return row.recognises(file); });
  return found == std::end(rows) ? nullptr : found;
}

const FormatRow& row_named(const std::string& name) {
  for (const FormatRow& row : rows)
    if (lowered(row.name) == lowered(name)) return row;
  fail("format {}: expected {}", name, names_of_formats());
}

std::string names_of_formats() {
  std::vector<std::string> names;
  for (const FormatRow& row : rows) names.emplace_back(row.name);
  return alternatives(names);
}

}  // namespace binosplat
