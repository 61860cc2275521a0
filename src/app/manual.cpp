#include "app/manual.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "app/command_line.h"
#include "app/render_options.h"

namespace binosplat::app {

namespace {

// As lines that roff does not fill. Its own commands begin with a dot or a quote; help has none in front.
std::string section(const std::string& title, std::string text) {
  text = CLI::detail::find_and_replace(text, "\\", "\\e");
  text = CLI::detail::find_and_replace(text, "-", "\\-");
  return fmt::format(".SH {}\n.nf\n{}\n.fi\n", title, text);
}

std::string manual_page(const CLI::App& program) {
  // The options of `view` are those of the preview, a program of its own.
  RenderOptions values;
  CLI::App view("", "binosplat view");
  add_view_options(view, values);
  add_max_memory(view);
  add_quiet(view);
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

void add_manual(CLI::App& program) {
  // As --version ends: well, and without a sub-command.
  program
      .add_flag_callback("--print-manual", [&program] { throw CLI::CallForVersion(manual_page(program), 0); })
      ->group("");
}

}  // namespace binosplat::app
