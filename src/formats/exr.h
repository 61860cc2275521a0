#pragma once
// OpenEXR as docs/method.md 3 defines it: scene-linear by convention, with depth.
//
// With a background: R, G, B = EOTF(C + T * background), A = 1, and what the model covers, 1 - T, in channel
// `coverage`. Without: associated alpha, R, G, B = A * EOTF(C/A), A = 1 - T. EOTF is sRGB's, which goes on
// above 1 by the same power law; nothing is clamped. Z is view-space depth Z/A where A > 0.5, +infinity
// elsewhere, always FLOAT. The header's attribute `binosplatEncoding`, "linear" or "display" (EOTF left out),
// says which it is.
//
// Both eyes go into one file as OpenEXR's multi-view standard has it: the attribute `multiView` lists left
// and right, the left eye is the default view with the channels above, the right eye's are right.R, right.Z
// and so on.
//
// load_image (formats/image_file.h) reads R, G, B or Y of any OpenEXR file and brings them back to display
// values by that attribute; a file without it is taken as scene-linear. The picture is that of the display
// window: what the data window lacks of it is 0, and what lies beyond it is left out. A becomes straight
// alpha; of a file that has `coverage`, and so its background, it is left out. Of several views it reads the
// default one, and says so.

#include <filesystem>

#include "base/image.h"
#include "formats/image_file.h"

namespace binosplat {

/// sRGB's transfer function from display values to linear light and back, odd about 0 and without an upper
/// end.
double srgb_to_linear(double v);
double linear_to_srgb(double v);

/// How pixels are packed, without loss: by ZIP a fifth smaller than by RLE, in six times as long.
enum class ExrCompression { none, rle, zip };

struct ExrOptions {
  bool half = true;       // all channels but Z as 16-bit floats
  bool display = false;   // leave the EOTF out
  Background background;  // none: associated alpha
  Notes notes;            // string attributes of the header
  ExrCompression compression = ExrCompression::rle;
};

/// Writes a picture. Throws Error naming the file.
void save_exr(const std::filesystem::path& path, const Picture& picture, const ExrOptions& options);

/// Writes a pair as the views left and right of one file. Throws Error naming the file, for one if the two
/// differ in size: views share a window.
void save_exr(const std::filesystem::path& path, const Picture& left, const Picture& right,
              const ExrOptions& options);

/// The bytes of such files; the path is for errors.
std::string exr_bytes(const std::filesystem::path& path, const Picture& picture, const ExrOptions& options);
std::string exr_bytes(const std::filesystem::path& path, const Picture& left, const Picture& right,
                      const ExrOptions& options);

}  // namespace binosplat
