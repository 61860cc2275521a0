#pragma once
// Forward declarations of CLI11, for headers.

namespace CLI {
class App;
class Option;
class ParseError;
}  // namespace CLI
