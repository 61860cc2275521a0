#include "formats/containers/torch_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "base/error.h"
#include "base/mapped_file.h"
#include "formats/containers/content.h"
#include "formats/containers/zip_file.h"

namespace binosplat {

namespace {

static_assert(std::endian::native == std::endian::little, "tensors are read as they lie in the file");

constexpr std::size_t tensor_bytes_max = std::size_t{64} << 20;

// Returns ROOT of the archive, from its only entry ROOT/data.pkl.
std::string root_of(const std::filesystem::path& path, const ZipFile& archive) {
  std::string root;
  for (const std::string& name : archive.names()) {
    if (!is_below_folder(name)) {
      fail("{}: its file {} leads out of the archive; no trainer writes such a one", path,
           binosplat::quoted(name));
    }
    const std::size_t slash = name.find('/');
    if (slash != std::string::npos && name.substr(slash) == "/data.pkl") root = name.substr(0, slash);
  }
  if (!root.empty()) return root;
  fail(
      "{} is a zip archive without data.pkl: expected weights saved by torch.jit (a .pt of Scaffold-GS); it "
      "holds {}",
      path, archive.list());
}

std::vector<float> floats_of(const std::filesystem::path& path, const std::string& name,
                             const std::vector<std::byte>& bytes) {
  if (bytes.size() % sizeof(float) != 0)
    fail("{}: tensor {} has {} bytes, not a number of float32", path, binosplat::quoted(name), bytes.size());
  std::vector<float> values(bytes.size() / sizeof(float));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  const auto bad = std::find_if_not(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
  if (bad != values.end()) {
    fail("{}: value {} of tensor {} is not finite; the training went wrong or the file is damaged", path,
         bad - values.begin(), binosplat::quoted(name));
  }
  return values;
}

}  // namespace

std::vector<std::vector<float>> load_torch_tensors(const std::filesystem::path& path, std::size_t count) {
  const MappedFile file(path);
  const Content content = content_of(file.bytes());
  if (content != Content::zip)
    fail("{}: expected a zip archive, but it looks like {}", path, describe(content));
  const ZipFile archive(path.string(), file.bytes());
  const std::string root = root_of(path, archive);
  const std::string order = root + "/byteorder";
  if (archive.has(order)) {
    const std::vector<std::byte> text = archive.read(order, 64);
    if (as_text(text) != "little")
      fail("{}: its byte order is {}; expected 'little'", path, binosplat::quoted(as_text(text)));
  }
  std::vector<std::vector<float>> tensors;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = fmt::format("{}/data/{}", root, i);
    if (!archive.has(name))
      fail("{}: no tensor {}; expected {} of them ({}/data/0 and on)", path, i, count, root);
    tensors.push_back(floats_of(path, name, archive.read(name, tensor_bytes_max)));
  }
  return tensors;
}

}  // namespace binosplat
