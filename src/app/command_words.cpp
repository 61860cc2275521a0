#include "app/command_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <vector>

#include "app/command_line.h"
#include "app/render_options.h"
#include "base/error.h"

namespace binosplat::app {

namespace {

using Options = std::vector<const CLI::Option*>;

std::string replaced(const std::string& text, const std::string& what, const std::string& by) {
  return CLI::detail::find_and_replace(text, what, by);
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

// Which may as well be given again for each.
bool takes_many(const CLI::Option& option) { return option.get_items_expected_max() > 1; }

/// A long name of an option, as a shell completes it.
struct Completion {
  const CLI::Option* option = nullptr;
  std::string name;
  std::string help;         // in one line, without its list of words
  std::string words;        // that it takes: "a|b|FILE" takes "a b"
  bool words_only = false;  // and nothing else, as a file or a number

  Completion(const CLI::Option& of, std::string called) : option(&of), name(std::move(called)) {
    const std::string& text = of.get_description();
    help = replaced(text.substr(0, text.find("\n  ")), "\n", " ");
    const std::vector<std::string> choices = CLI::detail::split(of.get_type_name(), '|');
    std::vector<std::string> taken;
    for (const std::string& word : choices) {
      const auto is_of_word = [](unsigned char c) {
        return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '-';
      };
      if (!word.empty() && std::all_of(word.begin(), word.end(), is_of_word)) taken.push_back(word);
    }
    words = fmt::format("{}", fmt::join(taken, " "));
    words_only = !taken.empty() && taken.size() == choices.size();
  }
};

/// A sub-command with its options, in the order of its help.
struct Part {
  std::string name, description, footer;
  std::vector<std::pair<std::string, Options>> groups;  // no group's name: what stands alone, as SCENE
  std::vector<Completion> completions;

  explicit Part(const CLI::App& app)
      : name(app.get_name()), description(app.get_description()), footer(app.get_footer()) {
    const Options alone = app.get_options([](const CLI::Option* o) { return o->get_positional(); });
    if (!alone.empty()) groups.emplace_back("", alone);
    for (const std::string& group : app.get_groups()) {
      const Options named = app.get_options(
          [&](const CLI::Option* o) { return o->get_group() == group && !o->get_positional(); });
      if (!group.empty() && !named.empty()) groups.emplace_back(group, named);
    }
    for (const auto& [group, options] : groups) {
      for (const CLI::Option* option : options) {
        for (const std::string& long_name : option->get_lnames())
          completions.emplace_back(*option, long_name);
      }
    }
  }
};

/// As roff writes it, whatever lines begin with.
std::string roff(const std::string& text) {
  std::string out;
  for (const std::string& line :
       CLI::detail::split(replaced(replaced(text, "\\", "\\e"), "-", "\\-"), '\n')) {
    if (!out.empty()) out += "\n";
    if (line.starts_with(".") || line.starts_with("'")) out += "\\&";
    out += line;
  }
  return out;
}

std::string manual_of(const Options& options) {
  std::string text;
  for (const CLI::Option* option : options) {
    std::string names = option->get_positional() ? option->get_name(true) : option->get_name(false, true);
    if (takes_value(*option) && !option->get_positional()) names += " " + option->get_type_name();
    if (takes_many(*option) && !names.ends_with("...")) names += " ...";
    // Help is broken into lines by hand; a manual page fills its own, but for lines that are indented.
    const std::string help = replaced(roff(option->get_description()), "\n  ", "\n.br\n  ");
    text += fmt::format(".TP\n.B {}\n{}\n", roff(names), help);
  }
  return text;
}

std::string manual_page(const CLI::App& program, const std::vector<Part>& commands) {
  std::string page = fmt::format(
      ".TH BINOSPLAT 1 \"\" \"binosplat {}\" \"User Commands\"\n.SH NAME\nbinosplat \\- "
      "both eyes of a 3D Gaussian Splatting model\n.ad l\n.SH SYNOPSIS\n.B binosplat\nSUBCOMMAND [OPTIONS] "
      "...\n.br\n.B binosplat\nMODEL\n.SH DESCRIPTION\n{}\n.PP\n{}\n",
      BINOSPLAT_VERSION, roff(program.get_description()), roff(program.get_footer()));
  for (const auto& [group, options] : Part(program).groups) page += manual_of(options);
  for (const Part& part : commands) {
    page += fmt::format(".SH binosplat {}\n{}.\n", part.name, roff(part.description));
    for (const auto& [group, options] : part.groups)
      page += (group.empty() ? "" : ".SS " + roff(group) + "\n") + manual_of(options);
    if (!part.footer.empty()) page += ".PP\n.nf\n" + roff(part.footer) + "\n.fi\n";
  }
  return page;
}

std::string bash_completion(const std::vector<Part>& parts) {
  std::vector<std::string> commands;
  std::string options, words;
  for (const Part& part : parts) {
    commands.push_back(part.name);
    std::vector<std::string> names;
    for (const Completion& one : part.completions) {
      names.push_back("--" + one.name);
      if (one.words_only) words += fmt::format("    ['{} --{}']='{}'\n", part.name, one.name, one.words);
    }
    options += fmt::format("    [{}]='{}'\n", part.name, fmt::join(names, " "));
  }
  return fmt::format(R"(# bash completion for binosplat
_binosplat() {{
  local -A options=(
{}  )
  local -A words=(
{}  )
  local commands='{}'
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} command=${{COMP_WORDS[1]}}
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W "$commands --help --version" -- "$word"))
  elif [[ -n ${{words["$command $before"]}} ]]; then
    COMPREPLY=($(compgen -W "${{words["$command $before"]}}" -- "$word"))
  elif [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "${{options[$command]}}" -- "$word"))
  fi
}}
# Where none of these is meant, a file is.
complete -o bashdefault -o default -F _binosplat binosplat
)",
                     options, words, fmt::join(commands, " "));
}

