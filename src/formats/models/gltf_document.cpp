#include "formats/models/gltf_document.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <type_traits>

#include "base/path_questions.h"
#include "formats/containers/bytes.h"
#include "formats/containers/size_limits.h"
#include "formats/containers/uri.h"

namespace binosplat {

namespace {

constexpr std::uint32_t json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;

/// Reads a number of type T. Normalized integers become fractions of the type's maximum.
template <typename T>
float load_as(const std::byte* at, bool normalized) {
  const auto value = static_cast<float>(load_number<T>(at));
  if (std::is_floating_point_v<T> || !normalized) return value;
  return std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}

/// A number type that Gaussians may have, by glTF's code (componentType).
struct Component {
  int type;
  std::size_t bytes;
  float (*load)(const std::byte* at, bool normalized);
};
constexpr Component gltf_components[] = {{5120, 1, load_as<std::int8_t>},
                                         {5121, 1, load_as<std::uint8_t>},
                                         {5122, 2, load_as<std::int16_t>},
                                         {5123, 2, load_as<std::uint16_t>},
                                         {5126, 4, load_as<float>}};

const Component& component_of(const JsonValue& holder) {
  const JsonValue type = holder.at("componentType");
  const auto* const found =
      std::ranges::find(gltf_components, static_cast<int>(type.whole(65535)), &Component::type);
  if (found == std::end(gltf_components))
    type.fail_here("{} cannot be read: expected floats, bytes or shorts", type.whole(65535));
  return *found;
}

constexpr const char* meshopt_names[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

/// Returns whether a buffer is a placeholder for a compressed buffer.
bool is_placeholder(const JsonValue& buffer) {
  return std::any_of(std::begin(meshopt_names), std::end(meshopt_names), [&](const char* name) {
    const auto extension = extension_of(buffer, name);
    return extension && extension->has("fallback");
  });
}

bool is_normalized(const JsonValue& accessor) {
  return accessor.has("normalized") && accessor.at("normalized").value() == true;
}

std::size_t optional_size(const JsonValue& value, const char* key) {
  return value.has(key) ? value.at(key).whole(max_gltf_number) : 0;
}

}  // namespace

std::optional<JsonValue> extension_of(const JsonValue& holder, const char* name) {
  return holder.has("extensions") ? holder.at("extensions").find(name) : std::nullopt;
}

GltfDocument::GltfDocument(const OpenedFile& file) : path_(file.path), size_(file.bytes().size()) {
  const bool is_binary = file.content == Content::glb;
  if (is_binary) open_binary(file.bytes());
  root_ = std::make_unique<JsonValue>(path_.string(), is_binary ? json_ : file.json());
}

void GltfDocument::open_binary(std::span<const std::byte> bytes) {
  const std::string name = path_.string();
  if (bytes.size() < 20)
    fail("{} is cut short: a .glb begins with 20 bytes, and {} are there", name, bytes.size());
  const auto version = load_number<std::uint32_t>(&bytes[4]), length = load_number<std::uint32_t>(&bytes[8]);
  if (version != 2) fail("{}: unknown glTF version {}: expected 2", name, version);
  if (length > bytes.size()) {
    fail("{} is cut short: its header (byte 8) says {} bytes, and it has {}; fetch or export it again", name,
         length, bytes.size());
  }
  if (length < 20) fail("{}: its header (byte 8) says {} bytes, but a .glb has at least 20", name, length);
  const auto chunks = bytes.first(length);
  const auto json_length = load_number<std::uint32_t>(&chunks[12]);
  if (load_number<std::uint32_t>(&chunks[16]) != json_chunk || json_length % 4 != 0 ||
      json_length > chunks.size() - 20) {
    fail(
        "{}: the first chunk is not JSON, or exceeds the file, or its length ({}, at byte 12) is not a "
        "multiple of 4",
        name, json_length);
  }
  // The format pads the JSON with blanks, but some programs pad it with zero bytes.
  std::string_view json = as_text(chunks.subspan(20, json_length));
  while (json.ends_with('\0')) json.remove_suffix(1);
  json_ = parse_json(name, json);
  // The format requires readers to skip chunks of other types.
  for (auto rest = chunks.subspan(20 + json_length); rest.size() >= 8;) {
    const std::size_t size = load_number<std::uint32_t>(rest.data());
    const bool is_binary = load_number<std::uint32_t>(&rest[4]) == binary_chunk;
    rest = rest.subspan(8);
    if (size > rest.size()) {
      fail("{} is cut short: its {}chunk has {} bytes, and {} are there", name, is_binary ? "binary " : "",
           size, rest.size());
    }
    if (is_binary) {
      binary_ = rest.first(size);
      return;
    }
    rest = rest.subspan(size);
  }
}

std::span<const std::byte> GltfDocument::buffer(std::size_t index) {
  const JsonValue buffer = root().at("buffers").at(index);
  const auto bytes = bytes_of(index, buffer);
  if (const std::size_t length = optional_size(buffer, "byteLength"); length > bytes.size()) {
    buffer.fail_here(
        "it is cut short: its byteLength is {}, and {} bytes are there; fetch or export it again", length,
        bytes.size());
  }
  return bytes;
}

std::span<const std::byte> GltfDocument::bytes_of(std::size_t index, const JsonValue& buffer) {
  if (!buffer.has("uri")) {
    if (is_placeholder(buffer))
      buffer.fail_here("it is compressed with meshopt, which cannot be read; export the model without");
    if (index != 0 || binary_.empty()) buffer.fail_here("it has no uri, and the file no binary chunk for it");
    return binary_;
  }
  // Decodes a URI once, because it may hold megabytes, and any number of views may use it.
  if (const auto known = buffers_.find(index); known != buffers_.end()) return known->second;
  const JsonValue uri = buffer.at("uri");
  if (has_data(uri)) return buffers_[index] = data_in(uri);
  const std::filesystem::path file = file_named(path_.parent_path(), uri);
  if (!is_file(file)) uri.fail_here("{} is missing; fetch or export it again", file);
  // Buffers may share a file, which is mapped once.
  auto& known = files_[file];
  if (!known) {
    known = std::make_unique<MappedFile>(file);
    size_ += known->bytes().size();
  }
  return known->bytes();
}

std::vector<std::filesystem::path> GltfDocument::files() const {
  std::vector<std::filesystem::path> files;
  if (!root().has("buffers")) return files;
  for (const JsonValue& buffer : root().at("buffers").items()) {
    if (buffer.has("uri") && !has_data(buffer.at("uri")))
      files.push_back(file_named(path_.parent_path(), buffer.at("uri")));
  }
  return files;
}

std::span<const std::byte> GltfDocument::view(std::size_t index) {
  // If a view's meshopt compression is optional, the file also has uncompressed bytes, which are read here.
  const JsonValue view = root().at("bufferViews").at(index);
  const auto bytes = buffer(view.at("buffer").whole(max_gltf_number));
  const std::size_t offset = optional_size(view, "byteOffset"),
                    length = view.at("byteLength").whole(max_gltf_number);
  if (offset > bytes.size() || length > bytes.size() - offset)
    view.fail_here("{} bytes from byte {} on exceed its buffer of {}", length, offset, bytes.size());
  return bytes.subspan(offset, length);
}

std::size_t GltfDocument::count(std::size_t accessor) const {
  return root().at("accessors").at(accessor).at("count").whole(max_gltf_number);
}

bool GltfDocument::has_numbers(std::size_t accessor) const {
  const JsonValue value = root().at("accessors").at(accessor);
  return value.has("bufferView") || value.has("sparse");
}

std::vector<float> GltfDocument::read(std::size_t index, std::size_t components, std::size_t count,
                                      const char* like) {
  const JsonValue accessor = root().at("accessors").at(index);
  constexpr const char* types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  if (accessor.at("type").text() != types[components])
    accessor.at("type").fail_here("expected {}, found {}", types[components], accessor.at("type").text());
  if (accessor.at("count").whole(max_gltf_number) != count)
    accessor.at("count").fail_here("expected {}, the count of {}", count, like);
  component_of(accessor);  // throws for an unreadable type
  std::vector<float> values = accessor.has("bufferView") ? read_dense(accessor, components, count)
                                                         : zeros(accessor, components, count);
  if (accessor.has("sparse")) read_sparse(accessor, components, values);
  return values;
}

std::vector<float> GltfDocument::zeros(const JsonValue& accessor, std::size_t components,
                                       std::size_t count) const {
  if (count > max_gaussians_in(size()))
    accessor.at("count").fail_here("{} elements without a bufferView, in a file of {} bytes{}", count, size(),
                                   more_may_be_allowed);
  return std::vector<float>(count * components);
}

std::vector<float> GltfDocument::read_dense(const JsonValue& accessor, std::size_t components,
                                            std::size_t count) {
  const Component& component = component_of(accessor);
  const std::size_t size = components * component.bytes;
  const std::size_t view_index = accessor.at("bufferView").whole(max_gltf_number);
  const auto bytes = view(view_index);
  std::size_t stride = optional_size(root().at("bufferViews").at(view_index), "byteStride");
  if (stride == 0) stride = size;
  const std::size_t offset = optional_size(accessor, "byteOffset");
  if (stride < size || offset > bytes.size() || count > (bytes.size() - offset) / stride + 1 ||
      (count > 0 && (count - 1) * stride + size > bytes.size() - offset)) {
    accessor.fail_here("{} elements of {} bytes, stride {}, from byte {} exceed the buffer view of {} bytes",
                       count, size, stride, offset, bytes.size());
  }
  const bool normalized = is_normalized(accessor);
  std::vector<float> values(count * components);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < components; ++c)
      values[i * components + c] =
          component.load(&bytes[offset + i * stride + c * component.bytes], normalized);
  }
  return values;
}

