#pragma once
// Encodes JPEG files.

#include <turbojpeg.h>

#include <string>
#include <vector>

namespace binosplat::test {

/// Encodes pixels of libturbojpeg's `format`, given row by row, as a file.
inline std::string encode_jpeg(const std::vector<unsigned char>& pixels, int width, int height, int format,
                               int subsampling, int quality, int flags = 0) {
  tjhandle encoder = tjInitCompress();
  unsigned char* data = nullptr;
  unsigned long size = 0;
  tjCompress2(encoder, pixels.data(), width, 0, height, format, &data, &size, subsampling, quality, flags);
  std::string bytes(reinterpret_cast<char*>(data), size);
  tjFree(data);
  tjDestroy(encoder);
  return bytes;
}

}  // namespace binosplat::test
