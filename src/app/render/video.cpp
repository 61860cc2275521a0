#include "app/render/video.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "formats/containers/content.h"
#include "shared/choices.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

// Matroska's StereoMode: empty for one eye, anaglyph for layouts that are not listed.
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

std::string quoted_for_shell(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

// The shell's command for a video. If the program is interrupted, it removes the file, and ffmpeg sees the
// end of the pictures. It may write the file only then, so the shell removes it again.
std::string command_for(const fs::path& target, const fs::path& temporary, int width, int height,
                        double frames_a_second, int layout) {
  // Layouts that interleave or mix the eyes need chroma in full resolution.
  const char* const pixels = layout >= LAYOUT_ROWS ? "yuv444p" : "yuv420p";
  const char* const codec =
      lowered_ending(target) == ".webm" ? "libvpx-vp9 -crf 18 -b:v 0" : "libx264 -crf 16";
  const std::string mode = stereo_mode(layout), file = quoted_for_shell(fs::absolute(temporary).string());
  return fmt::format(
      "ffmpeg -hide_banner -loglevel error -xerror -y -f rawvideo -pixel_format rgb24 -video_size {}x{} "
      "-framerate {} -i - -vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,"
      "format={}' -colorspace bt709 -color_primaries bt709 -color_trc iec61966-2-1 -color_range tv "
      "-c:v {} {} {}; code=$?; [ -e /proc/$PPID/exe ] || rm -f {}; exit $code",
      width, height, frames_a_second, pixels, codec,
      mode.empty() ? "" : "-metadata:s:v:0 stereo_mode=" + mode, file, file);
}

std::string number(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
          static_cast<char>(value)};
}

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

std::string box(std::string_view type, const std::string& content) {
  return number(static_cast<std::uint32_t>(content.size() + 8)) + std::string(type) + content;
}

std::string full_box(std::string_view type, const std::string& content) {
  return box(type, number(0) + content);  // version and flags
}

std::string boxes_of(int layout) {
  const char mode = layout == LAYOUT_SEPARATE ? 0 : layout == LAYOUT_OVER_UNDER ? 1 : 2;
  // Shares of the sphere outside the picture: top, bottom, left, right, each times 2^32.
  const std::string bounds = number(0) + number(0) + number(0x40000000) + number(0x40000000);
  const std::string pose = number(0) + number(0) + number(0);
  return full_box("st3d", std::string(1, mode)) +
         box("sv3d", full_box("svhd", std::string("binosplat") + '\0') +
                         box("proj", full_box("prhd", pose) + full_box("equi", bounds)));
}

std::uint64_t box_size_at(std::string_view bytes, std::size_t at) {
  const std::uint64_t size = number_at(bytes, at);
  if (size != 1 || at + 16 > bytes.size()) return size;
  return std::uint64_t{number_at(bytes, at + 8)} << 32 | number_at(bytes, at + 12);
}

// Position of the first box of a type in [begin, end), or npos.
std::size_t find_box(std::string_view bytes, std::size_t begin, std::size_t end, std::string_view type) {
  for (std::size_t at = begin; at + 8 <= end;) {
    const std::uint64_t size = box_size_at(bytes, at);
    if (size < 8 || size > end - at) return std::string_view::npos;
    if (bytes.substr(at + 4, 4) == type) return at;
    at += size;
  }
  return std::string_view::npos;
}

// Positions of the nested boxes from the movie to the first track's sample entry; empty if one is missing.
std::vector<std::size_t> path_to_sample_entry(std::string_view movie) {
  std::vector<std::size_t> way = {0};
  std::size_t begin = 8, end = movie.size();
  for (const std::string_view type : {"trak", "mdia", "minf", "stbl", "stsd"}) {
    const std::size_t at = find_box(movie, begin, end, type);
    if (at == std::string_view::npos) return {};
    way.push_back(at);
    begin = at + 8;
    end = at + number_at(movie, at);
  }
  begin += 8;  // the version of stsd, and its number of entries
  if (begin + 8 > end || begin + number_at(movie, begin) > end) return {};
  way.push_back(begin);
  return way;
}

