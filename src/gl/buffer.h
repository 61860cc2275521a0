#pragma once
// Buffers on the GPU.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gl/context.h"

namespace binosplat::gl {

/// A buffer for storage or uniform blocks, with a name for debuggers and error texts. It is empty until
/// reserved, and its contents are undefined until written.
class Buffer {
 public:
  /// `written` and `read` buffers stay mapped: the CPU writes through writable(), or reads through mapped().
  enum class Use { on_gpu, written, read };
  Buffer(Context& context, std::string label, Use use = Use::on_gpu);
  ~Buffer();
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  /// Makes room for at least `bytes`. If the buffer grows, its contents are lost. Throws Error(out_of_memory)
  /// if the GPU has no room, or if shaders on this driver cannot address the whole buffer.
  void reserve(std::int64_t bytes);

  /// Makes room for at least `bytes` and keeps the contents. Throws as reserve() does.
  void grow(std::int64_t bytes);

  /// Makes room, and writes from the start. Commands that read this buffer must be complete: with NVIDIA's
  /// driver 580 an upload may overtake such commands, and a picture shows lines of the next picture.
  template <typename T>
  void upload(std::span<const T> data) {
    reserve(static_cast<std::int64_t>(data.size_bytes()));
    write(data.data(), static_cast<std::int64_t>(data.size_bytes()));
  }
  template <typename T>
  void upload(const std::vector<T>& data) {
    upload(std::span<const T>(data));
  }

  /// Makes room for `count` elements and returns the mapped memory, which is for writing only. Saves
  /// upload()'s copy in the driver. Earlier commands that read this buffer must be complete (gl/fence.h).
  template <typename T>
  std::span<T> writable(std::size_t count) {
    reserve(static_cast<std::int64_t>(count * sizeof(T)));
    return {static_cast<T*>(mapped_), count};
  }

  /// The elements that copy() has written. The copy must be complete (gl/fence.h). Any thread may read.
  template <typename T>
  std::span<const T> mapped(std::size_t count, std::size_t first = 0) const {
    return std::span(static_cast<const T*>(mapped_) + first, count);
  }

  /// Writes elements from element `first` on, within the reserved size. All others keep their values.
  template <typename T>
  void upload_part(std::span<const T> data, std::size_t first) {
    write(data.data(), static_cast<std::int64_t>(data.size_bytes()),
          static_cast<std::int64_t>(first * sizeof(T)));
  }

  /// Copies `bytes` bytes from byte `first` of `from` to byte `at` of this buffer, within the reserved size.
  void copy(const Buffer& from, std::int64_t first, std::int64_t bytes, std::int64_t at);

  void reserve_zeros(std::int64_t bytes);

  /// Reads `count` elements from element `first` on, after all earlier commands.
  template <typename T>
  std::vector<T> read(std::size_t count, std::size_t first = 0) const {
    std::vector<T> out(count);
    read_bytes(out.data(), static_cast<std::int64_t>(first * sizeof(T)),
               static_cast<std::int64_t>(count * sizeof(T)));
    return out;
  }

  std::uint32_t id() const { return id_; }
  std::int64_t bytes() const { return bytes_; }
  const std::string& label() const { return label_; }

 private:
  void release();
  void check_reach(std::int64_t bytes) const;
  void allocate(std::int64_t bytes);
  void write(const void* data, std::int64_t bytes, std::int64_t offset = 0);
  void read_bytes(void* out, std::int64_t offset, std::int64_t bytes) const;

  Context& context_;
  std::string label_;
  Use use_;
  std::uint32_t id_ = 0;
  void* mapped_ = nullptr;
  std::int64_t bytes_ = 0;
};

}  // namespace binosplat::gl
