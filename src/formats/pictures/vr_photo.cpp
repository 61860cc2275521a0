#include "formats/pictures/vr_photo.h"

#include <turbojpeg.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "formats/containers/bytes.h"

namespace binosplat {

namespace {

using namespace std::string_literals;

constexpr int jpeg_quality = 95;

std::string jpeg_of(const std::filesystem::path& path, const Image& image) {
  std::vector<unsigned char> bytes(image.data.size());
  std::transform(image.data.begin(), image.data.end(), bytes.begin(),
                 [](float v) { return static_cast<unsigned char>(step_of(v, 255.0f)); });
  const std::unique_ptr<void, decltype(&tjDestroy)> encoder(tjInitCompress(), &tjDestroy);
  unsigned char* made = nullptr;
  unsigned long size = 0;
  const bool good = encoder && tjCompress2(encoder.get(), bytes.data(), image.width, 0, image.height,
                                           TJPF_RGB, &made, &size, TJSAMP_444, jpeg_quality, 0) == 0;
  const std::unique_ptr<unsigned char, decltype(&tjFree)> owner(made, &tjFree);
  if (!good) fail("cannot write {}: {}", path, tjGetErrorStr2(encoder.get()));
  return {reinterpret_cast<const char*>(made), size};
}

std::string app1(const std::string& content) {
  return "\xff\xe1" + big_endian(static_cast<std::uint32_t>(content.size() + 2), 2) + content;
}

std::string described(const std::string& attributes) {
  return "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF "
         "xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\"><rdf:Description rdf:about=\"\" " +
         attributes + "/></rdf:RDF></x:xmpmeta>";
}

// The XMP segment that all readers read. It names the extension with the right eye.
std::string packet(int side, const std::string& rest) {
  return app1(
      "http://ns.adobe.com/xap/1.0/\0"s +
      described(fmt::format("xmlns:GPano=\"http://ns.google.com/photos/1.0/panorama/\" "
                            "xmlns:GImage=\"http://ns.google.com/photos/1.0/image/\" "
                            "xmlns:xmpNote=\"http://ns.adobe.com/xmp/note/\" "
                            "GPano:ProjectionType=\"equirectangular\" GPano:CroppedAreaLeftPixels=\"{0}\" "
                            "GPano:CroppedAreaTopPixels=\"0\" GPano:CroppedAreaImageWidthPixels=\"{1}\" "
                            "GPano:CroppedAreaImageHeightPixels=\"{1}\" GPano:FullPanoWidthPixels=\"{2}\" "
                            "GPano:FullPanoHeightPixels=\"{1}\" GPano:InitialViewHeadingDegrees=\"180\" "
                            "GImage:Mime=\"image/jpeg\" xmpNote:HasExtendedXMP=\"{3}\"",
                            side / 2, side, 2 * side, rest)));
}

// Splits data above 64 KiB, the size of a segment. Each segment has the name and size of all data.
std::string extension_segments(const std::string& whole, const std::string& name) {
  constexpr std::size_t part = 65000;
  std::string segments;
  for (std::size_t at = 0; at < whole.size(); at += part) {
    segments += app1("http://ns.adobe.com/xmp/extension/\0"s + name +
                     big_endian(static_cast<std::uint32_t>(whole.size())) +
                     big_endian(static_cast<std::uint32_t>(at)) + whole.substr(at, part));
  }
  return segments;
}

}  // namespace

std::string vr_photo_bytes(const std::filesystem::path& path, const Image& left, const Image& right) {
  const std::string first = jpeg_of(path, left);
  const std::string rest =
      described("xmlns:GImage=\"http://ns.google.com/photos/1.0/image/\" GImage:Data=\"" +
                base64(jpeg_of(path, right)) + "\"");
  // XMP requires an MD5 as this name. Readers only compare it, so any digest works.
  const XXH128_hash_t hash = XXH3_128bits(rest.data(), rest.size());
  const std::string name = fmt::format("{:016X}{:016X}", hash.high64, hash.low64);
  // Cameras write XMP after the JPEG's start mark and JFIF segment.
  const std::size_t jfif_end =
      4U + (static_cast<unsigned char>(first[4]) << 8) + static_cast<unsigned char>(first[5]);
  return first.substr(0, jfif_end) + packet(left.width, name) + extension_segments(rest, name) +
         first.substr(jfif_end);
}

}  // namespace binosplat
