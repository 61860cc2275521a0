#pragma once
// A glTF file's JSON and the numbers in its buffers, whatever container they are in: .glb, or .gltf with
// buffers in data: URIs or in files beside it.

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/mapped_file.h"
#include "formats/json_file.h"

namespace binosplat {

/// Sizes, counts and indices beyond this are damage.
inline constexpr std::uint64_t gltf_number_most = std::uint64_t{1} << 40;

class GltfDocument {
 public:
  /// `bytes` are the file's and outlive this. Throws Error for a container or JSON that is damaged or cut
  /// short.
  GltfDocument(const std::filesystem::path& path, std::span<const std::byte> bytes);

  const JsonValue& root() const { return *root_; }

  /// The bytes of a buffer view. Throws Error naming the key where it leaves its buffer, or where that is
  /// missing, cut short, or only there compressed.
  std::span<const std::byte> view(std::size_t index);

  /// The numbers of the accessor `index`, `components` each element one after the other, integers brought to
  /// 0 to 1 or -1 to 1 where it says `normalized`; zeros where it has no view, but for those that `sparse`
  /// replaces. Throws Error naming the key where it leaves its view, or has another number of components or
  /// elements than asked for, as those have that `like` names, or a type that is not float, byte or short.
  std::vector<float> read(std::size_t index, std::size_t components, std::size_t count,
                          const char* like = "the positions");

  /// Whether any of an accessor's numbers are in the file, and not zeros because there are no others.
  bool has_numbers(std::size_t accessor) const;

  /// The files that its buffers name, whether they are there or not.
  std::vector<std::filesystem::path> files() const;

  /// Bytes of the file and of the buffers that were read so far.
  std::size_t size() const { return size_; }

  /// The number of elements of an accessor; not checked against the bytes.
  std::size_t count(std::size_t accessor) const;

 private:
  void open_binary(std::span<const std::byte> bytes);
  std::span<const std::byte> buffer(std::size_t index);
  std::span<const std::byte> bytes_of(std::size_t index, const JsonValue& buffer);
  std::vector<float> zeros(const JsonValue& accessor, std::size_t components, std::size_t count) const;
  std::vector<float> read_dense(const JsonValue& accessor, std::size_t components, std::size_t count);
  void read_sparse(const JsonValue& accessor, std::size_t components, std::vector<float>& values);

  std::filesystem::path path_;
  nlohmann::json json_;
  std::unique_ptr<JsonValue> root_;
  std::span<const std::byte> binary_;                                   // of a .glb
  std::map<std::size_t, std::vector<std::byte>> buffers_;               // of data: URIs
  std::map<std::filesystem::path, std::unique_ptr<MappedFile>> files_;  // of other URIs
  std::size_t size_;
};

}  // namespace binosplat