// Marks a finished .mp4 or .mov as VR180: equirectangular, 180 degrees, with one eye (LAYOUT_SEPARATE) or
// both eyes in `layout`. The file must have one track, and `moov` last, as ffmpeg writes it. Adds the boxes
// st3d and sv3d of Google's Spherical Video V2, for which ffmpeg has no option.
void add_vr180_boxes(const fs::path& path, int layout) {
  std::string movie;
  std::size_t at = 0;
  {
    const MappedFile film(path);
    const std::string_view bytes = as_text(film.bytes());
    at = find_box(bytes, 0, bytes.size(), "moov");
    if (at != std::string_view::npos && at + number_at(bytes, at) == bytes.size()) movie = bytes.substr(at);
  }
  const std::vector<std::size_t> way = path_to_sample_entry(movie);
  if (way.empty()) fail("{}: ffmpeg left no film of one track that could be marked as VR180", path.string());
  const std::string added = boxes_of(layout);
  const std::size_t entry_end = way.back() + number_at(movie, way.back());
  for (const std::size_t of : way)
    movie.replace(of, 4, number(number_at(movie, of) + static_cast<std::uint32_t>(added.size())));
  movie.insert(entry_end, added);
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(at));
  file.write(movie.data(), static_cast<std::streamsize>(movie.size()));
  file.close();
  if (!file) fail("cannot write {}", path.string());
}

}  // namespace

bool is_video(const fs::path& path) {
  const std::string text = lowered_ending(path);
  return text == ".mp4" || text == ".mov" || text == ".mkv" || text == ".webm";
}

void check_ffmpeg() {
  if (std::system("command -v ffmpeg > /dev/null") == 0) return;
  fail(
      "videos are written by ffmpeg, which is not installed: on Debian apt install ffmpeg, or name a folder "
      "with -o for one picture a frame");
}

Video::Video(const fs::path& path, int width, int height, double frames_a_second, int layout, bool vr180)
    : target_(path),
      temporary_(temporary_beside(path)),
      vr180_layout_(vr180 ? std::optional(layout) : std::nullopt) {
  if (path.has_parent_path()) {
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) fail("cannot make the folder of {}: {}", path.string(), error.message());
  }
  std::signal(SIGPIPE, SIG_IGN);  // a write after ffmpeg's end is then an error, which add() tells
  const std::string command = command_for(target_, temporary_.path(), width, height, frames_a_second, layout);
  ffmpeg_ = popen(command.c_str(), "we");
  if (ffmpeg_ == nullptr) fail("cannot start ffmpeg: {}", std::strerror(errno));
}

Video::~Video() {
  if (ffmpeg_ != nullptr) pclose(ffmpeg_);
  std::error_code ignored;
  fs::remove(temporary_.path(), ignored);
}

void Video::end_ffmpeg() {
  const int status = pclose(std::exchange(ffmpeg_, nullptr));
  if (status == 0) return;
  fail("cannot write {}: ffmpeg ended (exit code {}); what it said is above", target_.string(),
       WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
}

std::string Video::bytes_of(const Image& image) {
  std::string bytes(image.data.size(), 0);
  std::transform(image.data.begin(), image.data.end(), bytes.begin(),
                 [](float v) { return static_cast<char>(static_cast<std::uint8_t>(step_of(v, 255.0f))); });
  return bytes;
}

void Video::add(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), ffmpeg_) == bytes.size()) return;
  end_ffmpeg();
  fail("cannot write {}: ffmpeg ended before the last picture", target_.string());
}

void Video::finish() {
  end_ffmpeg();
  if (vr180_layout_) add_vr180_boxes(temporary_.path(), *vr180_layout_);
  std::error_code error;
  fs::rename(temporary_.path(), target_, error);
  if (error) fail("cannot write {}: {}", target_.string(), error.message());
}

}  // namespace binosplat::app
