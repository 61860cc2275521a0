#include "formats/containers/uri.h"

#include <charconv>
#include <cstdint>
#include <span>

#include "base/path_questions.h"
#include "base/text.h"
#include "formats/containers/content.h"
#include "formats/containers/zip_file.h"

namespace binosplat {

namespace {

std::vector<std::byte> decode_base64(const JsonValue& uri, std::string_view text) {
  std::vector<std::byte> bytes;
  std::uint32_t bits = 0;
  int filled = 0;
  while (text.ends_with('=')) text.remove_suffix(1);
  for (const char c : text) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t digit = digits.find(c);
    if (digit == std::string_view::npos) uri.fail_here("{} is not a digit of base64", quoted({&c, 1}));
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    filled += 6;
    if (filled < 8) continue;
    filled -= 8;
    bytes.push_back(static_cast<std::byte>(bits >> filled & 0xff));
  }
  return bytes;
}

}  // namespace

std::string percent_decoded(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char byte = 0;
    const char* digits = text.data() + i + 1;
    const bool encoded = text[i] == '%' && i + 2 < text.size() &&
                         std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2;
    decoded += encoded ? static_cast<char>(byte) : text[i];
    if (encoded) i += 2;
  }
  return decoded;
}

bool has_data(const JsonValue& uri) { return lowered(uri.text().substr(0, 5)) == "data:"; }

std::vector<std::byte> data_in(const JsonValue& uri) {
  const std::string text = uri.text();
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) uri.fail_here("a data: URI without a comma: expected one before its data");
  const std::string data = percent_decoded(std::string_view(text).substr(comma + 1));
  if (lowered(text.substr(0, comma)).ends_with(";base64")) return decode_base64(uri, data);
  const auto bytes = std::as_bytes(std::span(data));
  return {bytes.begin(), bytes.end()};
}

std::filesystem::path file_named(const std::filesystem::path& folder, const JsonValue& uri) {
  const std::string text = uri.text(), decoded = percent_decoded(text);
  if (decoded.find("://") != std::string::npos)
    uri.fail_here("'{}' is not a file beside this one; fetch it, and name it by its path", text);
  if (!is_below_folder(decoded) || !is_below_folder(text))
    uri.fail_here("a buffer must lie beside the file or below; it is named '{}'", text);
  using std::filesystem::path;
  const path file = folder / path(decoded).lexically_normal(),
             as_written = folder / path(text).lexically_normal();
  const bool is_written_so = !is_file(file) && is_file(as_written);
  return is_written_so ? as_written : file;
}

}  // namespace binosplat
