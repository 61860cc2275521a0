#pragma once
// A file that was opened to recognise its content, and that its reader goes on with.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/mapped_file.h"
#include "formats/containers/content.h"
#include "formats/containers/json_file.h"
#include "formats/models/ply_header.h"

namespace binosplat {

class OpenedFile : public MappedFile {
 public:
  explicit OpenedFile(const std::filesystem::path& named) : MappedFile(named), path(named) {}

  /// The file as JSON, or its header as a ply. Each is parsed once, on the first call. Throws Error as
  /// parse_json() and read_ply_header() do.
  const nlohmann::json& json() const {
    return json_ ? *json_ : json_.emplace(parse_json(path.string(), as_text(bytes())));
  }
  JsonValue root() const { return {path.string(), json()}; }
  const PlyHeader& ply() const { return ply_ ? *ply_ : ply_.emplace(read_ply_header(path, bytes())); }

  const std::filesystem::path path;
  const Content content = content_of(bytes());

 private:
  mutable std::optional<nlohmann::json> json_;
  mutable std::optional<PlyHeader> ply_;
};

}  // namespace binosplat
