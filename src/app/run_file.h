#pragma once
// A file in a folder of results that tells which run they are of, so that another goes on from them.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace binosplat::app {

/// Writes `file` if there is none: of runs that begin at the same time, whether alike or not, one does.
/// Throws Error as check_same_run() does where it tells of another run.
void claim_run(const std::filesystem::path& file, const nlohmann::ordered_json& run, const char* results);

/// Throws Error, naming what differs, if `file` tells of another run than `run`. `results` is what they are,
/// in the form "pictures".
void check_same_run(const std::filesystem::path& file, const nlohmann::ordered_json& run,
                    const char* results);

}  // namespace binosplat::app
