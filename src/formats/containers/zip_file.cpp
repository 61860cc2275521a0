#include "formats/containers/zip_file.h"

#include <zip.h>

#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "formats/containers/content.h"
#include "formats/containers/gzip.h"

namespace binosplat {

bool is_below_folder(const std::string& name) {
  const std::filesystem::path path(name);
  return !name.empty() && name.find('\0') == std::string::npos && name.find('\\') == std::string::npos &&
         path.is_relative() &&
         std::none_of(path.begin(), path.end(), [](const auto& part) { return part == ".."; });
}

std::vector<std::byte> zip_of(const ZipEntries& entries) {
  constexpr zip_uint16_t first_day = 1 << 5 | 1;  // 1 January 1980, zip's earliest date
  zip_source_t* out = zip_source_buffer_create(nullptr, 0, 0, nullptr);
  if (out != nullptr) zip_source_keep(out);
  zip_t* archive = out == nullptr ? nullptr : zip_open_from_source(out, ZIP_TRUNCATE, nullptr);
  bool good = archive != nullptr;
  for (const auto& [name, bytes] : entries) {
    if (!good) break;
    zip_source_t* source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
    const zip_int64_t at = zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (at < 0) zip_source_free(source);
    const auto index = static_cast<zip_uint64_t>(at);
    good = at >= 0 && zip_set_file_compression(archive, index, ZIP_CM_STORE, 0) == 0 &&
           zip_file_set_dostime(archive, index, 0, first_day, 0) == 0;
  }
  good = good && zip_close(archive) == 0;
  if (!good && archive != nullptr) zip_discard(archive);
  std::vector<std::byte> bytes;
  zip_stat_t stat;
  if (good && zip_source_stat(out, &stat) == 0 && zip_source_open(out) == 0) {
    bytes.resize(stat.size);
    good = zip_source_read(out, bytes.data(), bytes.size()) == static_cast<zip_int64_t>(bytes.size());
    zip_source_close(out);
  }
  if (out != nullptr) zip_source_free(out);
  if (!good || bytes.empty()) throw Error(ExitCode::out_of_memory, "no memory for a zip archive");
  return bytes;
}

void ZipFile::Close::operator()(zip* archive) const { zip_discard(archive); }

ZipFile::ZipFile(std::string source, std::span<const std::byte> bytes)
    : source_(std::move(source)), bytes_(bytes.size()) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* data = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (data != nullptr) archive_.reset(zip_open_from_source(data, ZIP_RDONLY, &error));
  if (!archive_) {
    if (data != nullptr) zip_source_free(data);
    const std::string reason = zip_error_strerror(&error);
    zip_error_fini(&error);
    fail("{}: the zip archive is damaged or cut short: {}; fetch or export it again", source_, reason);
  }
  zip_error_fini(&error);
}

bool ZipFile::has(const std::string& name) const {
  return zip_name_locate(archive_.get(), name.c_str(), ZIP_FL_ENC_GUESS) >= 0;
}

std::vector<std::string> ZipFile::names() const {
  std::vector<std::string> names;
  const zip_int64_t count = zip_get_num_entries(archive_.get(), 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const char* name = zip_get_name(archive_.get(), static_cast<zip_uint64_t>(i), 0);
    names.emplace_back(name != nullptr ? name : "");
  }
  return names;
}

std::string ZipFile::list() const {
  constexpr std::size_t shown = 8;
  const std::vector<std::string> all = names();
  std::string text;
  for (std::size_t i = 0; i < std::min(all.size(), shown); ++i)
    text += (text.empty() ? "" : ", ") + binosplat::quoted(all[i]);
  if (all.size() > shown) text += fmt::format(" and {} more", all.size() - shown);
  return text.empty() ? "nothing" : text;
}

void ZipFile::fail_entry(const std::string& name, const std::string& reason) const {
  fail("{}: its file {} {}", source_, binosplat::quoted(name), reason);
}

std::vector<std::byte> ZipFile::read(const std::string& name, std::size_t bytes_max) const {
  const zip_int64_t index = zip_name_locate(archive_.get(), name.c_str(), ZIP_FL_ENC_GUESS);
  if (index < 0)
    fail("{}: there is no file {} in the archive; it holds {}", source_, binosplat::quoted(name), list());
  const auto at = static_cast<zip_uint64_t>(index);
  zip_stat_t status;
  zip_stat_init(&status);
  constexpr zip_uint64_t needed = ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD;
  if (zip_stat_index(archive_.get(), at, 0, &status) != 0 || (status.valid & needed) != needed)
    fail_entry(name, "has no size; the archive is damaged");
  if (status.comp_method != ZIP_CM_STORE && status.comp_method != ZIP_CM_DEFLATE) {
    fail_entry(name, fmt::format("is compressed by method {}; only stored and deflated ones can be read",
                                 status.comp_method));
  }
  if (status.comp_size > bytes_) {
    fail_entry(name, fmt::format("promises {} compressed bytes in an archive of {}; it is damaged",
                                 status.comp_size, bytes_));
  }
  if (status.size / max_deflate_growth > status.comp_size) {
    fail_entry(name, fmt::format("promises {} bytes, which {} compressed ones cannot hold; it is damaged",
                                 status.size, status.comp_size));
  }
  if (status.size > bytes_max)
    fail_entry(name, fmt::format("promises {} bytes; expected at most {}", status.size, bytes_max));
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> entry(zip_fopen_index(archive_.get(), at, 0),
                                                                &zip_fclose);
  if (!entry) fail_entry(name, fmt::format("cannot be read: {}", zip_strerror(archive_.get())));
  // Room for one byte more than promised: reading then reaches the end, where the library tests the checksum.
  std::vector<std::byte> bytes(status.size + 1);
  std::size_t filled = 0;
  for (zip_int64_t n = 1; n > 0 && filled < bytes.size();) {
    n = zip_fread(entry.get(), bytes.data() + filled, bytes.size() - filled);
    if (n < 0) fail_entry(name, fmt::format("is damaged: {}", zip_file_strerror(entry.get())));
    filled += static_cast<std::size_t>(n);
  }
  if (filled != status.size) {
    fail_entry(name, fmt::format("is damaged: it promises {} bytes and has {}", status.size,
                                 filled > status.size ? "more" : fmt::format("{}", filled)));
  }
  bytes.resize(filled);
  return bytes;
}

}  // namespace binosplat
