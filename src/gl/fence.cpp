#include "gl/fence.h"

#include <cstdint>
#include <stdexcept>
#include <utility>

namespace binosplat::gl {

void Fence::remove() {
  if (sync_ != nullptr) context_.gl().DeleteSync(std::exchange(sync_, nullptr));
}

void Fence::set() {
  remove();
  sync_ = context_.gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

void Fence::wait() {
  if (sync_ == nullptr) return;
  constexpr std::uint64_t one_second = 1'000'000'000;
  GLenum state = GL_TIMEOUT_EXPIRED;
  while (state == GL_TIMEOUT_EXPIRED)
    state = context_.gl().ClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, one_second);
  remove();
  context_.check_alive();
  if (state == GL_WAIT_FAILED) throw std::runtime_error("the GPU was lost while drawing a frame");
}

bool Fence::is_done() {
  if (sync_ == nullptr) return true;
  return context_.gl().ClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, 0) != GL_TIMEOUT_EXPIRED;
}

}  // namespace binosplat::gl
