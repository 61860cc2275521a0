#include "app/video.h"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>

#include "app/mp4_spherical.h"
#include "base/error.h"
#include "base/text.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

// Matroska's StereoMode; empty: mono, or none for this layout.
std::string stereo_mode(int layout) {
  static const std::map<int, std::string> modes = {
      {LAYOUT_PARALLEL, "left_right"},        {LAYOUT_HALF_WIDTH, "left_right"},
      {LAYOUT_CROSS_EYED, "right_left"},      {LAYOUT_OVER_UNDER, "top_bottom"},
      {LAYOUT_HALF_HEIGHT, "top_bottom"},     {LAYOUT_ROWS, "row_interleaved_lr"},
      {LAYOUT_COLUMNS, "col_interleaved_lr"}, {LAYOUT_SEPARATE, ""}};
  const auto mode = modes.find(layout);
  return mode == modes.end() ? "anaglyph_cyan_red" : mode->second;
}

fs::path temporary_beside(const fs::path& target) {
  return target.parent_path() /
         fmt::format("{}.part-{}{}", target.stem().string(), getpid(), target.extension().string());
}

std::vector<std::string> arguments_for(const fs::path& target, const fs::path& temporary, int width,
                                       int height, double frames_a_second, int layout) {
  // Each eye's colours must stay its own where its neighbours are the other eye's.
  const bool mixed = layout >= LAYOUT_ROWS;
  std::vector<std::string> arguments = {"ffmpeg", "-hide_banner", "-loglevel",     "error", "-y",
                                        "-f",     "rawvideo",     "-pixel_format", "rgb24"};
  const auto more = [&](std::initializer_list<std::string> list) { arguments.insert(arguments.end(), list); };
  more({"-video_size", fmt::format("{}x{}", width, height), "-framerate", fmt::format("{}", frames_a_second),
        "-i", "-"});
  more(
      {"-vf", fmt::format("pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format={}",
                          mixed ? "yuv444p" : "yuv420p")});
  more({"-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1", "-color_range",
        "tv"});
  if (lowered_ending(target) == ".webm") {
    more({"-c:v", "libvpx-vp9", "-crf", "18", "-b:v", "0"});
  } else {
    more({"-c:v", "libx264", "-crf", "16"});
  }
  if (!stereo_mode(layout).empty()) more({"-metadata:s:v:0", "stereo_mode=" + stereo_mode(layout)});
  more({fs::absolute(temporary).string()});
  return arguments;
}

}  // namespace

bool is_video(const fs::path& path) {
  const std::string text = lowered_ending(path);
  return text == ".mp4" || text == ".mov" || text == ".mkv" || text == ".webm";
}

fs::path find_ffmpeg() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    fs::path candidate = fs::path(folder.empty() ? "." : folder) / "ffmpeg";
    if (access(candidate.c_str(), X_OK) == 0 && fs::is_regular_file(candidate)) return candidate;
  }
  fail(
      "videos are written by ffmpeg, which is not installed: on Debian apt install ffmpeg, or name a folder "
      "with -o for one picture a frame");
}

Video::Video(const fs::path& path, int width, int height, double frames_a_second, int layout, bool vr180)
    : target_(path),
      temporary_(temporary_beside(path)),
      vr180_layout_(vr180 ? std::optional(layout) : std::nullopt),
      said_(std::tmpfile(), &std::fclose) {
  if (path.has_parent_path()) {
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) fail("cannot make the folder of {}: {}", path.string(), error.message());
  }
  start(arguments_for(target_, temporary_.path(), width, height, frames_a_second, layout));
}

void Video::start(const std::vector<std::string>& arguments) {
  const fs::path program = find_ffmpeg();
  std::vector<char*> pointers;
  for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  int ends[2];
  // A socket, not a pipe: writing to one whose reader is gone is an error that can be asked not to be a
  // signal.
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0 || said_ == nullptr)
    fail("cannot talk to ffmpeg: {}", std::strerror(errno));
  ffmpeg_ = fork();
  if (ffmpeg_ == 0) {
    // Ends with this program; Ctrl-C, which this program waits for elsewhere, reaches it.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    dup2(ends[1], STDIN_FILENO);
    dup2(fileno(said_.get()), STDERR_FILENO);
    dup2(fileno(said_.get()), STDOUT_FILENO);
    execv(program.c_str(), pointers.data());
    _exit(127);
  }
  const int error = errno;
  close(ends[1]);
  pictures_ = ends[0];
  if (ffmpeg_ < 0) fail("cannot start {}: {}", program.string(), std::strerror(error));
}

Video::~Video() {
  if (pictures_ >= 0) close(pictures_);
  if (ffmpeg_ > 0) {
    kill(ffmpeg_, SIGKILL);
    waitpid(ffmpeg_, nullptr, 0);
  }
  std::error_code ignored;
  fs::remove(temporary_.path(), ignored);
}

void Video::fail_with_what_it_said() {
  std::string text;
  std::rewind(said_.get());
  for (int c = std::fgetc(said_.get()); c != EOF && text.size() < 2000; c = std::fgetc(said_.get()))
    text += static_cast<char>(c);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  fail("cannot write {}: ffmpeg ended{}{}", target_.string(), text.empty() ? "" : ": ", text);
}

std::string Video::bytes_of(const Image& image) {
  std::string bytes(image.data.size(), 0);
  std::transform(image.data.begin(), image.data.end(), bytes.begin(),
                 [](float v) { return static_cast<char>(static_cast<std::uint8_t>(step_of(v, 255.0f))); });
  return bytes;
}

void Video::add(std::string_view bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t sent = send(pictures_, &bytes[at], bytes.size() - at, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) {
      waitpid(ffmpeg_, nullptr, 0);
      ffmpeg_ = -1;
      fail_with_what_it_said();
    }
    at += static_cast<std::size_t>(sent);
  }
}

void Video::finish() {
  close(pictures_);
  pictures_ = -1;
  int status = 0;
  const pid_t ended = waitpid(ffmpeg_, &status, 0);
  ffmpeg_ = -1;
  if (ended < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0) fail_with_what_it_said();
  if (vr180_layout_) mark_half_sphere(temporary_.path(), *vr180_layout_);
  std::error_code error;
  fs::rename(temporary_.path(), target_, error);
  if (error) fail("cannot write {}: {}", target_.string(), error.message());
}

}  // namespace binosplat::app
