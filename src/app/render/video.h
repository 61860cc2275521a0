#pragma once
// Videos through an installed ffmpeg, which reads pictures from its standard input.

#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/image.h"
#include "base/output_file.h"

namespace binosplat::app {

/// Whether the ending is .mp4, .mov, .mkv or .webm, in any case.
bool is_video(const std::filesystem::path& path);

/// Throws Error if no ffmpeg is installed. It names the package to install, and a folder of pictures as the
/// alternative.
void check_ffmpeg();

class Video {
 public:
  /// Starts ffmpeg: H.264 of visually lossless quality, or VP9 in .webm. Matroska files store the layout.
  /// Chroma has half resolution, as players expect, except in layouts that interleave the eyes' pixels or mix
  /// their colours. An odd width or height is extended by one pixel. With `vr180`, .mp4 and .mov are marked
  /// as half a sphere per eye.
  Video(const std::filesystem::path& path, int width, int height, double frames_a_second, int layout,
        bool vr180 = false);
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  /// A frame as RGB bytes.
  static std::string bytes_of(const Image& image);

  /// Sends the next frame. Throws Error if ffmpeg has ended; its message is on standard error.
  void add(std::string_view bytes);

  /// Waits for ffmpeg, then renames the file, so that it is complete or absent. Throws as add() does.
  void finish();

 private:
  void end_ffmpeg();

  std::filesystem::path target_;
  UnfinishedFile temporary_;
  std::optional<int> vr180_layout_;
  std::FILE* ffmpeg_ = nullptr;  // pipe to its standard input
};

}  // namespace binosplat::app
