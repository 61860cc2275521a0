#pragma once
// The JSON of a .glb or .gltf, and the numbers in its buffers: in the .glb, data: URIs or files beside it.

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "formats/containers/opened_file.h"

namespace binosplat {

/// If a size, count or index is larger, the file is damaged.
inline constexpr std::uint64_t max_gltf_number = std::uint64_t{1} << 40;

/// Returns an extension of an object, if the object has it.
std::optional<JsonValue> extension_of(const JsonValue& holder, const char* name);

class GltfDocument {
 public:
  /// `file` must outlive this object. Throws Error if it is damaged or cut short.
  explicit GltfDocument(const OpenedFile& file);

  const JsonValue& root() const { return *root_; }

  /// Returns the bytes of a buffer view. Throws Error naming the key if the view exceeds its buffer, or if
  /// the buffer is missing, cut short, or only present compressed.
  std::span<const std::byte> view(std::size_t index);

  /// Returns the numbers of the accessor `index`, which must have `count` elements of `components` numbers
  /// each. Normalized integers become 0 to 1 or -1 to 1. Without a view all numbers are zero, except those
  /// that `sparse` replaces. Throws Error naming the key if the accessor exceeds its view, has other sizes,
  /// or is not of floats, bytes or shorts. For a wrong count the text says that `like` have `count` elements.
  std::vector<float> read(std::size_t index, std::size_t components, std::size_t count,
                          const char* like = "the positions");

  /// Returns whether the file has numbers for an accessor. Accessors without a view and `sparse` are zero.
  bool has_numbers(std::size_t accessor) const;

  /// Returns the files that the buffers name, existing or not.
  std::vector<std::filesystem::path> files() const;

  /// Size of the file and of the buffers read so far.
  std::size_t size() const { return size_; }

  /// Returns an accessor's number of elements, without checking it against the file's size.
  std::size_t count(std::size_t accessor) const;

 private:
  void open_binary(std::span<const std::byte> bytes);
  std::span<const std::byte> buffer(std::size_t index);
  std::span<const std::byte> bytes_of(std::size_t index, const JsonValue& buffer);
  std::vector<float> zeros(const JsonValue& accessor, std::size_t components, std::size_t count) const;
  std::vector<float> read_dense(const JsonValue& accessor, std::size_t components, std::size_t count);
  void read_sparse(const JsonValue& accessor, std::size_t components, std::vector<float>& values);

  std::filesystem::path path_;
  nlohmann::json json_;  // of a .glb
  std::unique_ptr<JsonValue> root_;
  std::span<const std::byte> binary_;                                   // binary chunk of a .glb
  std::map<std::size_t, std::vector<std::byte>> buffers_;               // buffers from data: URIs
  std::map<std::filesystem::path, std::unique_ptr<MappedFile>> files_;  // buffers from other URIs
  std::size_t size_;
};

}  // namespace binosplat
