#include "gl/program_cache.h"

#include <fmt/core.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/output_file.h"

namespace binosplat::gl {

namespace {

// FNV-1a: names the file only; the whole key stands in the file and is compared.
std::uint64_t hash(const std::string& text) {
  std::uint64_t h = 14695981039346656037ull;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return h;
}

}  // namespace

ProgramCache::ProgramCache(std::filesystem::path folder, std::string driver)
    : folder_(std::move(folder)), driver_(std::move(driver)) {}

std::filesystem::path ProgramCache::default_folder() {
  // XDG's specification has relative paths ignored: they would mean another place in every folder.
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && std::filesystem::path(cache).is_absolute())
    return std::filesystem::path(cache) / "binosplat" / "programs";
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0')
    return std::filesystem::path(home) / ".cache" / "binosplat" / "programs";
  return {};
}

std::string ProgramCache::key(const std::string& source) const {
  return fmt::format("binosplat program 2\n{}\n{}\n", driver_, source);
}

std::filesystem::path ProgramCache::file(const std::string& key) const {
  return folder_ / fmt::format("{:016x}.bin", hash(key));
}

bool ProgramCache::load(const Functions& gl, std::uint32_t program, const std::string& source) const {
  if (folder_.empty()) return false;
  const std::string wanted = key(source);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file(wanted), ignored)) return false;
  std::ifstream in(file(wanted), std::ios::binary);
  const std::string content((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  GLenum format = 0;
  std::uint64_t sum = 0;
  const std::size_t head = wanted.size() + sizeof(sum) + sizeof(format);
  if (content.size() <= head || content.compare(0, wanted.size(), wanted) != 0) return false;
  std::memcpy(&sum, content.data() + wanted.size(), sizeof(sum));
  std::memcpy(&format, content.data() + wanted.size() + sizeof(sum), sizeof(format));
  const std::size_t start = head;
  // NVIDIA's driver crashes on a damaged binary: it must never see one.
  if (sum != hash(content.substr(start))) return false;
  gl.ProgramBinary(program, format, content.data() + start, static_cast<GLsizei>(content.size() - start));
  gl.GetError();  // a format that the driver no longer knows is recorded as an error
  GLint good = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &good);
  return good != 0;
}

void ProgramCache::store(const Functions& gl, std::uint32_t program, const std::string& source) const {
  GLint bytes = 0;
  gl.GetProgramiv(program, GL_PROGRAM_BINARY_LENGTH, &bytes);
  if (folder_.empty() || bytes <= 0) return;
  std::vector<char> binary(static_cast<std::size_t>(bytes));
  GLenum format = 0;
  gl.GetProgramBinary(program, bytes, nullptr, &format, binary.data());
  if (gl.GetError() != GL_NO_ERROR) return;
  const std::string wanted = key(source);
  try {
    OutputFile out(file(wanted));
    out.write(wanted);
    const std::uint64_t sum = hash(std::string(binary.begin(), binary.end()));
    out.write(std::as_bytes(std::span(&sum, 1)));
    out.write(std::as_bytes(std::span(&format, 1)));
    out.write(std::as_bytes(std::span(binary)));
    out.commit();
  } catch (const Error&) {
    // A cache that cannot be written only costs time.
  }
}

}  // namespace binosplat::gl
