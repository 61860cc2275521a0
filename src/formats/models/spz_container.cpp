#include "formats/models/spz_container.h"

#include <zstd.h>

#include <algorithm>
#include <functional>

#include "base/error.h"
#include "base/log.h"
#include "formats/containers/bytes.h"
#include "formats/containers/content.h"
#include "formats/containers/gzip.h"
#include "formats/containers/size_limits.h"

namespace binosplat {

namespace {

constexpr std::size_t spz_header_bytes = 16, header_bytes_4 = 32;
constexpr std::uint32_t magic = 0x5053474e;  // the letters NGSP
constexpr std::uint8_t antialiased_flag = 1, extensions_flag = 2, levels_flag = 0x80;
constexpr std::uint32_t axes_extension = 0xadbe0003;
constexpr const char* axes_names[] = {"LDB", "RDB", "LUB", "RUB", "LDF", "RDF", "LUF", "RUF",
                                      "LFD", "RFD", "LFU", "RFU", "LBD", "RBD", "LBU", "RBU"};
constexpr std::size_t max_extensions = std::size_t{1} << 20;

struct Header {
  SpzContents contents;
  std::uint8_t flags = 0;
  std::uint8_t streams = 0;
};

Header read_spz_header(const std::string& source, std::span<const std::byte> bytes) {
  if (bytes.size() < spz_header_bytes) {
    fail("{} is cut short: an spz header has {} bytes, and {} are there", source, spz_header_bytes,
         bytes.size());
  }
  if (load_number<std::uint32_t>(&bytes[0]) != magic) {
    fail(
        "{} is not an spz model: its unpacked data must begin with NGSP, but looks like {}; unpack it "
        "(gunzip)",
        source, describe(content_of(bytes)));
  }
  Header header;
  SpzContents& contents = header.contents;
  contents.version = load_number<std::uint32_t>(&bytes[4]);
  if (contents.version < 1 || contents.version > 4)
    fail("{}: unknown spz version {}: expected 1 to 4", source, contents.version);
  contents.count = load_number<std::uint32_t>(&bytes[8]);
  contents.degree = std::to_integer<int>(bytes[12]);
  contents.fraction_bits = std::to_integer<int>(bytes[13]);
  header.flags = std::to_integer<std::uint8_t>(bytes[14]);
  header.streams = std::to_integer<std::uint8_t>(bytes[15]);
  if (contents.count == 0) fail("{} holds no Gaussians: its header says 0", source);
  if (contents.degree > 4)
    fail("{}: harmonics of degree {}, at byte 12; expected 0 to 4", source, contents.degree);
  if (contents.fraction_bits > 24)
    fail("{}: positions with {} bits of fraction, at byte 13; expected 0 to 24", source,
         contents.fraction_bits);
  contents.antialiased = (header.flags & antialiased_flag) != 0;
  if (contents.version < 4 && (header.flags & levels_flag) != 0)
    fail("{} is a tree of levels of detail (Spark), which cannot be drawn; export the plain model", source);
  return header;
}

/// Returns the number of bytes of all attributes. Because callers allocate so many bytes, throws Error unless
/// `packed` bytes can hold that many Gaussians and expand to `least` bytes for each.
std::size_t attribute_bytes(const std::string& source, const SpzContents& contents, std::size_t least,
                            std::size_t packed) {
  if (contents.count > max_gaussians_in(packed) || contents.count * least / max_deflate_growth > packed) {
    fail(
        "{} is damaged or cut short: its header promises {} Gaussians of degree {}, which {} bytes cannot "
        "hold{}",
        source, contents.count, contents.degree, packed, more_may_be_allowed);
  }
  return contents.count * spz_sizes(contents.version, contents.degree).sum();
}

/// Reads the extensions: records of a type, a length and as many bytes. Skips unknown types.
void read_extensions(const std::string& source, std::span<const std::byte> bytes, SpzContents& contents) {
  while (!bytes.empty()) {
    const std::size_t length = bytes.size() < 8 ? 0 : load_number<std::uint32_t>(&bytes[4]);
    if (bytes.size() < 8 || length > bytes.size() - 8) {
      fail("{} is damaged: an extension of {} bytes runs past the {} that are left for it", source, length,
           bytes.size() < 8 ? 0 : bytes.size() - 8);
    }
    if (load_number<std::uint32_t>(&bytes[0]) == axes_extension && length >= 4) {
      const auto axes = load_number<std::uint32_t>(&bytes[8]);
      if (axes > std::size(axes_names)) {
        fail("{}: its extension names the coordinate system {}; 0 to {} are known", source, axes,
             std::size(axes_names));
      }
      if (axes > 0) contents.axes = axes_names[axes - 1];
    }
    bytes = bytes.subspan(8 + length);
  }
}

void warn_of_rest(const std::string& source, bool there) {
  if (there) log_warning("{}: bytes after the last attribute are ignored", source);
}

/// Unpacks versions 1 to 3. `read` returns the next bytes, at most the given number.
SpzContents unpack_attributes(const std::string& source, std::size_t packed,
                              const std::function<std::vector<std::byte>(std::size_t most)>& read) {
  Header header = read_spz_header(source, read(spz_header_bytes));
  SpzContents& contents = header.contents;
  if (contents.version == 4) fail("{}: spz version 4 within gzip: expected a file without gzip", source);
  const std::size_t all = spz_sizes(contents.version, contents.degree).sum();
  const std::size_t needed = attribute_bytes(source, contents, all, packed);
  contents.attributes = read(needed);
  if (contents.attributes.size() < needed) {
    fail(
        "{} is cut short: its {} Gaussians of degree {} take {} bytes after the header, and {} are there; "
        "fetch or export it again",
        source, contents.count, contents.degree, needed, contents.attributes.size());
  }
  const bool extended = (header.flags & extensions_flag) != 0;
  // Reads to the end, where gzip tests its checksum, unless too much data follows.
  const std::vector<std::byte> rest = read(extended ? max_extensions : 1);
  if (extended) {
    read_extensions(source, rest, contents);
  } else {
    warn_of_rest(source, !rest.empty());
  }
  return std::move(header.contents);
}

/// Unpacks the streams of version 4, whose table is at byte `toc`.
void unpack_streams(const std::string& source, std::span<const std::byte> bytes, std::size_t toc,
                    SpzContents& contents) {
  const SpzSizes sizes = spz_sizes(contents.version, contents.degree);
  constexpr const char* names[] = {"positions", "opacities", "colours", "scales", "rotations", "harmonics"};
  const std::size_t streams = contents.degree == 0 ? 5 : 6;
  // zstd's expansion is unbounded: a stream that repeats one value takes a few bytes. Positions never repeat.
  contents.attributes.resize(attribute_bytes(source, contents, sizes[spz_positions], bytes.size()));
  std::size_t at = toc + 16 * streams, to = 0;
  for (std::size_t i = 0; i < streams; ++i) {
    const auto packed = load_number<std::uint64_t>(&bytes[toc + 16 * i]);
    const auto unpacked = load_number<std::uint64_t>(&bytes[toc + 16 * i + 8]);
    const std::size_t size = contents.count * sizes[i];
    if (unpacked != size) {
      fail("{}: the table at byte {} promises {} bytes of {}; {} Gaussians have {}", source, toc, unpacked,
           names[i], contents.count, size);
    }
    if (packed > bytes.size() - at) {
      fail("{} is cut short: its {} take {} bytes from byte {} on, and {} are there", source, names[i],
           packed, at, bytes.size() - at);
    }
    const std::size_t result = ZSTD_decompress(contents.attributes.data() + to, size, &bytes[at], packed);
    if (ZSTD_isError(result) != 0 || result != size) {
      fail("{} is damaged: its {}, {} bytes from byte {} on, cannot be unpacked: {}", source, names[i],
           packed, at, ZSTD_isError(result) != 0 ? ZSTD_getErrorName(result) : "they are too few");
    }
    at += packed;
    to += size;
  }
  warn_of_rest(source, at < bytes.size());
}

SpzContents unpack_4(const std::string& source, std::span<const std::byte> bytes) {
  Header header = read_spz_header(source, bytes);
  SpzContents& contents = header.contents;
  if (bytes.size() < header_bytes_4)
    fail("{} is cut short: the header has {} bytes, and {} are there", source, header_bytes_4, bytes.size());
  const std::size_t streams = contents.degree == 0 ? 5 : 6;
  if (header.streams != streams) {
    fail("{}: {} streams, at byte 15; a model of degree {} has {}", source, header.streams, contents.degree,
         streams);
  }
  const std::size_t toc = load_number<std::uint32_t>(&bytes[16]);
  if (toc < header_bytes_4 || toc > bytes.size() || bytes.size() - toc < 16 * streams) {
    fail("{} is damaged or cut short: its table of {} streams stands at byte {} of {}", source, streams, toc,
         bytes.size());
  }
  if ((header.flags & extensions_flag) != 0)
    read_extensions(source, bytes.subspan(header_bytes_4, toc - header_bytes_4), contents);
  unpack_streams(source, bytes, toc, contents);
  return std::move(header.contents);
}

}  // namespace

SpzSizes spz_sizes(std::uint32_t version, int degree) {
  const std::size_t bands = static_cast<std::size_t>(degree) + 1;
  const std::size_t harmonics = 3 * (bands * bands - 1);
  return {{version == 1 ? 6u : 9u, 1, 3, 3, version < 3 ? 3u : 4u, harmonics}};
}

std::vector<std::byte> spz_header(std::uint32_t version, std::size_t count, int degree, int fraction_bits,
                                  bool antialiased) {
  if (count > 0x7fffffff) fail("{} Gaussians are more than an spz file can hold", count);
  std::vector<std::byte> header(spz_header_bytes);
  store_number(&header[0], magic);
  store_number(&header[4], version);
  store_number(&header[8], static_cast<std::uint32_t>(count));
  header[12] = static_cast<std::byte>(degree);
  header[13] = static_cast<std::byte>(fraction_bits);
  header[14] = static_cast<std::byte>(extensions_flag | (antialiased ? antialiased_flag : 0));
  return header;
}

std::vector<std::byte> spz_axes_extension(std::string_view axes) {
  const auto* const found = std::find(std::begin(axes_names), std::end(axes_names), axes);
  std::vector<std::byte> extension(12);
  store_number(&extension[0], axes_extension);
  store_number(&extension[4], std::uint32_t{4});  // bytes that follow
  store_number(&extension[8], static_cast<std::uint32_t>(found - std::begin(axes_names) + 1));
  return extension;
}

SpzContents unpack_spz(const std::string& source, std::span<const std::byte> bytes) {
  if (content_of(bytes) == Content::gzip) {
    GzipReader gzip(source, bytes);
    return unpack_attributes(source, bytes.size(), [&](std::size_t most) { return gzip.read(most); });
  }
  if (bytes.size() >= 8 && load_number<std::uint32_t>(&bytes[4]) == 4) return unpack_4(source, bytes);
  return unpack_attributes(source, bytes.size(), [rest = bytes](std::size_t most) mutable {
    const auto next = rest.first(std::min(most, rest.size()));
    rest = rest.subspan(next.size());
    return std::vector<std::byte>(next.begin(), next.end());
  });
}

}  // namespace binosplat
