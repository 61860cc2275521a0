#pragma once
// What the studies leave in a folder.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "lab/page.h"

namespace binosplat::app {

/// Writes the numbers, as `name`, and their page, report.html, with the command and the date; each whole or
/// not at all.
void save_report(const std::filesystem::path& folder, const std::string& name,
                 const nlohmann::ordered_json& results, const lab::Page& page);

/// The page with the facts that all have: the command and the date.
lab::Page with_command(lab::Page page);

}  // namespace binosplat::app
