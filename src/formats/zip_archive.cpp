#include "formats/zip_archive.h"

#include <algorithm>

#include "base/error.h"
#include "formats/content.h"

namespace binosplat {

namespace {

// Whether a name would, unpacked into a folder, leave it.
bool leads_out(const std::string& name) {
  if (name.starts_with('/') || name.find('\\') != std::string::npos) return true;
  const std::filesystem::path path(name);
  return std::find(path.begin(), path.end(), "..") != path.end();
}

[[noreturn]] void fail_damaged(const std::filesystem::path& path, const std::string& why) {
  fail("{} is no whole zip archive: {}; fetch or export it again", path.string(), why);
}

}  // namespace

ZipArchive::ZipArchive(const std::filesystem::path& path, std::span<const std::byte> bytes) : path_(path) {
  const Content content = content_of(bytes);
  if (content != Content::zip) {
    fail("{}: expected a zip archive, but it looks like {}", path.string(), describe(content));
  }
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (source != nullptr) {
    archive_.reset(zip_open_from_source(source, ZIP_RDONLY, &error));
    if (archive_ == nullptr) zip_source_free(source);
  }
  const std::string why = zip_error_strerror(&error);
  zip_error_fini(&error);
  if (archive_ == nullptr) fail_damaged(path, why);
  const zip_int64_t count = zip_get_num_entries(archive_.get(), 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name = zip_get_name(archive_.get(), static_cast<zip_uint64_t>(i), 0);
    names_.emplace_back(name == nullptr ? "" : name);
    if (leads_out(names_.back())) {
      fail("{}: its entry {} leads out of the archive; no trainer writes such a file", path.string(),
           binosplat::quoted(names_.back()));
    }
  }
}

bool ZipArchive::has(const std::string& name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

std::vector<std::byte> ZipArchive::read(const std::string& name, std::size_t bytes_max) const {
  zip_stat_t status;
  zip_stat_init(&status);
  if (zip_stat(archive_.get(), name.c_str(), 0, &status) != 0) {
    fail("{}: the archive has no entry {}", path_.string(), binosplat::quoted(name));
  }
  if (status.size > bytes_max) {
    fail("{}: entry {} promises {} bytes; expected at most {}", path_.string(), binosplat::quoted(name),
         status.size, bytes_max);
  }
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(
      zip_fopen_index(archive_.get(), status.index, 0), zip_fclose);
  if (file == nullptr) {
    fail("{}: entry {} cannot be read: {}", path_.string(), binosplat::quoted(name),
         zip_strerror(archive_.get()));
  }
  // One byte more than promised: an entry that goes on is damaged, and its checksum is compared at its end.
  std::vector<std::byte> out(status.size + 1);
  std::size_t at = 0;
  while (at < out.size()) {
    const zip_int64_t got = zip_fread(file.get(), out.data() + at, out.size() - at);
    if (got < 0)
      fail_damaged(path_,
                   fmt::format("entry {}: {}", binosplat::quoted(name), zip_file_strerror(file.get())));
    if (got == 0) break;
    at += static_cast<std::size_t>(got);
  }
  if (at != status.size) {
    fail_damaged(path_, fmt::format("entry {} does not have the {} bytes it promises",
                                    binosplat::quoted(name), status.size));
  }
  out.pop_back();
  return out;
}

}  // namespace binosplat
