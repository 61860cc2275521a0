#include "gl/buffer.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/error.h"

namespace binosplat::gl {

namespace {

// Uploads and read-backs are split into pieces, which limits the memory that the driver pins. A read-back
// copies each piece to a mapped buffer: with NVIDIA's driver ten times as fast as glGetNamedBufferSubData.
constexpr std::int64_t piece_bytes = std::int64_t{64} << 20;

// At least 16 bytes: GL rejects a binding of size 0.
std::int64_t rounded(std::int64_t bytes) { return std::max<std::int64_t>((bytes + 15) / 16 * 16, 16); }

}  // namespace

Buffer::Buffer(Context& context, std::string label, Use use)
    : context_(context), label_(std::move(label)), use_(use) {}

Buffer::~Buffer() { release(); }

void Buffer::release() {
  if (id_ == 0) return;
  context_.gl().DeleteBuffers(1, &id_);
  if (use_ != Use::read) context_.count_allocation(-bytes_);
  id_ = 0;
  mapped_ = nullptr;
  bytes_ = 0;
}

void Buffer::reserve(std::int64_t bytes) {
  bytes = rounded(bytes);
  if (bytes <= bytes_) return;
  check_reach(bytes);
  release();
  allocate(bytes);
}

void Buffer::grow(std::int64_t bytes) {
  bytes = rounded(bytes);
  if (bytes <= bytes_) return;
  check_reach(bytes);
  const std::uint32_t before = std::exchange(id_, 0);
  const std::int64_t bytes_before = std::exchange(bytes_, 0);
  const Functions& gl = context_.gl();
  try {
    allocate(bytes);
  } catch (...) {
    id_ = before;
    bytes_ = bytes_before;
    throw;
  }
  if (before == 0) return;
  gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  gl.CopyNamedBufferSubData(before, id_, 0, 0, bytes_before);
  gl.Finish();  // without it, later uploads may overtake a clear (H200, driver 580)
  gl.DeleteBuffers(1, &before);
  context_.count_allocation(-bytes_before);
}

void Buffer::copy(const Buffer& from, std::int64_t first, std::int64_t bytes, std::int64_t at) {
  context_.gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  context_.gl().CopyNamedBufferSubData(from.id_, id_, first, at, bytes);
}

void Buffer::check_reach(std::int64_t bytes) const {
  const std::int64_t limit = context_.limits().storage_block_bytes;
  if (bytes <= limit) return;
  throw Error(ExitCode::out_of_memory, fmt::format("the buffer '{}' needs {} MiB; a shader on {} can address "
                                                   "{} MiB of one buffer. Use a smaller picture or model.",
                                                   label_, bytes >> 20, context_.renderer(), limit >> 20));
}

void Buffer::allocate(std::int64_t bytes) {
  const Functions& gl = context_.gl();
  constexpr GLbitfield maps = GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  const bool is_mapped = use_ != Use::on_gpu;
  const GLbitfield access = maps | (use_ == Use::read ? GL_MAP_READ_BIT : GL_MAP_WRITE_BIT);
  gl.CreateBuffers(1, &id_);
  gl.NamedBufferStorage(id_, bytes, nullptr,
                        !is_mapped          ? GL_DYNAMIC_STORAGE_BIT
                        : use_ == Use::read ? access | GL_CLIENT_STORAGE_BIT
                                            : access);
  const GLenum error = gl.GetError();
  if (error == GL_NO_ERROR && is_mapped) mapped_ = gl.MapNamedBufferRange(id_, 0, bytes, access);
  if (error != GL_NO_ERROR || (is_mapped && mapped_ == nullptr)) {
    gl.DeleteBuffers(1, &id_);
    id_ = 0;
    throw Error(
        ExitCode::out_of_memory,
        fmt::format(
            "no room on {} for {} MiB of {} ({} MiB in use by this program). Use a smaller picture or model.",
            context_.renderer(), bytes >> 20, label_, context_.allocated_bytes() >> 20));
  }
  bytes_ = bytes;
  if (use_ != Use::read) context_.count_allocation(bytes);  // `read` buffers are in the CPU's memory
  gl.ObjectLabel(GL_BUFFER, id_, -1, label_.c_str());
}

void Buffer::reserve_zeros(std::int64_t bytes) {
  reserve(bytes);
  context_.gl().MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  context_.gl().ClearNamedBufferData(id_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  context_.check("clearing " + label_);
}

void Buffer::write(const void* data, std::int64_t bytes, std::int64_t offset) {
  const auto* from = static_cast<const std::byte*>(data);
  for (std::int64_t at = 0; at < bytes; at += piece_bytes) {
    context_.gl().NamedBufferSubData(id_, offset + at, std::min(piece_bytes, bytes - at), from + at);
  }
  context_.check("uploading " + label_);
}

void Buffer::read_bytes(void* out, std::int64_t offset, std::int64_t bytes) const {
  if (bytes == 0) return;
  const std::int64_t max_piece = std::min(piece_bytes, bytes);
  Buffer staging(context_, label_ + " for the CPU", Use::read);
  staging.reserve(max_piece);
  for (std::int64_t at = 0; at < bytes; at += max_piece) {
    const std::int64_t piece = std::min(max_piece, bytes - at);
    staging.copy(*this, offset + at, piece, 0);
    context_.gl().Finish();
    std::memcpy(static_cast<std::byte*>(out) + at, staging.mapped_, static_cast<std::size_t>(piece));
  }
  context_.check("reading " + label_);
}

}  // namespace binosplat::gl
