// load_model() with the corpus and the dictionary of each format in turn.

#include "formats/models/model_file.h"
#include "fuzz/input.h"
#include "fuzz/model_check.h"

namespace binosplat::fuzz {

void target(std::span<const std::byte> bytes) {
  feed(bytes, [](const std::filesystem::path& path) { check(load_model(path)); });
}

}  // namespace binosplat::fuzz
