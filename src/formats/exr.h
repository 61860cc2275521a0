#pragma once
// OpenEXR files as docs/method.md 3 defines them: scene-linear by convention, with depth.
//
// With a background: R, G, B = EOTF(C + T * background), A = 1, and the model's coverage, 1 - T, in channel
// `coverage`. Without: associated alpha, R, G, B = A * EOTF(C/A), A = 1 - T. EOTF is sRGB's, extended above 1
// by the same power law; nothing is clamped. Z is view-space depth Z/A if A > 0.5, otherwise +infinity,
// always FLOAT. The header's attribute `binosplatEncoding` is "linear" or "display" (without EOTF).
//
// Both eyes share one file in OpenEXR's multi-view standard: the attribute `multiView` lists left and right.
// The left eye is the default view with the channels above. The right eye's channels are right.R, right.Z and
// so on.
//
// load_image (formats/image_file.h) reads R, G, B or Y of any OpenEXR file and converts them to display
// values by that attribute; without it, values are scene-linear. The picture is the display window: 0 outside
// the data window, and cropped. A becomes straight alpha; it is dropped if the file has `coverage`, whose
// colours include the background. Of several views it reads the default one and logs that.

#include <filesystem>

#include "base/image.h"
#include "formats/image_file.h"

namespace binosplat {

/// sRGB's transfer function from display values to linear light and back, odd about 0 and unbounded.
double srgb_to_linear(double v);
double linear_to_srgb(double v);

/// Lossless compression of pixels: ZIP makes files a fifth smaller than RLE, in six times the time.
enum class ExrCompression { none, rle, zip };

struct ExrOptions {
  bool half = true;       // all channels but Z as 16-bit floats
  bool display = false;   // without EOTF
  Background background;  // none: associated alpha
  Notes notes;            // string attributes of the header
  ExrCompression compression = ExrCompression::rle;
};

/// Writes a picture. Throws Error naming the file.
void save_exr(const std::filesystem::path& path, const Picture& picture, const ExrOptions& options);

/// Writes a pair as the views left and right of one file. Throws Error naming the file, also if the two
/// differ in size: views share a window.
void save_exr(const std::filesystem::path& path, const Picture& left, const Picture& right,
              const ExrOptions& options);

/// Return the bytes of such files; the path names them in errors.
std::string exr_bytes(const std::filesystem::path& path, const Picture& picture, const ExrOptions& options);
std::string exr_bytes(const std::filesystem::path& path, const Picture& left, const Picture& right,
                      const ExrOptions& options);

}  // namespace binosplat
