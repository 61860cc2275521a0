#pragma once
// Videos through an installed ffmpeg, which reads pictures from its standard input.

#include <sys/types.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/image.h"
#include "base/output_file.h"
#include "shared/axes.h"

namespace binosplat::app {

/// Whether the ending is .mp4, .mov, .mkv or .webm, in any case.
bool is_video(const std::filesystem::path& path);

/// The ffmpeg of $PATH. If there is none, throws Error, which names the package to install, and a folder of
/// pictures as the alternative.
std::filesystem::path find_ffmpeg();

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

  /// Sends the next frame. If ffmpeg has ended, throws Error with its message.
  void add(std::string_view bytes);

  /// Waits for ffmpeg, then renames the file, so that it is complete or absent.
  void finish();

 private:
  void start(const std::vector<std::string>& arguments);
  [[noreturn]] void fail_with_what_it_said();

  std::filesystem::path target_;
  UnfinishedFile temporary_;
  std::optional<int> vr180_layout_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> said_;  // receives ffmpeg's messages
  int pictures_ = -1;                                     // socket to its standard input
  pid_t ffmpeg_ = -1;
};

}  // namespace binosplat::app
