// The command line: runs a sub-command, and turns errors into a line and an exit code.

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "app/command.h"
#include "app/command_line.h"
#include "base/log.h"

namespace {

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

}  // namespace

int main(int argc, char** argv) {
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
  return binosplat::app::run_program(program, argc, argv, [&] {
    binosplat::app::end_cleanly_on_signals();
    std::vector<std::string> words = binosplat::app::with_command(program, argc, argv);
    std::reverse(words.begin(), words.end());  // the order that CLI11 expects
    program.parse(std::move(words));
    return command();
  });
}
