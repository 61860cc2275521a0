#pragma once
// Stores compiled programs on disk: NVIDIA's driver takes a third of a second to compile a shader, and a few
// milliseconds to load its binary. Also stores the results of tests of a driver.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "gl/functions.h"

namespace binosplat::gl {

/// A folder of program binaries. It reports no errors. If a binary is missing, damaged, refused by the
/// driver, or of another driver, the caller compiles the program. If the folder cannot be written, nothing is
/// stored.
class ProgramCache {
 public:
  /// An empty folder turns the cache off. `driver` names the driver and its version. Binaries of other
  /// drivers or versions are never loaded.
  ProgramCache(std::filesystem::path folder, std::string driver);

  /// The user's folder: $XDG_CACHE_HOME/binosplat/programs or ~/.cache/binosplat/programs. Empty if neither
  /// XDG_CACHE_HOME nor HOME is set.
  static std::filesystem::path default_folder();

  /// Loads the binary of a program that was compiled from `source`. If it returns false, compile the program.
  bool load(const Functions& gl, std::uint32_t program, const std::string& source) const;

  /// Stores a linked program. Does nothing if the driver has no program binaries.
  void store(const Functions& gl, std::uint32_t program, const std::string& source) const;

  /// Returns the result that store_result() stored for this test and driver, if any. `test_name` identifies
  /// the test, for example by its shaders' sources.
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
