#include "formats/models/files_of_model.h"

#include <set>

#include "base/path_questions.h"
#include "formats/containers/json_file.h"
#include "formats/containers/zip_file.h"
#include "formats/models/model_file.h"
#include "formats/models/registry.h"
#include "formats/models/streamed_sog.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

Files named_by(const fs::path& path) {
  const OpenedFile file(path);
  const FormatRow* const format = format_of(file);
  return format != nullptr && format->named_by != nullptr ? format->named_by(file) : Files();
}

}  // namespace

Files pictures_of_sog(const fs::path& meta, const nlohmann::json& json) {
  const JsonValue root(meta.string(), json);
  Files files;
  for (const char* item : {"means", "scales", "quats", "sh0", "shN"}) {
    if (!root.has(item)) continue;
    for (const JsonValue& name : root.at(item).at("files").items())
      if (is_below_folder(name.text())) files.push_back(meta.parent_path() / name.text());
  }
  return files;
}

Files files_of_model(const fs::path& path) {
  const fs::path model = file_of(path);
  std::set<fs::path> found = {model};
  Files open(found.begin(), found.end());
  while (!open.empty()) {
    const fs::path next = std::move(open.back());
    open.pop_back();
    for (const fs::path& file : named_by(next)) {
      if (is_file(file) && found.insert(file).second) open.push_back(file);
    }
  }
  const auto run = is_streamed_sog(model) ? std::nullopt : find_training_run(model);
  if (run) found.insert(run->file);
  return {found.begin(), found.end()};
}

}  // namespace binosplat