std::string fish_completion(const std::vector<Part>& parts) {
  const auto quoted = [](const std::string& text) {
    return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
  };
  std::string text = "# fish completion for binosplat\n";
  for (const Part& part : parts)
    text += fmt::format("complete -c binosplat -n __fish_use_subcommand -a {} -d {}\n", part.name,
                        quoted(part.description));
  for (const Part& part : parts) {
    for (const Completion& one : part.completions) {
      text += fmt::format("complete -c binosplat -n '__fish_seen_subcommand_from {}'", part.name);
      for (const std::string& name : one.option->get_snames()) text += " -s " + name;
      text += " -l " + one.name;
      if (takes_value(*one.option)) text += one.words_only ? " -x" : " -r";
      if (!one.words.empty()) text += fmt::format(" -a '{}'", one.words);
      text += fmt::format(" -d {}\n", quoted(one.help));
    }
  }
  return text;
}

std::string zsh_completion(const std::vector<Part>& parts) {
  const auto quoted = [](const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; };
  // What ends a part of a word's description.
  const auto escaped = [](std::string text) {
    for (const char* mark : {"\\", "[", "]", ":"}) text = replaced(text, mark, std::string("\\") + mark);
    return text;
  };
  std::string text =
      "#compdef binosplat\n# zsh completion for binosplat\n_binosplat() {\n  local -a commands=(\n";
  for (const Part& part : parts)
    text += fmt::format("    {}\n", quoted(part.name + ":" + escaped(part.description)));
  text +=
      "  )\n  if ((CURRENT == 2)); then\n    _describe command commands\n    _files\n    return\n  fi\n"
      "  local command=$words[2]\n  shift words\n  ((CURRENT--))\n  case $command in\n";
  for (const Part& part : parts) {
    text += fmt::format("    {})\n      _arguments \\\n", part.name);
    for (const Completion& one : part.completions) {
      std::string value;
      if (takes_value(*one.option))
        value = fmt::format(":{}:{}", escaped(one.option->get_type_name()),
                            one.words_only ? "(" + one.words + ")" : "_files");
      text += fmt::format("        {}{} \\\n", takes_many(*one.option) ? "\\*" : "",
                          quoted(fmt::format("--{}[{}]{}", one.name, escaped(one.help), value)));
    }
    text += "        '*:file:_files'\n      ;;\n";
  }
  return text + "  esac\n}\n_binosplat \"$@\"\n";
}

std::string text_for(const std::string& asked, const CLI::App& program) {
  // The options of `view` are those of the preview, a program of its own.
  RenderOptions values;
  CLI::App view("", "view");
  add_view_options(view, values);
  add_max_memory(view);
  add_quiet(view);
  std::vector<Part> parts;
  for (const CLI::App* sub : program.get_subcommands({})) {
    parts.emplace_back(sub->get_name() == "view" ? view : *sub);
    parts.back().description = sub->get_description();
  }
  if (asked == "man") return manual_page(program, parts);
  if (asked == "bash") return bash_completion(parts);
  if (asked == "fish") return fish_completion(parts);
  if (asked == "zsh") return zsh_completion(parts);
  fail("--print {}: expected man, bash, fish or zsh", asked);
}

}  // namespace

void add_print(CLI::App& program) {
  // As --version ends: well, and without a sub-command.
  const auto print = [&program](const std::string& asked) {
    throw CLI::CallForVersion(text_for(asked, program), 0);
  };
  program.add_option_function<std::string>("--print", print)->group("");
}

}  // namespace binosplat::app
