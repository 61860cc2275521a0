#pragma once
// What measurements print, leave in a folder, and are compared with.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/cli.h"
#include "lab/page.h"
#include "lab/results.h"

namespace binosplat::app {

/// Writes the numbers, as `name`, and their page, report.html, with the command and the date; each whole or
/// not at all.
void save_report(const std::filesystem::path& folder, const std::string& name,
                 const nlohmann::ordered_json& results, const lab::Page& page);

/// The lines of a table whose first column is at the left of its place, and the others at the right.
std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows);
void print_table(const lab::Table& table);

/// Adds --compare and --fail-if-slower; both must outlive the parsing.
void add_compare_options(CLI::App& sub, std::string& file, std::optional<double>& fail_if_slower);

/// The rows of the results.json that --compare names; none without it. Throws Error where it is no such file,
/// and for --fail-if-slower without it.
std::vector<lab::Row> rows_to_compare(const std::string& file, const std::optional<double>& fail_if_slower);

/// Prints what changed since the `file` of --compare. Throws Error (fell_short) where something became slower
/// than --fail-if-slower allows, or its times cannot be compared.
void print_comparison(const std::string& file, const lab::RunComparison& found,
                      const std::optional<double>& fail_if_slower);

/// The page with the facts that all have: the command and the date.
lab::Page with_command(lab::Page page);

}  // namespace binosplat::app
