#pragma once
// Drawing all shots of `binosplat render`.

#include <memory>
#include <optional>
#include <vector>

#include "app/calibrated.h"
#include "app/photos.h"
#include "app/render_table.h"
#include "app/shots.h"
#include "stream/picture_stream.h"

namespace binosplat::app {

/// What is drawn, and by what.
struct Work {
  Outputs outputs;
  render::ThresholdPolicy policy;
  CameraList list;
  std::vector<Shot> shots;
  std::optional<Shot> screen;  // what tells how far the screen is, where no option does
  PhotoSource photos;
  bool heads_turn = false;
  std::unique_ptr<PictureStream> stream;  // of a model whose levels follow the shots
};

/// Draws every shot as often as asked for, and leaves the files of its last frame. All of OpenGL is called on
/// the thread that calls this: while the GPU draws a shot, it waits for the copy of the one before
/// (render/read_back.h) and hands that to threads that encode and write it. What has to be made of a frame
/// with OpenGL, as with --show, --foveate and --vr180, is read at once.
void draw_all(gl::Context& context, const Work& work, RenderReport& report);

}  // namespace binosplat::app
