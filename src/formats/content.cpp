#include "formats/content.h"

#include <algorithm>
#include <bit>

namespace binosplat {

namespace {

using namespace std::string_view_literals;

struct Signature {
  std::string_view start;
  Content content;
};

constexpr Signature signatures[] = {
    {"NGSP"sv, Content::spz},
    {"\x89PNG\r\n\x1a\n"sv, Content::png},
    {"\xff\xd8\xff"sv, Content::jpeg},
    {"\x76\x2f\x31\x01"sv, Content::exr},
    {"RIFF"sv, Content::webp},
    {"\x1f\x8b"sv, Content::gzip},
    {"PK\x03\x04"sv, Content::zip},
    {"\x28\xb5\x2f\xfd"sv, Content::zstd},
    {"\xfd\x37zXZ\0"sv, Content::xz},
    {"glTF"sv, Content::glb},
    {"#usda "sv, Content::usda},
    {"PXR-USDC"sv, Content::usdc},
    {"version https://git-lfs"sv, Content::git_lfs},
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

bool is_text(char c) { return static_cast<unsigned char>(c) >= 0x20 || is_blank(c); }

/// Whether bytes from 0x80 on are characters of UTF-8; the last one may be truncated. Of one Gaussian in a
/// .splat no byte need be below 0x20, but hardly ever are they such characters.
bool is_utf8(std::string_view text) {
  int following = 0;  // bytes that belong to the character at hand
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
  for (const Signature& signature : signatures) {
    if (text.starts_with(signature.start)) return signature.content;
  }
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  if (!std::all_of(text.begin(), text.end(), is_text) || !is_utf8(text)) return Content::unknown;
  const auto first = std::find_if_not(text.begin(), text.end(), is_blank);
  if (first == text.end()) return Content::text;
  if (*first == '<') return Content::html;
  return *first == '{' || *first == '[' ? Content::json : Content::text;
}

std::string_view describe(Content content) {
  switch (content) {
    case Content::empty:
      return "an empty file";
    case Content::ply:
      return "a ply file";
    case Content::spz:
      return "an spz model";
    case Content::png:
      return "a PNG picture";
    case Content::jpeg:
      return "a JPEG picture";
    case Content::exr:
      return "an OpenEXR picture";
    case Content::webp:
      return "a WebP picture or another RIFF file";
    case Content::gzip:
      return "a gzip-compressed file (spz models are such; or unpack it first)";
    case Content::zip:
      return "a zip archive (sog models are such; or unpack it first)";
    case Content::zstd:
      return "a zstd-compressed file (unpack it first)";
    case Content::xz:
      return "an xz-compressed file (unpack it first)";
    case Content::glb:
      return "a binary glTF file";
    case Content::usda:
      return "an OpenUSD scene in text";
    case Content::usdc:
      return "a binary OpenUSD scene";
    case Content::git_lfs:
      return "a git-LFS pointer, not the file itself (fetch that with: git lfs pull)";
    case Content::html:
      return "an HTML or XML page, perhaps an error page saved under this name";
    case Content::json:
      return "a JSON file";
    case Content::text:
      return "a text file";
    case Content::unknown:
      break;
  }
  return "something unknown";
}

std::string quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > 40 ? "...'" : "'");
}

}  // namespace binosplat
