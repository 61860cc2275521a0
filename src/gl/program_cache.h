#pragma once
// Compiled programs kept on disk: NVIDIA compiles a shader in a third of a second and loads its binary in a
// few milliseconds. It also keeps what running some programs showed about a driver.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "gl/functions.h"

namespace binosplat::gl {

/// A folder of program binaries. Nothing here is an error: a binary that is missing, damaged, of another
/// driver or refused is compiled again, and a folder that cannot be written is left alone.
class ProgramCache {
 public:
  /// No folder, no cache. `driver` names the driver and its version: binaries of another are never offered to
  /// it.
  ProgramCache(std::filesystem::path folder, std::string driver);

  /// The user's: $XDG_CACHE_HOME/binosplat/programs or ~/.cache/binosplat/programs; empty if there is no
  /// home.
  static std::filesystem::path default_folder();

  /// Loads the binary of a program that was made from `source` before. False: compile it.
  bool load(const Functions& gl, std::uint32_t program, const std::string& source) const;

  /// Keeps a linked program. Drivers without program binaries keep none.
  void store(const Functions& gl, std::uint32_t program, const std::string& source) const;

  /// What remember() was told of this driver; nothing: find it out. `asked` names the question, such as by
  /// the sources of the shaders that answer it.
  std::optional<std::string> recall(const std::string& asked) const;
  void remember(const std::string& asked, const std::string& found) const;

 private:
  std::string key(const std::string& source) const;
  std::filesystem::path file(const std::string& key) const;
  std::optional<std::string> read(const std::string& wanted) const;
  void write(const std::string& wanted, const std::string& kept) const;

  std::filesystem::path folder_;
  std::string driver_;
};

}  // namespace binosplat::gl
