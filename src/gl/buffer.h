#pragma once
// Storage on the GPU.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gl/context.h"

namespace binosplat::gl {

/// A buffer for storage or uniform blocks with a name for debuggers and error texts. Empty until reserved;
/// contents are undefined until written.
class Buffer {
 public:
  /// Where it is `written` or `read`, it lies where the CPU writes to it (room()) or reads it (mapped()),
  /// over and over.
  enum class Use { on_gpu, written, read };
  Buffer(Context& context, std::string label, Use use = Use::on_gpu);
  ~Buffer();
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  /// Makes room for at least `bytes`; what was in it is lost when it has to grow. Throws Error(out_of_memory)
  /// if the GPU has no room, or if a shader on this driver could not reach all of it.
  void reserve(std::int64_t bytes);

  /// Makes room for at least `bytes`; what was in it stays. Throws as reserve does.
  void grow(std::int64_t bytes);

  /// Makes room, and writes from the start. Draws that read this buffer must have run: NVIDIA's driver 580
  /// let uploads overtake them, and a picture had the lines of the next one.
  template <typename T>
  void upload(std::span<const T> data) {
    reserve(static_cast<std::int64_t>(data.size_bytes()));
    write(data.data(), static_cast<std::int64_t>(data.size_bytes()));
  }
  template <typename T>
  void upload(const std::vector<T>& data) {
    upload(std::span<const T>(data));
  }

  /// Makes room for `count` elements and says where to write them; a driver would copy what is uploaded once
  /// more. What was given to the GPU before and reads this buffer must have run (gl/fence.h). Not to be read.
  template <typename T>
  std::span<T> room(std::size_t count) {
    reserve(static_cast<std::int64_t>(count * sizeof(T)));
    return {static_cast<T*>(mapped_), count};
  }

  /// What was copied into it (copy()). The GPU must have done that (gl/fence.h); any thread may read it.
  template <typename T>
  std::span<const T> mapped(std::size_t count, std::size_t first = 0) const {
    return std::span(static_cast<const T*>(mapped_) + first, count);
  }

  /// Elements from element `first` on, within what is reserved; the others stay.
  template <typename T>
  void upload_part(std::span<const T> data, std::size_t first) {
    write(data.data(), static_cast<std::int64_t>(data.size_bytes()),
          static_cast<std::int64_t>(first * sizeof(T)));
  }

  /// `bytes` of another, from its byte `first` on, at a place within what is reserved; the rest stays.
  void copy(const Buffer& from, std::int64_t first, std::int64_t bytes, std::int64_t at);

  /// Room for so many bytes, and zeros everywhere.
  void reserve_zeros(std::int64_t bytes);

  /// `count` elements from element `first` on, after everything before it has run.
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
