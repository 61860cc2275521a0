#include "formats/containers/content.h"

#include <algorithm>
#include <bit>
#include <iterator>

#include "base/text.h"
#include "formats/containers/bytes.h"

namespace binosplat {

namespace {

using namespace std::string_view_literals;

/// A content's description for errors, and its first bytes; empty if other rules recognise the content.
struct Kind {
  Content content;
  std::string_view words;
  std::string_view start{};
};

constexpr Kind kinds[] = {
    {Content::empty, "an empty file"},
    {Content::ply, "a ply file"},
    {Content::spz, "an spz model", "NGSP"sv},
    {Content::png, "a PNG picture", "\x89PNG\r\n\x1a\n"sv},
    {Content::jpeg, "a JPEG picture", "\xff\xd8\xff"sv},
    {Content::exr, "an OpenEXR picture", "\x76\x2f\x31\x01"sv},
    {Content::webp, "a WebP picture or another RIFF file", "RIFF"sv},
    {Content::tiff, "a TIFF picture", "II*\0"sv},
    {Content::heif, "a HEIF or AVIF picture, or an MP4 video"},
    {Content::jpeg_xl, "a JPEG XL picture", "\0\0\0\x0cJXL "sv},
    {Content::gzip, "a gzip-compressed file (perhaps an spz model; otherwise unpack it first)", "\x1f\x8b"sv},
    {Content::zip, "a zip archive (perhaps a sog model; otherwise unpack it first)", "PK\x03\x04"sv},
    {Content::zstd, "a zstd-compressed file (unpack it first)", "\x28\xb5\x2f\xfd"sv},
    {Content::xz, "an xz-compressed file (unpack it first)", "\xfd\x37zXZ\0"sv},
    {Content::glb, "a binary glTF file", "glTF"sv},
    {Content::openusd,
     "an OpenUSD scene (3DGRUT exports a ply instead with export_ply.enabled=true, or converts the scene: "
     "python -m threedgrut.export.scripts.transcode SCENE -o MODEL.ply)"},
    {Content::rad,
     "a .rad model of Spark, which only Spark reads (name the model from which its build-lod made the file)",
     "RAD0"sv},
    {Content::git_lfs, "a git-LFS pointer, not the file itself (fetch that with: git lfs pull)",
     "version https://git-lfs"sv},
    {Content::html, "an HTML or XML page, perhaps an error page saved under this name"},
    {Content::json, "a JSON file"},
    {Content::text, "a text file"},
    {Content::unknown, "something unknown"},
};
static_assert(std::size(kinds) == static_cast<std::size_t>(Content::unknown) + 1);

/// Returns whether a file is a .usda, a .usdc, or a .usdz: a zip archive with such a file first.
bool is_openusd(std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes);
  if (text.starts_with("#usda ") || text.starts_with("PXR-USDC")) return true;
  constexpr std::size_t length = 26, name = 30;  // offsets in an archive
  if (!text.starts_with("PK\x03\x04") || text.size() < name) return false;
  const std::string ending = lowered_ending(text.substr(name, load_number<std::uint16_t>(&bytes[length])));
  return ending == ".usd" || ending == ".usda" || ending == ".usdc";
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

bool is_text(char c) { return static_cast<unsigned char>(c) >= 0x20 || is_blank(c); }

/// Returns whether the bytes from 0x80 to 0xff form UTF-8; the last character may be cut. This distinguishes
/// text from a .splat of one Gaussian, which may have no byte below 0x20, but is hardly ever valid UTF-8.
bool is_utf8(std::string_view text) {
  int following = 0;  // remaining bytes of the current character
  for (const char c : text) {
    const int ones = std::countl_one(static_cast<unsigned char>(c));
    if ((following > 0) != (ones == 1) || ones > 4) return false;
    following = ones > 1 ? ones - 1 : std::max(following - 1, 0);
  }
  return true;
}

}  // namespace

Content content_of(std::span<const std::byte> bytes) {
  std::string_view text = as_text(bytes).substr(0, 1024);
  if (text.empty()) return Content::empty;
  if (text.starts_with("ply") && (text.size() == 3 || is_blank(text[3]))) return Content::ply;
  if (is_openusd(bytes)) return Content::openusd;
  if (text.find("ftyp") == 4) return Content::heif;
  for (const Kind& kind : kinds) {
    if (!kind.start.empty() && text.starts_with(kind.start)) return kind.content;
  }
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  if (!std::all_of(text.begin(), text.end(), is_text) || !is_utf8(text)) return Content::unknown;
  const auto first = std::find_if_not(text.begin(), text.end(), is_blank);
  if (first == text.end()) return Content::text;
  if (*first == '<') return Content::html;
  return *first == '{' || *first == '[' ? Content::json : Content::text;
}

std::string_view describe(Content content) { return kinds[static_cast<std::size_t>(content)].words; }

std::string quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > 40 ? "...'" : "'");
}

}  // namespace binosplat
