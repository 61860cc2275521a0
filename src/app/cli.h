#pragma once
// CLI11's names, for headers that need no more of it.

namespace CLI {
class App;
class Option;
class ParseError;
}  // namespace CLI
