// load_torch_tensors(), and the zip archives that it reads networks from.

#include <algorithm>
#include <cmath>

#include "formats/containers/torch_file.h"
#include "fuzz/input.h"

namespace binosplat::fuzz {

void target(std::span<const std::byte> bytes) {
  feed(bytes, [](const std::filesystem::path& path) {
    const auto tensors = load_torch_tensors(path, 4);
    demand(tensors.size() == 4, "another number of tensors");
    for (const std::vector<float>& tensor : tensors) {
      demand(std::all_of(tensor.begin(), tensor.end(), [](float v) { return std::isfinite(v); }),
             "values that are not finite");
    }
  });
}

}  // namespace binosplat::fuzz
