#pragma once
// The options that choose what is written.

#include <optional>
#include <string>

#include "app/cli.h"
#include "app/measured_options.h"
#include "base/image.h"
#include "formats/exr.h"
#include "shared/axes.h"

namespace binosplat::app {

/// Value of --photos for the folder of photos beside the cameras.
constexpr const char* photos_beside = "beside";
/// Value of --exposure for pictures without exposures.
constexpr const char* no_exposure = "none";

struct OutputOptions {
  std::string output;         // a folder or a file; empty: default_folder()
  std::optional<int> layout;  // LAYOUT_ of shared/axes.h; none: chosen by `output`
  int show = SHOW_PICTURE;    // SHOW_
  std::optional<double> fps;  // frame rate of a path or video; none: from the path's times
  Background background = glm::vec3(0.0f);
  std::optional<int> bits;
  std::optional<int> png_level;     // compression level of libdeflate
  std::optional<bool> exr_half;     // if set, also writes OpenEXR: half (true) or float
  std::optional<bool> exr_display;  // OpenEXR has display values instead of linear light
  std::optional<Depth> exr_depth;
  std::optional<ExrCompression> exr_compression;
  std::string photos;    // a folder, or photos_beside
  std::string exposure;  // a file, or no_exposure; empty: the one beside the model
  std::string json;

  /// The background for comparisons: black if none.
  glm::vec3 backdrop() const { return background.value_or(glm::vec3(0.0f)); }
};

/// Parses --background: "R,G,B" from 0 to 1, or "none". Throws Error for other text.
Background parse_background(const std::string& text);

/// Adds all options of OutputOptions; `options` must outlive parsing.
void add_output_options(CLI::App& sub, OutputOptions& options);

/// Adds --layout, --show and --background. A window offers no multi-view.
void add_look_options(CLI::App& sub, OutputOptions& options, bool in_window);

/// Adds --exposure and --photos. `found_beside` allows the photos beside the cameras.
void add_photos_options(CLI::App& sub, MeasuredOptions& options,
                        const char* help = "DIR/NAME.jpg or .png of the views", bool found_beside = false);

}  // namespace binosplat::app
