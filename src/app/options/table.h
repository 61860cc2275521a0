#pragma once
// The table of all options. A row says what an option is called, where its value goes, and which commands
// take it; help, the manual page, checks, resumed runs and tests follow from rows.

#include <functional>
#include <string>
#include <vector>

#include "app/cli11_forward.h"
#include "app/options/options.h"

namespace binosplat::app {

/// Sets of commands, as bits.
namespace in {
constexpr unsigned render = 1, view = 2, profile = 4, bench = 8, calibrate = 16, trim = 32, refit = 64,
                   convert = 128, levels = 256, info = 512, compare = 1024, devices = 2048;
constexpr unsigned pictures = render | view | profile;
constexpr unsigned fits = trim | refit;
constexpr unsigned measures = bench | calibrate | fits;
constexpr unsigned models = pictures | measures | convert | levels | info;
constexpr unsigned all = models | compare | devices;
}  // namespace in

/// Properties of options, as bits.
namespace is {
constexpr unsigned required = 1;
constexpr unsigned input = 2;        // names a file or folder that is read
constexpr unsigned output = 4;       // names a folder that is written, or, where the command decides, a file
constexpr unsigned file_output = 8;  // names a file that is written: it is checked before the command works
/// Changes no result, but only where, how fast or how loudly a run works: a resumed run may differ in it.
constexpr unsigned no_result = 16;
}  // namespace is

/// The type of an option's value in help, and how CLI11 is told about the option.
struct Value {
  std::string type;
  std::function<CLI::Option*(CLI::App&, const std::string& name)> add;
  std::string choices = {};  // lines of help, one per choice
};

struct Row {
  std::string name;  // as CLI11 takes it, such as "-o,--output"; positional without dashes
  unsigned commands;
  Value value;
  std::string help;
  std::string otherwise = {};  // the default, in words
  unsigned flags = 0;
  std::string group = {};  // its heading in help

  /// The name that messages use: the long one.
  std::string word() const { return name.substr(name.find(',') + 1); }
};

/// All options. An option whose meaning depends on the command has several rows. `into` must outlive parsing.
std::vector<Row> option_table(Options& into);

/// Two options that cannot be given together, or of which one needs the other.
struct Conflict {
  std::string option;
  std::vector<std::string> others;
  std::string why;
  unsigned commands = in::all;
};
const std::vector<Conflict>& conflicts();
const std::vector<Conflict>& needs();

/// Replaces each name of an option in backticks, as in "a smaller `size`" or "`max_memory` MB", by "--size",
/// "--max-memory". Keeps `view` and others that are commands, too.
std::string with_options(std::string text);

/// Adds the options of a command.
void add_options(CLI::App& sub, unsigned command, Options& into);

/// Call it after parsing. Throws Error for options that conflict or lack another, if two outputs are the same
/// file, and as check_output() does. Records the files that are read as inputs (base/inputs.h), and sets
/// Options::given.
void finish_options(const CLI::App& sub, unsigned command, Options& o);

}  // namespace binosplat::app
