#include "formats/model_output.h"

#include <algorithm>
#include <new>

#include "base/error.h"
#include "base/log.h"
#include "base/text.h"
#include "formats/model_file.h"
#include "formats/model_writers.h"

namespace binosplat {

namespace {

Losses write(OutputFile& file, const Model& model, ModelFormat format, int harmonic_bits) {
  switch (format) {
    case ModelFormat::ply:
      return write_ply(file, model);
    case ModelFormat::splat:
      return write_splat(file, model);
    case ModelFormat::sog:
      return write_sog(file, model);
    case ModelFormat::spz:
      break;
  }
  return write_spz(file, model, harmonic_bits);
}

}  // namespace

void read_back(OutputFile& file, const Model& model, ModelFormat format) {
  const char* name = written_format(format).name;
  file.flush();
  std::size_t count = 0;
  try {
    count = load_model_alone(file.path()).count();
  } catch (const Error& error) {
    throw Error(
        error.code(),
        fmt::format("{}: {} cannot hold it; what was written cannot be read back ({}). Try another format",
                    model.name, name, error.what()));
  }
  if (count != model.count()) {
    fail("{}: {} cannot hold it; of {} Gaussians written {} can be read back. Try another format", model.name,
         name, model.count(), count);
  }
}

std::string written_endings() {
  std::string all;
  for (std::size_t k = 0; k < std::size(written_formats); ++k) {
    const bool is_last = k + 1 == std::size(written_formats);
    all += k == 0 ? "" : is_last ? " or " : ", ";
    all += written_formats[k].ending;
  }
  return all;
}

std::optional<ModelFormat> model_format_of(const std::filesystem::path& path) {
  const std::string name = lowered(path.filename().string());
  if (name.ends_with(".compressed.ply")) return std::nullopt;
  for (std::size_t k = 0; k < std::size(written_formats); ++k) {
    if (name.ends_with(written_formats[k].ending)) return static_cast<ModelFormat>(k);
  }
  return std::nullopt;
}

std::uint64_t bytes_in(ModelFormat format, std::size_t count, int degree) {
  const auto higher = 3 * static_cast<std::uint64_t>(sh_count(degree) - 1);
  switch (format) {
    case ModelFormat::ply:
      return count * 4 * (17 + higher);
    case ModelFormat::splat:
      return count * 32;
    case ModelFormat::sog:
      return count * (degree > 0 ? 19 : 17) + std::min<std::uint64_t>(count, 65536) * higher;
    case ModelFormat::spz:
      break;
  }
  return count * (20 + higher);
}

std::vector<std::string> kernel_loss(const Model& model, ModelFormat format) {
  if (model.kernel_px2 == KERNEL_PX2 || (format == ModelFormat::ply && is_mip_splatting(model))) return {};
  return {fmt::format("{} does not tell the low-pass of {:.4g} px^2: draw it with --kernel-px2 {:.4g}",
                      written_format(format).name, model.kernel_px2, model.kernel_px2)};
}

std::vector<std::string> write_model(OutputFile& file, const Model& model, ModelFormat format,
                                     int harmonic_bits) {
  if (model.scaffold) {
    fail(
        "{} is a Scaffold-GS model, which makes its Gaussians anew for each eye: no file of Gaussians can "
        "hold "
        "it",
        model.name);
  }
  if (model.axes.letters != axes_of(format)) {
    fail("{}: its axes are {}, and {} has {}", model.name, model.axes.letters, written_format(format).name,
         axes_of(format));
  }
  if (model.axes.origin != glm::dvec3(0.0) && format != ModelFormat::ply && format != ModelFormat::sog) {
    Model rounded = model;
    const double by = move_origin(rounded, glm::dvec3(0.0));
    Losses losses = write_model(file, rounded, format, harmonic_bits);
    losses.push_back(fmt::format(
        "positions so far from zero are rounded by up to {:.2g} units: {} has floats (ply and SOG keep them)",
        by, written_format(format).name));
    return losses;
  }
  Losses losses = write(file, model, format, harmonic_bits);
  std::ranges::move(kernel_loss(model, format), std::back_inserter(losses));
  if ((format == ModelFormat::spz || format == ModelFormat::splat) && model.perspective != Perspective{}) {
    losses.push_back(fmt::format("{} does not tell how it is seen: draw it with --order {} --projection {}",
                                 written_format(format).name, order_choices[model.perspective.order].name,
                                 projection_choices[model.perspective.projection].name));
  }
  return losses;
}

}  // namespace binosplat
