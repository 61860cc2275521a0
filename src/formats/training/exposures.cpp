#include "formats/training/exposures.h"

#include <algorithm>

#include "formats/cameras/view_files.h"
#include "formats/containers/opened_file.h"

namespace binosplat {

namespace {

const glm::mat4x3 no_change(1.0f);

glm::mat4x3 read_exposure(const JsonValue& rows) {
  glm::mat4x3 exposure;
  rows.list_of(3);
  for (int i = 0; i < 3; ++i) {
    const glm::vec4 row(rows.at(static_cast<std::size_t>(i)).vector<4>());
    exposure[i] = glm::vec3(row);
    exposure[3][i] = row[3];
  }
  return exposure;
}

}  // namespace

Exposures::Exposures(const std::filesystem::path& file) : file_(file) {
  const OpenedFile opened(file);
  const JsonValue root = opened.root();
  if (!opened.json().is_object())
    root.fail_here("expected an object with three rows of four numbers for each view");
  for (const auto& [name, rows] : opened.json().items()) {
    by_name_.emplace(name, read_exposure(root.at(name)));
    const auto [stem, is_new] = by_stem_.emplace(stem_of(name), name);
    if (!is_new) stem->second.clear();
  }
}

const glm::mat4x3* Exposures::find(const std::string& view) const {
  auto found = by_name_.find(view);
  if (found == by_name_.end()) {
    const auto stem = by_stem_.find(stem_of(view));
    if (stem != by_stem_.end()) found = by_name_.find(stem->second);
  }
  return found == by_name_.end() ? nullptr : &found->second;
}

glm::mat4x3 Exposures::of(const std::string& view) const {
  const glm::mat4x3* const found = find(view);
  return found == nullptr ? no_change : *found;
}

bool Exposures::changes_any() const {
  return std::ranges::any_of(by_name_, [](const auto& one) { return one.second != no_change; });
}

}  // namespace binosplat
