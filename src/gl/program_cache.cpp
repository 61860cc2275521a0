#include "gl/program_cache.h"

#include <fmt/core.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <utility>

#include "base/error.h"
#include "base/output_file.h"

namespace binosplat::gl {

namespace {

// FNV-1a, for a file's name and its content's checksum. Names may collide, so a file also has the full key.
std::uint64_t hash(const std::string& text) {
  std::uint64_t h = 14695981039346656037ull;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return h;
}

}  // namespace

ProgramCache::ProgramCache(std::filesystem::path folder, std::string driver)
    : folder_(std::move(folder)), driver_(std::move(driver)) {}

std::filesystem::path ProgramCache::default_folder() {
  // Ignores a relative path, as XDG's specification requires.
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && std::filesystem::path(cache).is_absolute())
    return std::filesystem::path(cache) / "binosplat" / "programs";
  const char* home = std::getenv("HOME");
  if (home != nullptr && *home != '\0')
    return std::filesystem::path(home) / ".cache" / "binosplat" / "programs";
  return {};
}

std::string ProgramCache::key(const std::string& source) const {
  return fmt::format("binosplat program 3\n{}\n{}\n", driver_, source);
}

std::filesystem::path ProgramCache::file(const std::string& key) const {
  return folder_ / fmt::format("{:016x}.bin", hash(key));
}

// A file has the key, a checksum of the content, and the content.
std::optional<std::string> ProgramCache::read(const std::string& wanted) const {
  if (folder_.empty()) return std::nullopt;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file(wanted), ignored)) return std::nullopt;
  std::ifstream in(file(wanted), std::ios::binary);
  const std::string content((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  std::uint64_t sum = 0;
  const std::size_t head = wanted.size() + sizeof(sum);
  if (content.size() < head || content.compare(0, wanted.size(), wanted) != 0) return std::nullopt;
  std::memcpy(&sum, content.data() + wanted.size(), sizeof(sum));
  std::string kept = content.substr(head);
  if (sum != hash(kept)) return std::nullopt;
  return kept;
}

void ProgramCache::write(const std::string& wanted, const std::string& kept) const {
  if (folder_.empty()) return;
  const std::uint64_t sum = hash(kept);
  try {
    OutputFile out(file(wanted));
    out.write(wanted);
    out.write(std::as_bytes(std::span(&sum, 1)));
    out.write(kept);
    out.commit();
  } catch (const Error&) {
    // Without the cache, programs only start more slowly.
  }
}

bool ProgramCache::load(const Functions& gl, std::uint32_t program, const std::string& source) const {
  // NVIDIA's driver crashes on a damaged binary, so read() compares the checksum before.
  const std::optional<std::string> kept = read(key(source));
  GLenum format = 0;
  if (!kept || kept->size() <= sizeof(format)) return false;
  std::memcpy(&format, kept->data(), sizeof(format));
  gl.ProgramBinary(program, format, kept->data() + sizeof(format),
                   static_cast<GLsizei>(kept->size() - sizeof(format)));
  gl.GetError();  // clears the error of a format that the driver no longer supports
  GLint good = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &good);
  return good != 0;
}

void ProgramCache::store(const Functions& gl, std::uint32_t program, const std::string& source) const {
  GLint bytes = 0;
  gl.GetProgramiv(program, GL_PROGRAM_BINARY_LENGTH, &bytes);
  if (folder_.empty() || bytes <= 0) return;
  GLenum format = 0;
  std::string kept(sizeof(format) + static_cast<std::size_t>(bytes), '\0');
  gl.GetProgramBinary(program, bytes, nullptr, &format, kept.data() + sizeof(format));
  if (gl.GetError() != GL_NO_ERROR) return;
  std::memcpy(kept.data(), &format, sizeof(format));
  write(key(source), kept);
}

std::optional<std::string> ProgramCache::load_result(const std::string& test_name) const {
  return read(key("found by\n" + test_name));
}

void ProgramCache::store_result(const std::string& test_name, const std::string& found) const {
  write(key("found by\n" + test_name), found);
}

}  // namespace binosplat::gl
