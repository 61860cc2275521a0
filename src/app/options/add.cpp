#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <sstream>

#include "app/command.h"
#include "app/command_line.h"
#include "app/models/model_files.h"
#include "app/options/values.h"
#include "base/error.h"
#include "base/inputs.h"
#include "formats/containers/size_limits.h"

namespace binosplat::app {

namespace fs = std::filesystem;

namespace {

/// Breaks a text into lines that fit beside the options' names.
std::string wrapped(const std::string& text) {
  constexpr std::size_t columns = 73;
  std::string lines;
  std::size_t length = 0;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!lines.empty()) lines += length + word.size() < columns ? ' ' : '\n';
    length = lines.ends_with('\n') || lines.empty() ? word.size() : length + 1 + word.size();
    lines += word;
  }
  return lines;
}

std::string help_of(const Row& row) {
  const std::string otherwise = row.otherwise.empty() ? "" : " (" + row.otherwise + ")";
  return wrapped(row.help + otherwise) + row.value.choices;
}

bool is_given(const CLI::App& sub, const std::string& name) {
  const CLI::Option* const option = sub.get_option_no_throw(name);
  return option != nullptr && option->count() > 0;
}

void check_conflicts(const CLI::App& sub, unsigned command) {
  for (const Conflict& row : conflicts()) {
    for (const std::string& other : row.others) {
      if ((row.commands & command) != 0 && is_given(sub, row.option) && is_given(sub, other))
        fail("{} with {}: {}: leave one of them out", row.option, other, row.why);
    }
  }
  for (const Conflict& row : needs()) {
    if ((row.commands & command) != 0 && is_given(sub, row.option) && !is_given(sub, row.others.front()))
      fail("{} needs {}: {}", row.option, row.others.front(), row.why);
  }
}

void note(const std::string& value) {
  protect_input(value);
  std::error_code ignored;
  if (!fs::is_directory(value, ignored)) return;
  protect_input(model_file(value));
  for (const char* name : {"meta.json", "lod-meta.json"}) protect_input(fs::path(value) / name);
}

}  // namespace

void add_options(CLI::App& sub, unsigned command, Options& into) {
  for (const Row& row : option_table(into)) {
    if ((row.commands & command) == 0) continue;
    CLI::Option* const option = row.value.add(sub, row.name)->description(help_of(row));
    if (!row.value.type.empty()) option->type_name(row.value.type);
    if (row.name.starts_with("-")) option->group(row.group);
    option->required((row.flags & is::required) != 0);
  }
}

void finish_options(const CLI::App& sub, unsigned command, Options& o) {
  check_conflicts(sub, command);
  std::map<fs::path, std::string> outputs;
  std::vector<std::string> files;  // among the outputs
  for (const Row& row : option_table(o)) {
    if ((row.commands & command) == 0 || !is_given(sub, row.word())) continue;
    const std::vector<std::string> values = sub.get_option(row.word())->results();
    if ((row.flags & is::no_result) == 0)
      o.given.push_back(fmt::format("{} {}", row.word(), fmt::join(values, " ")));
    for (const std::string& value : values) {
      if ((row.flags & is::input) != 0) note(value);
      if (row.word() == "--photos") protect_photos(value);
      if ((row.flags & is::file_output) != 0) files.push_back(value);
      if ((row.flags & (is::output | is::file_output)) == 0) continue;
      const auto [at, is_new] = outputs.try_emplace(place_of(value), row.word());
      if (!is_new) fail("{} {}: {} writes the same file; name another one", row.word(), value, at->second);
    }
  }
  for (const std::string& file : files) check_output(file);  // after all inputs are known
  constexpr double gaussian_bytes = 400.0;  // memory per Gaussian while a model of degree 3 is read
  if (o.max_memory) gaussians_allowed = static_cast<std::uint64_t>(1e6 * *o.max_memory / gaussian_bytes);
}

}  // namespace binosplat::app
