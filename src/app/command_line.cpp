#include "app/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "app/command.h"
#include "app/model_files.h"
#include "base/error.h"
#include "base/inputs.h"
#include "base/log.h"
#include "formats/plausible.h"
#include "gl/program_cache.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

// Options that name outputs, older results, which may give way to new ones, and views.
constexpr const char* no_inputs[] = {"--output", "--json", "--difference", "--compare",
                                     "--merge",  "--view", "--test"};

constexpr double gaussian_bytes = 400.0;         // in memory, while a model of degree 3 is read
constexpr std::uintmax_t cache_room = 64 << 20;  // bytes: more than shaders take

void note(const std::string& value) {
  note_input(value);
  std::error_code ignored;
  if (!fs::is_directory(value, ignored)) return;
  note_input(model_file(value));
  for (const char* name : {"meta.json", "lod-meta.json"}) note_input(fs::path(value) / name);
}

void note_pictures_in(const std::string& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string ending = CLI::detail::to_lower(entry.path().extension().string());
    if (ending == ".jpg" || ending == ".jpeg" || ending == ".png") note_input(entry.path());
  }
}

}  // namespace

void check_arguments(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    if (argv[i][0] != '\0') continue;
    const std::string before = i > 1 ? argv[i - 1] : "";
    if (before.starts_with("-"))
      fail("{} '': its value is empty; give it one, or leave the option out", before);
    fail("argument {} is empty: leave it out, or fill in what it should be", i);
  }
}

void spare_full_disk() {
  const fs::path folder = folder_there(gl::ProgramCache::default_folder());
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  if (folder.empty() || error || space.available >= cache_room) return;
  // Mesa's, under its names of different years, and NVIDIA's.
  setenv("MESA_SHADER_CACHE_DISABLE", "1", 0);
  setenv("MESA_GLSL_CACHE_DISABLE", "1", 0);
  setenv("__GL_SHADER_DISK_CACHE", "0", 0);
  log_warning("{}: the disk is full; drivers keep no shaders there in this run", folder.string());
}

void add_max_memory(CLI::App& sub) {
  sub.add_option_function<double>(
         "--max-memory",
         [](double megabytes) {
           gaussians_allowed = static_cast<std::uint64_t>(1e6 * megabytes / gaussian_bytes);
         },
         "Believe a small file that its model takes so much memory (0.4 GB,\nor more where the file is "
         "larger)")
      ->check(CLI::Range(1.0, 1e9).description(""))
      ->type_name("MB");
}

void note_inputs(const CLI::App& program) {
  for (const CLI::App* sub : program.get_subcommands()) note_inputs(*sub);
  for (const CLI::Option* option : program.get_options()) {
    const bool output = std::any_of(std::begin(no_inputs), std::end(no_inputs),
                                    [&](const char* name) { return option->check_name(name); });
    if (output) continue;
    for (const std::string& value : option->results()) {
      note(value);
      if (option->check_name("--photos")) note_pictures_in(value);
    }
  }
}

}  // namespace binosplat::app
