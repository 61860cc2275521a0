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

/// A sub-command with its options, in the order of its help.
struct Part {
  std::string name, description, footer;
  std::vector<std::pair<std::string, Options>> groups;  // no group's name: what stands alone, as SCENE

  Options options() const {
    Options all;
    for (const auto& group : groups) {
      for (const CLI::Option* option : group.second) {
        if (!option->get_lnames().empty()) all.push_back(option);
      }
    }
    return all;
  }
};

Part part_of(const CLI::App& app) {
  Part part{app.get_name(), app.get_description(), app.get_footer(), {}};
  const Options alone = app.get_options([](const CLI::Option* o) { return o->get_positional(); });
  if (!alone.empty()) part.groups.emplace_back("", alone);
  for (const std::string& group : app.get_groups()) {
    const Options named = app.get_options(
        [&](const CLI::Option* o) { return o->get_group() == group && !o->get_positional(); });
    if (!group.empty() && !named.empty()) part.groups.emplace_back(group, named);
  }
  return part;
}

/// With the options of `view`, which the preview has, a program of its own. Holds what options refer to.
struct CommandParts {
  RenderOptions values;
  CLI::App view;
  std::vector<Part> commands;

  explicit CommandParts(const CLI::App& program) : view("", "view") {
    add_view_options(view, values);
    add_max_memory(view);
    add_quiet(view);
    for (const CLI::App* sub : program.get_subcommands({})) {
      commands.push_back(part_of(sub->get_name() == "view" ? view : *sub));
      commands.back().description = sub->get_description();
    }
  }
};

/// The words that an option takes: "a|b|FILE" takes a and b.
std::vector<std::string> words_of(const CLI::Option& option) {
  std::vector<std::string> words;
  for (const std::string& word : CLI::detail::split(option.get_type_name(), '|')) {
    const auto is_of_word = [](unsigned char c) {
      return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '-';
    };
    if (!word.empty() && std::all_of(word.begin(), word.end(), is_of_word)) words.push_back(word);
  }
  return words;
}

// Whether it takes one of them and nothing else, as a file or a number.
bool takes_words_only(const CLI::Option& option) {
  const std::size_t choices = CLI::detail::split(option.get_type_name(), '|').size();
  return !words_of(option).empty() && words_of(option).size() == choices;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

// Which may as well be given again for each.
bool takes_many(const CLI::Option& option) { return option.get_items_expected_max() > 1; }

std::string replaced(const std::string& text, const std::string& what, const std::string& by) {
  return CLI::detail::find_and_replace(text, what, by);
}

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

/// Help is broken into lines by hand; a manual page fills its own, but for lines that are indented.
std::string filled(const std::string& help) { return replaced(roff(help), "\n  ", "\n.br\n  "); }

std::string manual_of(const CLI::Option& option) {
  std::string names = option.get_positional() ? option.get_name(true) : option.get_name(false, true);
  if (takes_value(option) && !option.get_positional()) names += " " + option.get_type_name();
  if (takes_many(option) && !names.ends_with("...")) names += " ...";
  return fmt::format(".TP\n.B {}\n{}\n", roff(names), filled(option.get_description()));
}

/// A help without its list of words, in one line, for a shell that shows it beside the option.
std::string in_one_line(const std::string& help) {
  return replaced(help.substr(0, help.find("\n  ")), "\n", " ");
}

std::string names_of(const Options& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return fmt::format("{}", fmt::join(names, " "));
}

}  // namespace

std::string manual_page(const CLI::App& program) {
  const CommandParts parts(program);
  std::string page = fmt::format(
      ".TH BINOSPLAT 1 \"\" \"binosplat {}\" \"User Commands\"\n.SH NAME\nbinosplat \\- "
      "both eyes of a 3D Gaussian Splatting model\n.ad l\n.SH SYNOPSIS\n.B binosplat\nSUBCOMMAND [OPTIONS] "
      "...\n.br\n.B binosplat\nMODEL\n.SH DESCRIPTION\n{}\n.PP\n{}\n",
      BINOSPLAT_VERSION, roff(program.get_description()), roff(program.get_footer()));
  for (const auto& [group, options] : part_of(program).groups) {
    for (const CLI::Option* option : options) page += manual_of(*option);
  }
  for (const Part& part : parts.commands) {
    page += fmt::format(".SH binosplat {}\n{}.\n", part.name, roff(part.description));
    for (const auto& [group, options] : part.groups) {
      if (!group.empty()) page += fmt::format(".SS {}\n", roff(group));
      for (const CLI::Option* option : options) page += manual_of(*option);
    }
    if (!part.footer.empty()) page += ".PP\n.nf\n" + roff(part.footer) + "\n.fi\n";
  }
  return page;
}

