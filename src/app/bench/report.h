#pragma once
// Tables, reports and comparisons of the commands that measure.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lab/page.h"
#include "lab/results.h"

namespace binosplat::app {

/// Writes the results to `name`, and the page to report.html with command and date. Each file is complete or
/// absent.
void save_report(const std::filesystem::path& folder, const std::string& name,
                 const nlohmann::ordered_json& results, const lab::Page& page);

void print_table(const std::vector<lab::Row>& rows, const std::vector<std::string>& columns);

/// The rows of the results.json of --compare; empty without it. Throws Error for another kind of file.
std::vector<lab::Row> rows_to_compare(const std::string& file);

/// Prints the changes since the `file` of --compare. Throws Error (fell_short) if a time rose by more than
/// --fail-if-slower, or cannot be compared.
void print_comparison(const std::string& file, const lab::RunComparison& found,
                      const std::optional<double>& fail_if_slower);

/// Adds command and date to a page.
lab::Page with_command(lab::Page page);

}  // namespace binosplat::app
