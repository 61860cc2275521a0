#include "app/models/model_files.h"

#include "app/options/table.h"
#include "formats/models/model_file.h"

namespace binosplat::app {

namespace fs = std::filesystem;

ModelFormat output_format(const std::string& output, const std::string& hint) {
  const auto format = model_format_of(output);
  if (!format) {
    fail("-o {}: its ending names no format that can be written: {}{}", output, written_endings(), hint);
  }
  return *format;
}

fs::path model_file(const std::string& scene) {
  std::error_code ignored;
  if (!fs::is_directory(scene, ignored)) return scene;
  const std::vector<fs::path> found = models_in(scene);
  // A SOG's meta.json only lists the model's files.
  return found.size() == 1 && found[0].extension() != ".json" ? found[0] : fs::path();
}

void refuse_scaffold(const Model& model, const std::string& scene) {
  if (model.scaffold) {
    fail("{} is a Scaffold-GS model, which decodes Gaussians for each eye: no other format can store it",
         scene);
  }
}

void check_harmonic_bits(const std::optional<int>& bits, ModelFormat format) {
  if (bits && format != ModelFormat::spz) fail("--sh-bits {}: only spz has a choice of them", *bits);
}

namespace {

/// Reads a written model back, with the perspective, low-pass and origin of `model`, which some formats lack.
Model load_written(const fs::path& file, const Model& model) {
  Model written = load_model_alone(file);
  written.set_training(model);
  move_origin(written, model.axes.origin);
  return written;
}

}  // namespace

compact::TrialWriter trial_writer(const std::string& output, ModelFormat format) {
  return [output, format](const Model& model, int harmonic_bits) {
    OutputFile file(output);
    write_model(file, model, format, harmonic_bits);
    file.flush();
    return compact::WrittenModel{load_written(file.path(), model), fs::file_size(file.path())};
  };
}

std::vector<std::string> write_model_file(const std::string& output, const Model& model, ModelFormat format,
                                          int harmonic_bits) {
  std::vector<std::string> losses = binosplat::write_model_file(output, model, format, harmonic_bits);
  for (std::string& loss : losses) loss = with_options(loss);
  return losses;
}

}  // namespace binosplat::app
