#include "formats/pictures/webp.h"

#include <webp/decode.h>
#include <webp/encode.h>

#include "base/error.h"
#include "formats/containers/content.h"
#include "formats/pictures/picture_readers.h"

namespace binosplat {

namespace {

const std::uint8_t* data_of(std::span<const std::byte> bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

}  // namespace

TableSize sog_texture_size(const std::string& source, std::span<const std::byte> bytes) {
  const Content content = content_of(bytes);
  if (content == Content::png) return TableSize(png_size(source, bytes));
  if (content != Content::webp)
    fail("{}: expected a WebP or PNG picture, but it looks like {}", source, describe(content));
  constexpr int lossless = 2;
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(data_of(bytes), bytes.size(), &features) != VP8_STATUS_OK)
    fail("{}: the header of the WebP picture is damaged or cut short", source);
  if (features.has_animation != 0) fail("{}: expected a still WebP picture, but it is an animation", source);
  if (features.format != lossless) {
    fail("{}: lossy compression of WebP destroys its values; export the model again (cwebp -lossless -exact)",
         source);
  }
  return TableSize(features.width, features.height);
}

std::vector<std::byte> webp_file(std::span<const std::uint8_t> texels, int width, int height) {
  constexpr int effort = 6;  // of 9; more effort saves less than a hundredth, in many times the time
  WebPConfig config;
  WebPPicture picture;
  WebPMemoryWriter writer;
  bool good = WebPConfigInit(&config) != 0 && WebPConfigLosslessPreset(&config, effort) != 0 &&
              WebPPictureInit(&picture) != 0;
  config.exact = 1;  // keeps colours where alpha is 0
  picture.use_argb = 1;
  picture.width = width;
  picture.height = height;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  good = good && WebPPictureImportRGBA(&picture, texels.data(), 4 * width) != 0 &&
         WebPEncode(&config, &picture) != 0;
  const auto* data = reinterpret_cast<const std::byte*>(writer.mem);
  std::vector<std::byte> bytes;
  if (good) bytes.assign(data, data + writer.size);
  WebPPictureFree(&picture);
  WebPMemoryWriterClear(&writer);
  if (!good)
    throw Error(ExitCode::out_of_memory,
                fmt::format("no memory for a WebP picture of {} x {} texels", width, height));
  return bytes;
}

std::vector<std::uint8_t> sog_texels(const std::string& source, std::span<const std::byte> bytes) {
  if (content_of(bytes) == Content::png) return png_texels(source, bytes);
  const TableSize size = sog_texture_size(source, bytes);
  std::vector<std::uint8_t> texels(4 * size.x * size.y);
  if (WebPDecodeRGBAInto(data_of(bytes), bytes.size(), texels.data(), texels.size(),
                         static_cast<int>(4 * size.x)) == nullptr) {
    fail("{}: the WebP picture of {} x {} texels is damaged or cut short ({} bytes)", source, size.x, size.y,
         bytes.size());
  }
  return texels;
}

}  // namespace binosplat
