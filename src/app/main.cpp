// The command line: runs a sub-command, and turns errors into a line and an exit code.

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/command.h"
#include "app/command_line.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/output_file.h"

namespace {

using binosplat::ExitCode;

constexpr const char* epilogue =
    "`binosplat SUBCOMMAND --help` has the options and examples.\n`render --threshold adagscale` draws by "
    "AdaGScale (Jo et al.): docs/adagscale.md.\nExit codes: 0 done; 1 a comparison fell short; 2 input, "
    "output or usage is wrong; 3 no usable OpenGL, display or headset; 4 out of memory.";

// A section of the manual page in roff, with its line breaks. No line of help begins with a dot or a quote,
// which would need an escape.
std::string section(const std::string& title, std::string text) {
  text = CLI::detail::find_and_replace(text, "\\", "\\e");
  text = CLI::detail::find_and_replace(text, "-", "\\-");
  return fmt::format(".SH {}\n.nf\n{}\n.fi\n", title, text);
}

std::string manual_page(const CLI::App& program) {
  // `view` is a separate program, so its options are added here.
  binosplat::app::Options values;
  CLI::App view("", "binosplat view");
  binosplat::app::add_options(view, binosplat::app::in::view, values);
  view.footer(binosplat::app::keys_text());
  std::string page = fmt::format(
      ".TH BINOSPLAT 1 \"\" \"binosplat {}\" \"User Commands\"\n.SH NAME\nbinosplat \\- both eyes of a 3D "
      "Gaussian Splatting model\n",
      BINOSPLAT_VERSION);
  page += section("binosplat", program.help());
  for (const CLI::App* sub : program.get_subcommands({})) {
    const std::string name = "binosplat " + sub->get_name();
    page += section(name, (sub->get_name() == "view" ? view : *sub).help(name));
  }
  return page;
}

// Wrong options throw CLI::ParseError, other errors throw Error.
int run(int argc, char** argv) {
  CLI::App program(
      "binosplat draws both eyes of a 3D Gaussian Splatting model, and measures pictures and time.",
      "binosplat");
  program.set_version_flag("--version", "binosplat " BINOSPLAT_VERSION);
  program.require_subcommand(1);
  program.footer(epilogue);
  program.add_flag_callback(
      "--quiet", [] { binosplat::set_quiet(true); }, "Print only results, warnings and errors");
  binosplat::app::Command command;
  binosplat::app::add_render(program, command);
  binosplat::app::add_view(program, command);
  binosplat::app::add_compare(program, command);
  binosplat::app::add_info(program, command);
  binosplat::app::add_convert(program, command);
  binosplat::app::add_levels(program, command);
  binosplat::app::add_trim(program, command);
  binosplat::app::add_refit(program, command);
  binosplat::app::add_devices(program, command);
  binosplat::app::add_profile(program, command);
  binosplat::app::add_bench(program, command);
  binosplat::app::add_calibrate(program, command);
  // For packagers, hidden from help. Like --version, it ends the program without a sub-command.
  program
      .add_flag_callback("--print-manual", [&program] { throw CLI::CallForVersion(manual_page(program), 0); })
      ->group("");
  try {
    binosplat::app::check_arguments(argc, argv);
    std::vector<std::string> words = binosplat::app::with_command(program, argc, argv);
    std::reverse(words.begin(), words.end());  // the order that CLI11 expects
    program.parse(std::move(words));
    const ExitCode code = command();
    if (std::fflush(stdout) != 0) throw std::system_error(errno, std::generic_category());
    return static_cast<int>(code);
  } catch (const CLI::Success& asked) {
    return program.exit(asked);
  } catch (const CLI::ParseError& error) {
    binosplat::log_line(binosplat::app::explain(program, "binosplat", error));
    return static_cast<int>(ExitCode::bad_input);
  }
}

}  // namespace

int main(int argc, char** argv) {
  // A write beyond the limit of file size then fails with an error, as on a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  binosplat::app::prepare_shader_caches();
  binosplat::end_cleanly_without_memory();
  try {
    binosplat::app::end_cleanly_on_signals();
    return run(argc, argv);
  } catch (...) {
    return binosplat::app::exit_code_of_current_exception();
  }
}
