#include "formats/webp.h"

#include <webp/decode.h>

#include "base/error.h"
#include "formats/content.h"

namespace binosplat {

namespace {

const std::uint8_t* data_of(std::span<const std::byte> bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

}  // namespace

WebpSize webp_size(const std::string& source, std::span<const std::byte> bytes) {
  const Content content = content_of(bytes);
  if (content != Content::webp)
    fail("{}: expected a WebP picture, but it looks like {}", source, describe(content));
  constexpr int lossless = 2;
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(data_of(bytes), bytes.size(), &features) != VP8_STATUS_OK) {
    fail("{}: the header of the WebP picture is damaged or cut short", source);
  }
  if (features.has_animation != 0) fail("{}: expected a still WebP picture, but it is an animation", source);
  if (features.format != lossless) {
    fail(
        "{}: the WebP picture is compressed with losses, which destroys the values in it; export the model "
        "again (cwebp -lossless -exact)",
        source);
  }
  return {features.width, features.height};
}

std::vector<std::uint8_t> webp_texels(const std::string& source, std::span<const std::byte> bytes) {
  const WebpSize size = webp_size(source, bytes);
  std::vector<std::uint8_t> texels(4 * size.texels());
  if (WebPDecodeRGBAInto(data_of(bytes), bytes.size(), texels.data(), texels.size(), 4 * size.width) ==
      nullptr) {
    fail("{}: the WebP picture of {} x {} texels is damaged or cut short ({} bytes)", source, size.width,
         size.height, bytes.size());
  }
  return texels;
}

}  // namespace binosplat
