#pragma once
// Stores compiled programs on disk: NVIDIA's driver takes a third of a second to compile a shader, and a few
// milliseconds to load its binary. Also stores the results of tests of a driver.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "gl/functions.h"

namespace binosplat::gl {

/// A folder of program binaries. Reports no errors: if a binary is missing, damaged, refused by the driver,
/// or of another driver, the caller compiles the program. If the folder cannot be written, nothing is stored.
class ProgramCache {
 public:
  /// An empty folder turns the cache off. `driver` names the driver and its version. Binaries of other
  /// drivers or versions are never loaded.
  ProgramCache(std::filesystem::path folder, std::string driver);

  /// $XDG_CACHE_HOME/binosplat/programs or $HOME/.cache/binosplat/programs; empty if neither variable is set.
  static std::filesystem::path default_folder();

  /// Loads the binary of a program that was compiled from `source`. If it returns false, compile the program.
  bool load(const Functions& gl, std::uint32_t program, const std::string& source) const;

  /// Stores a linked program. Does nothing if the driver has no program binaries.
  void store(const Functions& gl, std::uint32_t program, const std::string& source) const;

  /// The stored result of this test and driver, if any. `test_name` may be the sources of the test's shaders.
  std::optional<std::string> load_result(const std::string& test_name) const;
  void store_result(const std::string& test_name, const std::string& found) const;

 private:
  std::string key(const std::string& source) const;
  std::filesystem::path file(const std::string& key) const;
  std::optional<std::string> read(const std::string& wanted) const;
  void write(const std::string& wanted, const std::string& kept) const;

  std::filesystem::path folder_;
  std::string driver_;
};

}  // namespace binosplat::gl
