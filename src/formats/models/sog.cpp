#include "formats/models/sog.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/path_questions.h"
#include "formats/containers/zip_file.h"
#include "formats/models/sog_source.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

/// A .sog archive. Files are read by their names in meta.json, which may lie in a folder with the pictures.
class Archive {
 public:
  explicit Archive(const fs::path& path)
      : file_(path),
        zip_(path.string(), file_.bytes()),
        most_(file_.bytes().size() + (std::size_t{1} << 18)) {
    for (const std::string& name : zip_.names()) {
      const std::string below = plain(name);
      if (below.starts_with("__MACOSX/")) continue;  // macOS stores metadata there
      const auto [entry, is_new] = names_.emplace(below, name);
      if (!is_new && name_of(below) == meta_name) fail_many(path, entry->second, name);
    }
    folder_ = folder_of_meta(path);
  }

  /// Returns a file of the archive. Compressed pictures hardly shrink, so a size above most_ is an attack.
  std::vector<std::byte> read(const std::string& name) const {
    const std::string below = plain((folder_ / name).string());
    const auto entry = names_.find(below);
    return zip_.read(entry == names_.end() ? below : entry->second, most_);
  }

 private:
  /// Normalises a name: some programs write "\\" for "/", and "./" or "/" at the start.
  static std::string plain(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    return fs::path(name).lexically_normal().relative_path().generic_string();
  }

  static std::string name_of(const std::string& below) { return fs::path(below).filename().string(); }

  [[noreturn]] static void fail_many(const fs::path& path, const std::string& a, const std::string& b) {
    fail("{} holds several SOG models, {} and {}: an archive holds one; unpack it, and name the one to read",
         path, binosplat::quoted(a), binosplat::quoted(b));
  }

  /// Returns the folder of the meta.json that is nearest to the archive's root.
  fs::path folder_of_meta(const fs::path& path) const {
    std::vector<fs::path> found;
    for (const auto& [below, name] : names_) {
      if (name_of(below) == meta_name) found.emplace_back(below);
      if (name_of(below) != "lod-meta.json") continue;
      fail("{} holds a streamed SOG, {}, which is read from a folder: unpack it, and name its lod-meta.json",
           path, binosplat::quoted(name));
    }
    if (std::ranges::any_of(names_, [](const auto& name) { return name_of(name.first) == "data.pkl"; })) {
      fail(
          "{} is a checkpoint of PyTorch, which is not read. Export a ply: with nerfstudio by ns-export "
          "gaussian-splat --load-config config.yml --output-dir exports/splat, with gsplat's trainers by "
          "--save-ply, with 3DGRUT by export_ply.enabled=true",
          path);
    }
    if (found.empty()) {
      fail("{} is a zip archive without a meta.json, so it is not a SOG model; it holds {}", path,
           zip_.list());
    }
    const auto depth = [](const fs::path& meta) { return std::distance(meta.begin(), meta.end()); };
    std::ranges::stable_sort(found, {}, depth);
    if (found.size() > 1 && depth(found[0]) == depth(found[1]))
      fail_many(path, found[0].string(), found[1].string());
    return found[0].parent_path();
  }

  static constexpr const char* meta_name = "meta.json";

  MappedFile file_;
  ZipFile zip_;
  std::size_t most_;                          // largest size of an unpacked file
  std::map<std::string, std::string> names_;  // normalised names, and names in the archive
  fs::path folder_;
};

Model load_whole(const std::filesystem::path& path, const SogSource& source) {
  Model model;
  model.name = path.filename().string();
  model.format = source.flat() ? "SOG, flat Gaussians of 2DGS" : "SOG";
  model.degree = source.degree();
  model.set_training(source.training());
  model.resize(source.count());  // before the long work, for which memory may not suffice
  const auto textures = source.textures();
  const auto decode = [&] {
    model.resize(source.count());
    model.left_out = 0;
    std::vector<std::uint8_t> kept(source.count());
    const SogSource::Range all{0, source.count(), 0};
    source.decode(model, {&all, 1}, kept, *textures);
    keep_only(model, kept);
  };
  decode();
  if (choose_origin(model)) decode();
  return model;
}

}  // namespace

bool is_sog_meta(const nlohmann::json& root) { return root.is_object() && root.contains("means"); }

SogSource sog_in_folder(const std::filesystem::path& meta, const nlohmann::json& root) {
  const std::string source = meta.string();
  if (root.contains("opacities"))
    fail("{} belongs to gsplat's compression to PNG, not to a SOG: name its ply (by --save-ply)", source);
  const std::filesystem::path folder = meta.parent_path();
  return {source, root, [source, folder](const std::string& name) {
            if (!is_file(folder / name)) {
              fail("{}: its file {} is missing in {}; fetch or export it again", source,
                   binosplat::quoted(name), folder.empty() ? "this folder" : folder.string());
            }
            const MappedFile file(folder / name);
            return std::vector<std::byte>(file.bytes().begin(), file.bytes().end());
          }};
}

SogSource sog_in_archive(const std::filesystem::path& archive) {
  const std::vector<std::byte> meta = Archive(archive).read("meta.json");
  const nlohmann::json root = parse_json(archive.string() + ": meta.json", as_text(meta));
  // Opens the archive again for each file, because the library is not thread-safe, and a streamed SOG has too
  // many archives to keep them open.
  return {archive.string(), root, [archive](const std::string& name) { return Archive(archive).read(name); }};
}

SogSource open_sog(const OpenedFile& file) {
  if (file.content == Content::zip) return sog_in_archive(file.path);
  return sog_in_folder(file.path, file.json());
}

Model load_sog(const OpenedFile& file) { return load_whole(file.path, open_sog(file)); }

}  // namespace binosplat
