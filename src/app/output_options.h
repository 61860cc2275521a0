#pragma once
// What becomes of the pictures.

#include <optional>
#include <string>

#include "app/cli.h"
#include "app/measured_options.h"
#include "base/image.h"
#include "formats/exr.h"
#include "shared/axes.h"

namespace binosplat::app {

/// In the place of a folder: the photos that lie beside the cameras.
constexpr const char* photos_beside = "beside";
/// In the place of a file: pictures are compared as they are drawn.
constexpr const char* no_exposure = "none";

struct OutputOptions {
  std::string output;         // a folder or a file; empty: default_folder()
  std::optional<int> layout;  // LAYOUT_ of shared/axes.h; none: by what `output` names
  int show = SHOW_PICTURE;    // SHOW_
  std::optional<double> fps;  // of a path, or of a video; none: by the path's times
  Background background = glm::vec3(0.0f);
  std::optional<int> bits;
  int png_level = 1;                // of libdeflate
  std::optional<bool> exr_half;     // OpenEXR, too, as half or float
  std::optional<bool> exr_display;  // display values instead of light
  Depth exr_depth = Depth::mean;
  ExrCompression exr_compression = ExrCompression::rle;
  std::string photos;    // a folder, or photos_beside
  std::string exposure;  // a file, or no_exposure; empty: the one beside the model
  std::string json;
  bool detail_report = false;

  /// What pictures are compared before: black for none.
  glm::vec3 backdrop() const { return background.value_or(glm::vec3(0.0f)); }
};

/// The value of a --background: "R,G,B" of 0 to 1, or "none". Throws Error for anything else.
Background parse_background(const std::string& text);

/// Adds all of them; `options` must outlive the parsing.
void add_output_options(CLI::App& sub, OutputOptions& options);

/// Those of them that a window has, too: --layout, --show and --background. A window has no multi-view.
void add_look_options(CLI::App& sub, OutputOptions& options, bool in_window);

/// --photos of commands that look for none beside the cameras, and --exposure.
void add_photos_options(CLI::App& sub, MeasuredOptions& options,
                        const char* help = "DIR/NAME.jpg or .png of the views", bool found_beside = false);

}  // namespace binosplat::app
