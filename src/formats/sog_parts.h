#pragma once
// The SOGs of a streamed one.

#include <filesystem>
#include <string>
#include <vector>

#include "formats/sog_levels.h"
#include "formats/sog_source.h"

namespace binosplat {

/// In place of the number of a level (SogLevels::taken).
inline constexpr int no_level = -1;

/// By its meta.json, or a .sog archive. Throws Error as load_sog does.
SogSource open_part(const std::filesystem::path& path);

std::vector<SogSource::Range> ranges_of(const SogLevels::TakenOfFile& taken);

/// Throws Error if no leaf has a level that is there.
void check_leaves(const std::filesystem::path& path, const std::vector<LodChunk>& leaves);

/// The format of a model whose levels are chosen.
std::string format_of_chosen(const SogLevels& levels);

}  // namespace binosplat
