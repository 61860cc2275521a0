#include "app/render_outputs.h"

#include <algorithm>
#include <cctype>

#include "app/command.h"
#include "formats/exr.h"
#include "formats/image_file.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

fs::path default_folder(const std::string& scene) {
  const auto colon = scene.rfind("demo:", 0) == 0 ? scene.find(':') + 1 : 0;
  const fs::path path = scene.substr(colon);
  return fs::path("out") / (path.has_filename() ? path : path.parent_path()).stem();
}

// What a picture's file says of how it was drawn: a stereo picture is right only at its scale.
Notes notes_of(const RenderOptions& options, const Shot& shot, const std::string& side) {
  Notes notes = {{"Software", "binosplat " BINOSPLAT_VERSION},
                 {"binosplatScene", options.scene},
                 {"binosplatView", shot.name},
                 {"binosplatUnitsPerMetre", fmt::format("{}", options.units_per_metre)}};
  if (!side.empty()) notes["binosplatEye"] = side;
  if (shot.ipd) notes["binosplatIpdMetres"] = fmt::format("{}", *shot.ipd);
  return notes;
}

Picture side_by_side(const std::vector<Picture>& pictures) {
  int width = 0;
  for (const Picture& picture : pictures) {
    width += picture.width;
    if (picture.height != pictures[0].height)
      fail("-o FILE: the eyes differ in height; name a folder for one file an eye");
  }
  Picture joined(width, pictures[0].height);
  for (int y = 0; y < joined.height; ++y) {
    auto out = static_cast<std::size_t>(y) * width;
    for (const Picture& picture : pictures) {
      const auto row = static_cast<std::ptrdiff_t>(y) * picture.width;
      std::copy_n(picture.colour.begin() + row, picture.width,
                  joined.colour.begin() + static_cast<std::ptrdiff_t>(out));
      std::copy_n(picture.z_sum.begin() + row, picture.width,
                  joined.z_sum.begin() + static_cast<std::ptrdiff_t>(out));
      out += static_cast<std::size_t>(picture.width);
    }
  }
  return joined;
}

void write(const RenderOptions& options, const OutputPlan& plan, const fs::path& path, const Picture& picture,
           const Notes& notes, std::vector<std::string>& written) {
  const Uninterrupted hold;
  if (plan.png) {
    written.push_back(path.string() + ".png");
    save_png(written.back(), composite(picture, options.background), options.bits.value_or(8), notes);
  }
  if (plan.exr) {
    written.push_back(path.string() + ".exr");
    save_exr(written.back(), picture,
             {options.exr != "float", options.exr_encoding == "display", options.background, notes});
  }
}

}  // namespace

OutputPlan plan_outputs(const RenderOptions& options) {
  OutputPlan plan;
  plan.exr = !options.exr.empty();
  const fs::path output = options.output.empty() ? default_folder(options.scene) : fs::path(options.output);
  const std::string extension = lower_extension(output);
  const bool file = extension == ".png" || extension == ".exr";
  for (const char* other : {".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp"}) {
    if (extension == other) fail("-o {}: pictures are written as .png or .exr", output.string());
  }
  if (file) {
    check_output(output);
    plan.file = output.parent_path() / output.stem();
    plan.png = extension == ".png";
    plan.exr = plan.exr || !plan.png;
  } else {
    // A name in the folder stands for all of them.
    check_output(output / "picture");
    plan.folder = output;
  }
  if (options.bits && !plan.png)
    fail("--bits is for PNG: -o {} writes OpenEXR, whose depth --exr sets", output.string());
  if (!options.exr_encoding.empty() && !plan.exr)
    fail("--exr-encoding is for OpenEXR: add --exr half or --exr float");
  if (!options.json.empty()) check_output(options.json);
  return plan;
}

std::vector<std::string> write_outputs(const RenderOptions& options, const OutputPlan& plan, const Shot& shot,
                                       const std::vector<Picture>& pictures) {
  std::vector<std::string> written;
  if (plan.folder.empty()) {
    const std::string side = shot.eyes.size() == 1 ? shot.eyes[0].side : "left, right";
    write(options, plan, plan.file, side_by_side(pictures), notes_of(options, shot, side), written);
    return written;
  }
  for (std::size_t k = 0; k < shot.eyes.size(); ++k) {
    const std::string& side = shot.eyes[k].side;
    const fs::path path = plan.folder / (side.empty() ? shot.stem : shot.stem + "_" + side);
    write(options, plan, path, pictures[k], notes_of(options, shot, side), written);
  }
  return written;
}

}  // namespace binosplat::app