void GltfDocument::read_sparse(const JsonValue& accessor, std::size_t components,
                               std::vector<float>& values) {
  const JsonValue sparse = accessor.at("sparse");
  const std::size_t count = sparse.at("count").whole(max_gltf_number);
  if (count > values.size() / components)
    sparse.fail_here("it replaces {} elements of {}", count, values.size() / components);
  const JsonValue indices = sparse.at("indices"), replaced = sparse.at("values");
  const auto index_type = indices.at("componentType").whole(65535);
  const std::size_t index_size = index_type == 5125 ? 4 : index_type == 5123 ? 2 : index_type == 5121 ? 1 : 0;
  if (index_size == 0) indices.at("componentType").fail_here("{} is not a type of an index", index_type);
  const Component& component = component_of(accessor);
  const std::size_t element = components * component.bytes;
  const auto index_bytes = view(indices.at("bufferView").whole(max_gltf_number));
  const auto value_bytes = view(replaced.at("bufferView").whole(max_gltf_number));
  const std::size_t index_at = optional_size(indices, "byteOffset"),
                    value_at = optional_size(replaced, "byteOffset");
  if (index_at > index_bytes.size() || count > (index_bytes.size() - index_at) / index_size ||
      value_at > value_bytes.size() || count > (value_bytes.size() - value_at) / element) {
    sparse.fail_here("{} elements exceed their views", count);
  }
  const bool normalized = is_normalized(accessor);
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t i = 0;
    std::memcpy(&i, &index_bytes[index_at + k * index_size], index_size);  // little-endian
    if (i >= values.size() / components)
      sparse.fail_here("element {} is replaced, but the accessor has only {}", i, values.size() / components);
    for (std::size_t c = 0; c < components; ++c)
      values[i * components + c] =
          component.load(&value_bytes[value_at + k * element + c * component.bytes], normalized);
  }
}

}  // namespace binosplat
