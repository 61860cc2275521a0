// binosplat convert: writes a model in another format.

#include "formats/models/model_output.h"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "app/command.h"
#include "app/models/load_scene.h"
#include "app/models/model_files.h"
#include "app/options/checks.h"
#include "app/options/options.h"
#include "app/options/parse.h"
#include "base/log.h"
#include "lab/fields.h"
#include "scene/axes.h"

namespace binosplat::app {

namespace {

namespace fs = std::filesystem;

ModelFormat format_of(const Options& o) { return o.to ? *o.to : output_format(o.output, "; or say --to"); }

void check_convert(const Options& o, ModelFormat format) {
  check(o.scene);
  check_harmonic_bits(o.harmonic_bits, format);
}

/// Prints what was written, and writes it as JSON.
void report_converted(const Options& o, ModelFormat format, const Model& model,
                      const std::vector<std::string>& losses) {
  const std::uintmax_t bytes = fs::file_size(o.output);
  const double each = static_cast<double>(bytes) / static_cast<double>(model.count());
  std::optional<std::uintmax_t> bytes_before;  // if the model is one file
  std::error_code ignored;
  if (fs::is_regular_file(o.scene.name, ignored)) bytes_before = fs::file_size(o.scene.name);
  fmt::print("{}: {}, {} Gaussians\n{} bytes, {:.2f} a Gaussian{}\n", o.output, row_of(format).name,
             model.count(), bytes, each,
             bytes_before ? fmt::format("; {} has {}, {:.2f} times as many", o.scene.name, *bytes_before,
                                        static_cast<double>(*bytes_before) / static_cast<double>(bytes))
                          : "");
  if (!o.json.empty())
    save_json(o.json, lab::object("version", BINOSPLAT_VERSION, "model", o.scene.name, "output", o.output,
                                  "format", word_of(format), "gaussians", model.count(), "bytes", bytes,
                                  "bytes_per_gaussian", each, "losses", losses, "model_bytes", bytes_before));
}

ExitCode convert(const Options& o) {
  const ModelFormat format = format_of(o);
  check_convert(o, format);
  Model model = load_scene(o.scene);
  refuse_scaffold(model, o.scene.name);

  const std::string axes = model.axes.letters, wanted(row_of(format).axes);
  if (axes != wanted)
    log_info("{}: its axes are turned from {} to {}, the ones of {}", o.output, axes, wanted,
             row_of(format).name);
  if (format == ModelFormat::spz)
    log_info(
        "{}: its axes are RUB, as the format has them and as the file says; programs that take them for "
        "a ply's (RDF), such as splat-transform 3.7, show it upside down",
        o.output);
  bring_into_axes(model, wanted);
  const std::vector<std::string> losses =
      write_model_file(o.output, model, format, o.harmonic_bits.value_or(8));
  for (const std::string& loss : losses) log_warning("{}", loss);
  report_converted(o, format, model, losses);
  return ExitCode::done;
}

}  // namespace

void add_convert(CLI::App& program, Command& command) {
  add_command(program, command,
              {"convert", in::convert, "Write a model in another format, and report what it loses",
               "Warnings name what the format cannot store.\n"
               "Examples:\n"
               "  binosplat convert garden.ply -o garden.spz\n"
               "  binosplat convert scan.spz --axes rdf -o scan.ply"},
              convert);
}

}  // namespace binosplat::app
