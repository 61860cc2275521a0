#pragma once
// Copies pictures from the GPU, while the GPU draws the next pictures.

#include <memory>
#include <mutex>
#include <vector>

#include "base/image.h"
#include "gl/buffer.h"
#include "gl/fence.h"
#include "render/frame.h"

namespace binosplat::render {

/// Copies pictures into buffers that the CPU can read. Reuses the buffers when their Pictures are destroyed.
class ReadBack {
  struct Copy {
    explicit Copy(gl::Context& context)
        : colours(context, "colours for the CPU", gl::Buffer::Use::read),
          z_sums(context, "depths for the CPU", gl::Buffer::Use::read),
          done(context) {}

    gl::Buffer colours, z_sums;
    gl::Fence done;
  };

 public:
  explicit ReadBack(gl::Context& context) : context_(context) {}
  ReadBack(const ReadBack&) = delete;
  ReadBack& operator=(const ReadBack&) = delete;

  /// The pictures of one frame. The ReadBack must outlive them; any thread may destroy them.
  class Pictures {
   public:
    explicit Pictures(ReadBack& of);
    ~Pictures();
    Pictures(const Pictures&) = delete;
    Pictures& operator=(const Pictures&) = delete;

    /// Waits until the GPU has copied the pictures. Call it on the context's thread, before take().
    void wait() { copy_->done.wait(); }
    /// Same as Frame::read_pictures(). On any thread.
    std::vector<Picture> take() const;

   private:
    friend class ReadBack;

    ReadBack& of_;
    std::unique_ptr<Copy> copy_;
    std::vector<shared::View> views_;
    bool has_depth_ = false;
    std::vector<Picture> stood_in_;  // pictures of a stand-in for the blend, which were never on the GPU
  };

  /// Starts to copy the pictures of a drawn frame, on the context's thread. The Frame may draw its next frame
  /// at once.
  std::unique_ptr<Pictures> start(const Frame& frame);

 private:
  gl::Context& context_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Copy>> free_;
};

}  // namespace binosplat::render
