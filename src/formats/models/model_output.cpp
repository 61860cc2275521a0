#include "formats/models/model_output.h"

#include <algorithm>

#include "base/choices.h"
#include "base/error.h"
#include "base/text.h"
#include "formats/models/model_file.h"
#include "formats/models/model_writers.h"

namespace binosplat {

void read_back(OutputFile& file, const Model& model, ModelFormat format) {
  const char* name = row_of(format).name;
  file.flush();
  std::size_t count = 0;
  try {
    count = load_model_alone(file.path()).count();
  } catch (const Error& error) {
    throw Error(
        error.code(),
        fmt::format("{}: {} cannot store this model; the written file is unreadable ({}). Try another format",
                    model.name, name, error.what()));
  }
  if (count != model.count()) {
    fail("{}: {} cannot store this model; of {} written Gaussians, {} can be read back. Try another format",
         model.name, name, model.count(), count);
  }
}

std::string written_endings() {
  std::vector<std::string> endings;
  for (const ModelFormat format : written_formats()) endings.emplace_back(row_of(format).endings);
  return alternatives(endings);
}

std::optional<ModelFormat> model_format_of(const std::filesystem::path& path) {
  const std::string name = lowered(path.filename().string());
  if (name.ends_with(".compressed.ply")) return std::nullopt;
  for (const ModelFormat format : written_formats()) {
    if (name.ends_with(row_of(format).endings)) return format;
  }
  return std::nullopt;
}

std::uint64_t bytes_in(ModelFormat format, std::size_t count, int degree) {
  return row_of(format).bytes(count, 3 * static_cast<std::uint64_t>(sh_count(degree) - 1));
}

std::vector<std::string> training_losses(const Model& model, ModelFormat format) {
  Losses losses;
  if (model.flat && (format == ModelFormat::spz || !stores_flat(model)))
    losses.emplace_back(
        "depths of discs (2DGS) become those of Gaussians: only a ply or SOG of nothing but discs says it");
  if (format != ModelFormat::spz) return losses;
  const auto add = [&](const std::string& what, const std::string& options) {
    losses.push_back(fmt::format("spz does not store {}: draw it with {}", what, options));
  };
  if (model.kernel_px2 != KERNEL_PX2)
    add(fmt::format("the low-pass of {:.4g} px^2", model.kernel_px2),
        fmt::format("`eps2d` {}", model.kernel_px2));
  if (model.near_plane)
    add(fmt::format("the near plane of {:.4g}", *model.near_plane),
        fmt::format("`near` {}", *model.near_plane));
  if (model.linear) losses.emplace_back("spz does not store that colours are linear light: ply and SOG do");
  if (model.perspective != Perspective{})
    add("order and projection", fmt::format("`order` {} `projection` {}", name_of(model.perspective.order),
                                            name_of(model.perspective.projection)));
  return losses;
}

std::vector<std::string> write_model(OutputFile& file, const Model& model, ModelFormat format,
                                     int harmonic_bits) {
  if (model.scaffold) {
    fail(
        "{} is a Scaffold-GS model, which decodes Gaussians for each eye: a file of Gaussians cannot store "
        "it",
        model.name);
  }
  if (model.axes.letters != row_of(format).axes) {
    fail("{}: its axes are {}, but {} requires {}", model.name, model.axes.letters, row_of(format).name,
         row_of(format).axes);
  }
  if (model.axes.origin != glm::dvec3(0.0) && format != ModelFormat::ply && format != ModelFormat::sog) {
    Model rounded = model;
    const double by = move_origin(rounded, glm::dvec3(0.0));
    Losses losses = write_model(file, rounded, format, harmonic_bits);
    losses.push_back(fmt::format(
        "positions so far from zero are rounded by up to {:.2g} units: {} has floats (ply and SOG keep them)",
        by, row_of(format).name));
    return losses;
  }
  Losses losses = row_of(format).write(file, model, harmonic_bits);
  std::ranges::move(training_losses(model, format), std::back_inserter(losses));
  return losses;
}

std::vector<std::string> write_model_file(const std::filesystem::path& path, const Model& model,
                                          ModelFormat format, int harmonic_bits) {
  OutputFile file(path);
  std::vector<std::string> losses = write_model(file, model, format, harmonic_bits);
  read_back(file, model, format);
  file.commit();
  return losses;
}

}  // namespace binosplat
