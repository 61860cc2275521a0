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

/// Prints a table, its columns aligned.
void print_table(const lab::Table& table);

/// Adds --compare and --fail-if-slower; both must outlive the parsing.
void add_compare_options(CLI::App& sub, std::string& file, std::optional<double>& fail_if_slower);

/// The rows of the results.json that --compare names. Throws Error if it is none.
std::vector<lab::Row> load_rows(const std::filesystem::path& file);

/// Prints what changed since the `file` of --compare. Throws Error (fell_short) where something became slower
/// than --fail-if-slower allows, or its times cannot be compared.
void print_comparison(const std::string& file, const lab::RunComparison& found,
                      const std::optional<double>& fail_if_slower);

/// The page with the facts that all have: the command and the date.
lab::Page with_command(lab::Page page);

}  // namespace binosplat::app
