#include "formats/sog.h"

#include <mutex>

#include "base/error.h"
#include "base/mapped_file.h"
#include "formats/content.h"
#include "formats/json_file.h"
#include "formats/sog_source.h"
#include "formats/zip_file.h"

namespace binosplat {

namespace {

Model load_whole(const std::filesystem::path& path, const SogSource& source) {
  Model model;
  model.name = path.filename().string();
  model.format = "SOG";
  model.degree = source.degree();
  model.antialiased = source.antialiased();
  model.perspective = source.perspective();
  model.resize(source.count());
  std::vector<std::uint8_t> kept(source.count());
  const SogSource::Range all{0, source.count(), 0};
  source.decode(model, {&all, 1}, kept);
  keep_only(model, kept);
  return model;
}

}  // namespace

bool is_sog_meta(const nlohmann::json& root) { return root.is_object() && root.contains("means"); }

SogSource sog_in_folder(const std::filesystem::path& meta, const nlohmann::json& root) {
  const std::string source = meta.string();
  const std::filesystem::path folder = meta.parent_path();
  return {source, root, [source, folder](const std::string& name) {
            std::error_code ignored;
            if (!std::filesystem::is_regular_file(folder / name, ignored)) {
              fail("{}: its file {} is missing in {}; fetch or export it again", source,
                   binosplat::quoted(name), folder.empty() ? "this folder" : folder.string());
            }
            const MappedFile file(folder / name);
            return std::vector<std::byte>(file.bytes().begin(), file.bytes().end());
          }};
}

Model load_sog(const std::filesystem::path& meta, const nlohmann::json& root) {
  return load_whole(meta, sog_in_folder(meta, root));
}

Model load_sog(const std::filesystem::path& archive) {
  const MappedFile file(archive);
  const ZipFile zip(archive.string(), file.bytes());
  if (!zip.has("meta.json")) {
    fail("{} is a zip archive without a meta.json at its root, so it is no SOG model; it holds {}",
         archive.string(), zip.list());
  }
  // Pictures are packed already: deflate takes hardly anything off those that are no bombs.
  const std::size_t most = file.bytes().size() + (std::size_t{1} << 18);
  const std::vector<std::byte> meta = zip.read("meta.json", most);
  const nlohmann::json root = parse_json(archive.string() + ": meta.json", as_text(meta));
  // The library is not made for several threads.
  std::mutex reading;
  const SogSource source(archive.string(), root, [&](const std::string& name) {
    const std::lock_guard<std::mutex> lock(reading);
    return zip.read(name, most);
  });
  return load_whole(archive, source);
}

}  // namespace binosplat
