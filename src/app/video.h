#pragma once
// Videos, by an ffmpeg that is there: pictures go into its standard input.

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

/// Whether a file's ending is one of .mp4, .mov, .mkv and .webm, in small or capital letters.
bool is_video(const std::filesystem::path& path);

/// ffmpeg as the shell would find it. Throws Error that says what to install, or to name a folder.
std::filesystem::path find_ffmpeg();

class Video {
 public:
  /// Starts ffmpeg: H.264 of a quality at which losses are hard to see, VP9 in .webm. Matroska's files
  /// say which layout the pictures are in. Colours are stored at half resolution, as players expect, except
  /// in layouts whose neighbouring pixels belong to different eyes. A picture of odd size is given another
  /// row or column. With `vr180` .mp4 and .mov say that each eye's picture is half a sphere.
  Video(const std::filesystem::path& path, int width, int height, double frames_a_second, int layout,
        bool vr180 = false);
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  /// The bytes of a frame, from RGB.
  static std::string bytes_of(const Image& image);

  /// The next frame. Throws Error with what ffmpeg said if it has ended.
  void add(std::string_view bytes);

  /// Waits for ffmpeg, then gives the file its name: it appears whole or not at all.
  void finish();

 private:
  void start(const std::vector<std::string>& arguments);
  [[noreturn]] void fail_with_what_it_said();

  std::filesystem::path target_;
  UnfinishedFile temporary_;
  std::optional<int> vr180_layout_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> said_;  // ffmpeg's standard error
  int pictures_ = -1;                                     // socket to its standard input
  pid_t ffmpeg_ = -1;
};

}  // namespace binosplat::app
