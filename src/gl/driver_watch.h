#pragma once
// Ends the program if a driver hangs.

#include <chrono>
#include <thread>

namespace binosplat::gl {

/// For the program, not for the library: keep the result while a context is made. If that takes longer than
/// `patience`, one line names the environment's variables that choose drivers, and the program ends with
/// exit code 3. On some machines Mesa's zink never returns.
[[nodiscard]] std::jthread watch_driver(std::chrono::milliseconds patience = std::chrono::seconds(20));

}  // namespace binosplat::gl