std::string bash_completion(const CLI::App& program) {
  const CommandParts parts(program);
  std::vector<std::string> commands;
  std::string options, words;
  for (const Part& part : parts.commands) {
    commands.push_back(part.name);
    options += fmt::format("    [{}]='{}'\n", part.name, names_of(part.options()));
    for (const CLI::Option* option : part.options()) {
      for (const std::string& name : option->get_lnames()) {
        if (takes_words_only(*option))
          words += fmt::format("    ['{} --{}']='{}'\n", part.name, name, fmt::join(words_of(*option), " "));
      }
    }
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

std::string fish_completion(const CLI::App& program) {
  const CommandParts parts(program);
  const auto quoted = [](const std::string& text) {
    return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
  };
  std::string text = "# fish completion for binosplat\n";
  for (const Part& part : parts.commands)
    text += fmt::format("complete -c binosplat -n __fish_use_subcommand -a {} -d {}\n", part.name,
                        quoted(part.description));
  for (const Part& part : parts.commands) {
    for (const CLI::Option* option : part.options()) {
      text += fmt::format("complete -c binosplat -n '__fish_seen_subcommand_from {}'", part.name);
      for (const std::string& name : option->get_snames()) text += " -s " + name;
      for (const std::string& name : option->get_lnames()) text += " -l " + name;
      const std::vector<std::string> taken = words_of(*option);
      if (takes_value(*option)) text += takes_words_only(*option) ? " -x" : " -r";
      if (!taken.empty()) text += fmt::format(" -a '{}'", fmt::join(taken, " "));
      text += fmt::format(" -d {}\n", quoted(in_one_line(option->get_description())));
    }
  }
  return text;
}

std::string zsh_completion(const CLI::App& program) {
  const CommandParts parts(program);
  const auto quoted = [](const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; };
  // What ends a part of a word's description.
  const auto escaped = [](std::string text) {
    for (const char* mark : {"\\", "[", "]", ":"}) text = replaced(text, mark, std::string("\\") + mark);
    return text;
  };
  std::string text =
      "#compdef binosplat\n# zsh completion for binosplat\n_binosplat() {\n  local -a commands=(\n";
  for (const Part& part : parts.commands)
    text += fmt::format("    {}\n", quoted(part.name + ":" + escaped(part.description)));
  text +=
      "  )\n  if ((CURRENT == 2)); then\n    _describe command commands\n    _files\n    return\n  fi\n"
      "  local command=$words[2]\n  shift words\n  ((CURRENT--))\n  case $command in\n";
  for (const Part& part : parts.commands) {
    text += fmt::format("    {})\n      _arguments \\\n", part.name);
    for (const CLI::Option* option : part.options()) {
      const std::string help = escaped(in_one_line(option->get_description()));
      std::string value;
      if (takes_value(*option)) {
        const std::vector<std::string> taken = words_of(*option);
        value =
            fmt::format(":{}:{}", escaped(option->get_type_name()),
                        takes_words_only(*option) ? fmt::format("({})", fmt::join(taken, " ")) : "_files");
      }
      for (const std::string& name : option->get_lnames())
        text += fmt::format("        {}{} \\\n", takes_many(*option) ? "\\*" : "",
                            quoted(fmt::format("--{}[{}]{}", name, help, value)));
    }
    text += "        '*:file:_files'\n      ;;\n";
  }
  return text + "  esac\n}\n_binosplat \"$@\"\n";
}

void add_print(CLI::App& program) {
  const auto print = [&program](const std::string& asked) {
    std::string text;
    if (asked == "man") text = manual_page(program);
    if (asked == "bash") text = bash_completion(program);
    if (asked == "fish") text = fish_completion(program);
    if (asked == "zsh") text = zsh_completion(program);
    if (text.empty()) fail("--print {}: expected man, bash, fish or zsh", asked);
    // As --version ends: well, and without a sub-command.
    throw CLI::CallForVersion(text, 0);
  };
  program.add_option_function<std::string>("--print", print)->group("");
}

}  // namespace binosplat::app
