// binosplat convert: writes a model in another format.

#include "formats/model_output.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "app/command.h"
#include "app/load_scene.h"
#include "app/model_files.h"
#include "app/options/checks.h"
#include "app/options/options.h"
#include "app/options/parse.h"
#include "base/log.h"
#include "formats/model_file.h"
#include "lab/fields.h"
#include "scene/axes.h"

namespace binosplat::app {

namespace {

namespace fs = std::filesystem;

struct Converted {
  ModelFormat format = ModelFormat::ply;
  std::size_t count = 0;
  std::optional<std::uintmax_t> bytes_before;  // if the model is one file
  std::uintmax_t bytes = 0;
  std::vector<std::string> losses;

  double bytes_each() const { return static_cast<double>(bytes) / static_cast<double>(count); }
};

ModelFormat format_of(const Options& o) { return o.to ? *o.to : output_format(o.output, "; or say --to"); }

void check_convert(const Options& o, ModelFormat format) {
  check(o.scene);
  check_output(o.output);
  check_harmonic_bits(o.harmonic_bits, format);
  if (!o.json.empty()) check_output(o.json);
}

void print_converted(const Options& o, const Converted& c) {
  const char* format = row_of(c.format).name;
  fmt::print("{}: {}, {} Gaussians\n", o.output, format, c.count);
  fmt::print("{} bytes, {:.2f} a Gaussian", c.bytes, c.bytes_each());
  if (c.bytes_before) {
    fmt::print("; {} has {}, {:.2f} times as many", o.scene.name, *c.bytes_before,
               static_cast<double>(*c.bytes_before) / static_cast<double>(c.bytes));
  }
  fmt::print("\n");
}

nlohmann::ordered_json converted_json(const Options& o, const Converted& c) {
  return lab::object("version", BINOSPLAT_VERSION, "model", o.scene.name, "output", o.output, "format",
                     word_of(c.format), "gaussians", c.count, "bytes", c.bytes, "bytes_per_gaussian",
                     c.bytes_each(), "losses", c.losses, "model_bytes", c.bytes_before);
}

ExitCode convert(const Options& o) {
  Converted done;
  done.format = format_of(o);
  check_convert(o, done.format);
  Model model = load_scene(o.scene);
  refuse_scaffold(model, o.scene.name);

  const std::string axes = model.axes.letters, wanted(row_of(done.format).axes);
  if (axes != wanted)
    log_info("{}: its axes are turned from {} to {}, the ones of {}", o.output, axes, wanted,
             row_of(done.format).name);
  if (done.format == ModelFormat::spz)
    log_info(
        "{}: its axes are RUB, as the format has them and as the file says; programs that take them for "
        "a ply's (RDF), such as splat-transform 3.7, show it upside down",
        o.output);
  bring_into_axes(model, wanted);
  done.count = model.count();
  done.losses = write_model_file(o.output, model, done.format, o.harmonic_bits.value_or(8));
  for (const std::string& loss : done.losses) log_warning("{}", loss);
  std::error_code ignored;
  if (fs::is_regular_file(o.scene.name, ignored)) done.bytes_before = fs::file_size(o.scene.name);
  done.bytes = fs::file_size(o.output);
  print_converted(o, done);
  if (!o.json.empty()) save_json(o.json, converted_json(o, done));
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
