#pragma once
// Writes zip archives for tests.

#include <zip.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/program.h"

namespace binosplat::test {

using ZipEntries = std::vector<std::pair<std::string, std::string>>;  // name, content

inline void write_zip(const std::filesystem::path& path, const ZipEntries& entries, bool deflate = false) {
  int error = 0;
  zip_t* archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error);
  if (archive == nullptr) throw std::runtime_error("no archive " + path.string());
  for (const auto& [name, content] : entries) {
    zip_source_t* source = zip_source_buffer(archive, content.data(), content.size(), 0);
    const zip_int64_t at = zip_file_add(archive, name.c_str(), source, ZIP_FL_ENC_UTF_8);
    zip_set_file_compression(archive, static_cast<zip_uint64_t>(at), deflate ? ZIP_CM_DEFLATE : ZIP_CM_STORE,
                             0);
  }
  if (zip_close(archive) != 0) throw std::runtime_error("cannot write " + path.string());
}

/// Returns the bytes of such an archive.
inline std::string zipped(const ZipEntries& entries, bool deflate = false) {
  const TempFolder folder;
  write_zip(folder / "a.zip", entries, deflate);
  return read_text(folder / "a.zip");
}

/// Returns floats as bytes.
inline std::string bytes_of(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

/// Returns the parts of torch.jit's file of a module with these tensors that a reader examines.
inline ZipEntries torch_entries(const std::vector<std::vector<float>>& tensors) {
  ZipEntries entries{{"net/data.pkl", "\x80\x02."}, {"net/code/__torch__.py", "class Net"}};
  for (std::size_t i = 0; i < tensors.size(); ++i)
    entries.emplace_back("net/data/" + std::to_string(i), bytes_of(tensors[i]));
  return entries;
}

}  // namespace binosplat::test
