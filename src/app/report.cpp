#include "app/report.h"

#include "app/command.h"

namespace binosplat::app {

void save_report(const std::filesystem::path& folder, const std::string& name,
                 const nlohmann::ordered_json& results, const study::Page& page) {
  save_json(folder / name, results);
  const Uninterrupted hold;
  study::save_page(folder / "report.html", page, results);
}

}  // namespace binosplat::app
