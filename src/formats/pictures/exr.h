#pragma once
// OpenEXR files as docs/method.md 3 defines them: scene-linear by convention, with depth.
//
// With a background: R, G, B = EOTF(C + T * background), A = 1, and channel `coverage` has the model's
// coverage, 1 - T. Without a background, alpha is associated: A = 1 - T, and R, G, B = A * EOTF(C/A). EOTF is
// sRGB's, extended above 1 by the same power law; nothing is clamped. Channel Z, always FLOAT, has the depths
// of depth_map() (base/image.h). The attribute `binosplatEncoding` is "linear" or "display" (without EOTF).
//
// Both eyes share one file in OpenEXR's multi-view standard: the attribute `multiView` lists left and right.
// The left eye is the default view with the channels above, and the right eye has right.R, right.Z and so on.
//
// load_image (formats/pictures/image_file.h) reads R, G, B or Y of the default view of any OpenEXR file.
// Unless `binosplatEncoding` is "display", it converts them from scene-linear to display values. The picture
// covers the display window: pixels outside the data window are 0. A becomes straight alpha. If the file has
// `coverage`, its colours include the background, and A is ignored.

#include <filesystem>

#include "base/image.h"
#include "formats/pictures/image_file.h"

namespace binosplat {

/// Lossless compression of pixels: ZIP makes files a fifth smaller than RLE, in six times the time.
enum class ExrCompression { none, rle, zip };

struct ExrOptions {
  bool half = true;       // all channels but Z as 16-bit floats
  bool display = false;   // stores display values, without the EOTF
  Background background;  // if none, alpha is associated
  Notes notes;            // string attributes of the header
  ExrCompression compression = ExrCompression::rle;
};

/// Writes a picture. Throws Error naming the file.
void save_exr(const std::filesystem::path& path, const Picture& picture, const ExrOptions& options);

/// Writes an eye pair as the views left and right of one file. Throws Error naming the file, also if the
/// sizes differ, because both views share a window.
void save_exr(const std::filesystem::path& path, const Picture& left, const Picture& right,
              const ExrOptions& options);

std::string exr_bytes(const std::filesystem::path& path, const Picture& picture, const ExrOptions& options);
std::string exr_bytes(const std::filesystem::path& path, const Picture& left, const Picture& right,
                      const ExrOptions& options);

}  // namespace binosplat
