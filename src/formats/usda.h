#pragma once
// OpenUSD's text files (.usda): their prims, and the values as text. References to other files and variants
// are not resolved; `usdcat --flatten` does that.

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace binosplat {

/// A part of a file's text, parsed from its start. If the text does not fit a request, the request throws an
/// Error that names the file and the line.
class UsdaText {
 public:
  /// `text` must outlive this object.
  UsdaText(const std::string& source, std::string_view text)
      : source_(std::make_shared<std::string>(source)), all_(text), end_(text.size()) {}

  /// Returns the next character that is no blank and not in a comment, or 0 at the end.
  char next();
  bool take(char mark);
  void expect(char mark);

  /// Reads a name, with its colons, points and brackets; empty if there is none.
  std::string_view word();
  std::string_view quoted();
  /// Reads any value, without the blanks around it.
  UsdaText value();
  /// Reads a number, or `count` numbers in parentheses, and passes each to `put`.
  template <typename Put>
  void tuple(std::size_t count, const Put& put) {
    if (count == 1) return put(number());
    expect('(');
    for (std::size_t k = 0; k < count; ++k) {
      if (k > 0) expect(',');
      put(number());
    }
    take(',');
    expect(')');
  }
  /// Calls item() for each item of a list between these characters.
  template <typename Item>
  void list(char open, char close, const Item& item) {
    expect(open);
    while (!take(close)) {
      item();
      if (!take(',') && next() != close) expect(close);
    }
  }

  /// Read the rest of the text as one value, and throw if anything follows it.
  std::vector<double> numbers(std::size_t count) const;
  std::vector<float> tuples(std::size_t count) const;  // a list of tuples, flattened
  std::vector<std::string> texts() const;              // a list of texts
  std::string text() const;
  std::vector<UsdaText> samples() const;  // the values of timeSamples, in their order

  std::string_view rest() const { return all_.substr(at_, end_ - at_); }
  const std::string& source() const { return *source_; }

  /// Throws an Error: the text should continue with `wanted`.
  [[noreturn]] void fail_to_find(const std::string& wanted) const;
  template <typename... Args>
  [[noreturn]] void fail_here(fmt::format_string<Args...> format, Args&&... args) const {
    fail("{}, line {}: {}", *source_, line(), fmt::format(format, std::forward<Args>(args)...));
  }

 private:
  double number();
  void skip_string();
  void skip_item();
  std::size_t line() const;
  void finish();

  std::shared_ptr<const std::string> source_;
  std::string_view all_;  // the whole file, to count lines
  std::size_t at_ = 0, end_;
};

using UsdaValues = std::map<std::string, UsdaText, std::less<>>;

struct UsdaPrim {
  std::string specifier, type, name;  // specifier: def, over or class; all empty for the file itself
  UsdaText where;                     // the prim's beginning
  UsdaValues metadata, attributes;    // attributes: also "NAME.timeSamples", if the samples differ
  std::vector<UsdaPrim> prims = {};

  const UsdaText* attribute(std::string_view named) const;
};

/// Reads the file as a prim with its metadata and, unless `only_metadata`, its prims. `text` must outlive the
/// result. Throws Error naming the line.
UsdaPrim read_usda(const std::string& source, std::string_view text, bool only_metadata = false);

}  // namespace binosplat
