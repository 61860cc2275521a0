// SOG without an archive, so that checksums do not stop the fuzzer. The input is meta.json up to the first
// zero byte, then its images: the first letter of the name, the length (2 bytes, little-endian), the bytes.

#include <map>

#include "formats/containers/content.h"
#include "formats/models/sog_source.h"
#include "fuzz/input.h"
#include "fuzz/model_check.h"

namespace binosplat::fuzz {

namespace {

using Files = std::map<char, std::vector<std::byte>>;

Files split(std::span<const std::byte> bytes) {
  Files files;
  while (bytes.size() > 3) {
    const auto length = static_cast<std::size_t>(bytes[1]) + 256 * static_cast<std::size_t>(bytes[2]);
    const auto data = bytes.subspan(3, std::min(length, bytes.size() - 3));
    files[static_cast<char>(bytes[0])].assign(data.begin(), data.end());
    bytes = bytes.subspan(3 + data.size());
  }
  return files;
}

void load(const std::string& path, std::span<const std::byte> bytes) {
  const std::string_view meta = as_text(bytes).substr(0, as_text(bytes).find('\0'));
  const Files files = split(bytes.subspan(std::min(meta.size() + 1, bytes.size())));
  const SogSource source(path, parse_json(path, meta), [&](const std::string& name) {
    const auto found = files.find(name[0]);
    if (found == files.end()) fail("{}: there is no {}", path, name);
    return found->second;
  });
  Model model;
  model.degree = source.degree();
  model.resize(source.count());
  std::vector<std::uint8_t> kept(source.count());
  const SogSource::Range all{0, source.count(), 0};
  source.decode(model, {&all, 1}, kept);
  keep_only(model, kept);
  if (model.count() > 0) check(model);
}

}  // namespace

void target(std::span<const std::byte> bytes) {
  feed(bytes, [&](const std::filesystem::path& path) { load(path.string(), bytes); });
}

}  // namespace binosplat::fuzz
