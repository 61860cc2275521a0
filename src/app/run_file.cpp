#include "app/run_file.h"

#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/command.h"

namespace binosplat::app {

void claim_run(const std::filesystem::path& file, const nlohmann::ordered_json& run, const char* results) {
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored) || !save_json_as_first(file, run))
    check_same_run(file, run, results);
}

void check_same_run(const std::filesystem::path& file, const nlohmann::ordered_json& run,
                    const char* results) {
  const nlohmann::ordered_json saved = load_json(file);
  std::vector<std::string> others;
  for (const auto& [name, value] : run.items()) {
    if (!saved.is_object() || !saved.contains(name) || saved[name] != value) others.push_back(name);
  }
  if (others.empty() && saved.size() == run.size()) return;
  fail(
      "{} holds {} of another run: {} says other {}. Name another folder with -o, or remove the {} and that "
      "file",
      file.parent_path().string(), results, file.string(), fmt::join(others, ", "), results);
}

}  // namespace binosplat::app
