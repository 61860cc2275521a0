#pragma once
// Damages copies of good files, for tests of how readers refuse broken files.

#include <webp/encode.h>
#include <zlib.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "support/errors.h"
#include "support/program.h"
#include "support/zip.h"

namespace binosplat::test {

/// A copy of a good file or folder in a temporary folder, to be damaged there. `read` and `write` take paths
/// below a copied folder; for a copied file they take no path.
class Copy {
 public:
  explicit Copy(const std::filesystem::path& original) : name_(original.filename().string()) {
    namespace fs = std::filesystem;
    fs::copy(original, path(), fs::copy_options::recursive);
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      fs::permissions(entry.path(), fs::perms::owner_all);
  }

  std::filesystem::path path() const { return folder_ / name_; }
  std::string read(const std::string& below = "") const {
    return read_text(below.empty() ? path() : path() / below);
  }
  void write(const std::string& text, const std::string& below = "") const {
    write_text(below.empty() ? path() : path() / below, text);
  }

  /// Edits a JSON file of the copy with `edit`.
  template <typename Edit>
  void edit(const std::string& below, const Edit& edit) const {
    nlohmann::json json = nlohmann::json::parse(read(below));
    edit(json);
    write(json.dump(), below);
  }

 private:
  TempFolder folder_;
  std::string name_;
};

/// A damaged file, and texts that its error must contain.
struct BrokenFile {
  std::string bytes;
  std::vector<std::string> said;
};

/// Expects that attempt(bytes) fails for each file, with an error that contains its texts and the file's
/// `name`.
template <typename Attempt>
void expect_refusals(const std::string& name, const std::vector<BrokenFile>& files, const Attempt& attempt) {
  for (const BrokenFile& file : files) {
    std::vector<std::string> said = file.said;
    said.push_back(name);
    EXPECT_TRUE(fails_saying([&] { attempt(file.bytes); }, said));
  }
}

/// Returns `text` with the first `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

/// Returns `text` with `bytes` overwriting those at `at`.
inline std::string patched(std::string text, std::size_t at, const std::string& bytes) {
  if (at + bytes.size() > text.size()) throw std::out_of_range("patch beyond the end");
  return text.replace(at, bytes.size(), bytes);
}

/// Returns the JSON with the value at `pointer` replaced, or removed if `value` is null.
inline std::string with_value(nlohmann::json good, const std::string& pointer, const nlohmann::json& value) {
  if (value.is_null()) return good.patch({{{"op", "remove"}, {"path", pointer}}}).dump();
  good[nlohmann::json::json_pointer(pointer)] = value;
  return good.dump();
}

/// Returns the bytes of a number in little-endian order.
template <typename T>
std::string little(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof(T)};
}

/// Encodes RGBA texels as a WebP picture; `lossless` keeps them exactly.
inline std::string webp(int width, int height, const std::vector<std::uint8_t>& texels,
                        bool lossless = true) {
  WebPConfig config;
  WebPPicture picture;
  WebPMemoryWriter writer;
  WebPConfigInit(&config);
  WebPPictureInit(&picture);
  WebPMemoryWriterInit(&writer);
  config.lossless = lossless ? 1 : 0;
  config.exact = 1;
  picture.use_argb = 1;
  picture.width = width;
  picture.height = height;
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  const bool good =
      WebPPictureImportRGBA(&picture, texels.data(), 4 * width) != 0 && WebPEncode(&config, &picture) != 0;
  std::string bytes(reinterpret_cast<const char*>(writer.mem), writer.size);
  WebPMemoryWriterClear(&writer);
  WebPPictureFree(&picture);
  if (!good) throw std::runtime_error("no WebP");
  return bytes;
}

/// Compresses bytes with gzip.
inline std::string gzipped(const std::string& bytes) {
  z_stream stream = {};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::runtime_error("no gzip");
  }
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

}  // namespace binosplat::test
