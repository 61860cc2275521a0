// How much a reader must hold in mind at once: data members of a class, parameters of a function, lines of a
// class. Counted by a plain tokenizer, which knows enough of C++ for this tree: declarations at namespace and
// class scope; what stands in functions' bodies is left out.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "support/sources.h"

namespace {

constexpr int members_max = 25, parameters_max = 6, class_lines_max = 200;

/// Those that stay over a bound, as "room name", with the reason.
const std::map<std::string, std::string> larger = {
    {"gl on_message", "the driver calls it"},
    {"python settings_of", "its parameters are keywords of Python"},
    {"python make_camera", "its parameters are keywords of Python"},
};

struct Token {
  std::string text;
  int line;
};

/// Identifiers, numbers and single marks, without comments, preprocessor's lines and what stands in quotes;
/// "::" is one mark, "->" and "[[" two.
std::vector<Token> tokens_of(const std::string& text) {
  std::vector<Token> tokens;
  int line = 1;
  bool at_line_start = true;
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  const auto skip_to = [&](std::size_t from, const std::string& end) {
    const std::size_t found = std::min(text.find(end, from), text.size());
    line += static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(from),
                                        text.begin() + static_cast<std::ptrdiff_t>(found), '\n'));
    return std::min(found + end.size(), text.size());
  };
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '\n') {
      ++line, ++i;
      at_line_start = true;
    } else if (std::isspace(static_cast<unsigned char>(c))) {
      ++i;
    } else if (c == '#' && at_line_start) {
      while (i < text.size() && text[i] != '\n') {
        if (text[i] == '\\' && i + 1 < text.size()) line += text[++i] == '\n';
        ++i;
      }
    } else if (text.compare(i, 2, "//") == 0) {
      i = std::min(text.find('\n', i), text.size());
    } else if (text.compare(i, 2, "/*") == 0) {
      i = skip_to(i, "*/");
    } else if (text.compare(i, 2, "R\"") == 0) {
      const std::size_t open = text.find('(', i);
      i = skip_to(i, ")" + text.substr(i + 2, open - i - 2) + "\"");
      tokens.push_back({"\"", line});
    } else if (c == '"' || c == '\'') {
      for (++i; i < text.size() && text[i] != c; ++i) i += text[i] == '\\';
      ++i;
      tokens.push_back({"\"", line});
    } else {
      const std::size_t begin = i++;
      if (is_word(c)) {
        // A digit's apostrophe, as in 1'000, is part of the number.
        while (i < text.size() && (is_word(text[i]) || (text[i] == '\'' && std::isdigit(c)))) ++i;
      } else if (text.compare(begin, 2, "::") == 0) {
        ++i;
      }
      tokens.push_back({text.substr(begin, i - begin), line});
      at_line_start = false;
    }
  }
  return tokens;
}

struct Finding {
  std::string name, what;
  int line;
};

/// Reads the declarations of a file.
class Reader {
 public:
  explicit Reader(const std::string& text) : tokens_(tokens_of(text)) {}

  std::vector<Finding> findings() {
    while (at_ < tokens_.size()) {
      scope(false);
      ++at_;
    }
    return std::move(findings_);
  }

 private:
  /// A part of a declaration: a token, or all that stands between two brackets, named after the opening one.
  struct Part {
    std::string text;
    int count = 0;            // things in the brackets, which commas part
    bool is_pointer = false;  // the brackets begin with "*" or "&": a pointer to a function
  };
  using Parts = std::vector<Part>;

  const std::string& token(std::size_t ahead = 0) const {
    static const std::string none;
    return at_ + ahead < tokens_.size() ? tokens_[at_ + ahead].text : none;
  }
  int line() const { return tokens_[std::min(at_, tokens_.size() - 1)].line; }
  static bool is_word(const std::string& text) {
    return !text.empty() && (std::isalpha(static_cast<unsigned char>(text[0])) || text[0] == '_');
  }
  static bool is_one_of(const std::string& text, const std::set<std::string>& words) {
    return words.count(text) > 0;
  }

  void check(int count, int most, const std::string& name, const std::string& of, int where) {
    if (count > most) findings_.push_back({name, std::to_string(count) + " " + of, where});
  }

  /// What stands between the bracket at hand and its closing one, past which it goes.
  Part brackets() {
    Part part{token()};
    part.is_pointer = token(1) == "*" || token(1) == "&";
    const bool is_empty = token(1) == ")" || (token(1) == "void" && token(2) == ")");
    int depth = 0, angles = 0, commas = 0;
    do {
      if (is_one_of(token(), {"(", "{", "["})) ++depth;
      if (is_one_of(token(), {")", "}", "]"})) --depth;
      if (depth == 1 && token() == "<") ++angles;
      if (depth == 1 && token() == ">") angles = std::max(0, angles - 1);
      commas += depth == 1 && angles == 0 && token() == ",";
      ++at_;
    } while (depth > 0 && at_ < tokens_.size());
    part.count = is_empty ? 0 : commas + 1;
    return part;
  }

  void skip_angles() {
    int depth = 0;
    do {
      depth += (token() == "<") - (token() == ">");
      if (is_one_of(token(), {"(", "{"})) {
        brackets();
      } else {
        ++at_;
      }
    } while (depth > 0 && at_ < tokens_.size());
  }

  /// Reads the declarations up to the closing brace of a namespace or class; returns how many data members
  /// they are.
  int scope(bool of_class) {
    int members = 0;
    while (at_ < tokens_.size() && token() != "}") members += declaration(of_class);
    return members;
  }

  /// A class from its keyword on; returns whether it is defined here.
  bool class_definition() {
    const int begin = line();
    std::string name = "unnamed";
    for (++at_; at_ < tokens_.size() && !is_one_of(token(), {"{", ";", "=", "*", "&", ":", ")"});) {
      if (token() == "<") {
        skip_angles();
      } else if (is_one_of(token(), {"[", "("})) {
        brackets();
      } else {
        if (is_word(token()) && !is_one_of(token(), {"final", "alignas"})) name = token();
        ++at_;
      }
    }
    while (token() == ":" || (at_ < tokens_.size() && token() != "{" && tokens_[at_ - 1].text == ":")) {
      while (at_ < tokens_.size() && token() != "{") ++at_;  // its bases
    }
    if (token() != "{") return false;
    ++at_;
    const int members = scope(true);
    check(members, members_max, name, "data members", begin);
    check(line() - begin + 1, class_lines_max, name, "lines of a class", begin);
    ++at_;
    return true;
  }

  /// Reads one declaration and checks its parameters; returns how many data members it is.
  int declaration(bool of_class) {
    const int begin = line();
    Parts parts;
    bool is_initialized = false, in_initializers = false;
    for (; at_ < tokens_.size() && !is_one_of(token(), {";", "}"});) {
      const std::string text = token();
      const bool has_parameters = parameters_of(parts) != nullptr;
      if (text == "namespace" || (text == "extern" && token(2) == "{")) {
        while (at_ < tokens_.size() && !is_one_of(token(), {"{", ";"})) ++at_;
        if (token() == ";") break;
        ++at_, scope(false), ++at_;
        return 0;
      }
      if (is_one_of(text, {"public", "private", "protected"}) && token(1) == ":") {
        at_ += 2;
        return 0;
      }
      if (text == "template") {
        ++at_, skip_angles();
      } else if (is_one_of(text, {"class", "struct", "union"})) {
        if (class_definition()) parts.push_back({"class {"});
      } else if (text == "operator") {
        parts.push_back({"operator"});
        for (++at_; token() != "(" || token(1) == ")"; ++at_) {
          if (token() == "(" && token(2) != "(") break;
        }
      } else if (text == "{" && has_parameters && !is_initialized &&
                 !(in_initializers && is_word(parts.back().text))) {
        brackets();  // a body
        check(parameters_of(parts)->count, parameters_max, name_of(parts), "parameters", begin);
        return 0;
      } else if (is_one_of(text, {"(", "{", "["})) {
        parts.push_back(brackets());
      } else if (text == "<" && !is_initialized && !parts.empty() && is_word(parts.back().text)) {
        skip_angles();
      } else {
        is_initialized = text == "=" || (is_initialized && text != ",");
        in_initializers = in_initializers || (text == ":" && has_parameters);
        parts.push_back({text});
        ++at_;
      }
    }
    if (token() == ";") ++at_;
    if (const Part* parameters = parameters_of(parts)) {
      check(parameters->count, parameters_max, name_of(parts), "parameters", begin);
      return 0;
    }
    return of_class ? members_of(parts) : 0;
  }

  /// The brackets with a function's parameters, if the parts declare one.
  static const Part* parameters_of(const Parts& parts) {
    for (std::size_t k = 1; k < parts.size(); ++k) {
      const std::string& before = parts[k - 1].text;
      if (parts[k].text == "=" || is_one_of(before, {"using", "typedef", "friend", "static_assert"}))
        return nullptr;
      const bool is_call =
          is_one_of(before, {"alignas", "decltype", "noexcept", "explicit", "requires", "__attribute__"});
      if (parts[k].text == "(" && is_word(before) && !is_call && !parts[k].is_pointer) return &parts[k];
    }
    return nullptr;
  }
  static std::string name_of(const Parts& parts) { return (parameters_of(parts) - 1)->text; }

  static int members_of(const Parts& parts) {
    if (parts.size() < 2 || is_one_of(parts[0].text, {"using", "typedef", "friend", "static_assert", "enum"}))
      return 0;
    int count = 1;
    for (const Part& part : parts) {
      if (part.text == "static") return 0;
      count += part.text == ",";
    }
    return count;
  }

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  std::vector<Finding> findings_;
};

using binosplat::test::Sources;

/// What is over a bound: the findings by "room name", and where and how much.
std::map<std::string, std::string> too_large(const Sources& sources) {
  std::map<std::string, std::string> found;
  for (const auto& [path, text] : sources) {
    const std::string below = path.starts_with("src/") ? path.substr(4) : path;
    const std::string room = below.substr(0, below.find('/'));
    for (const Finding& finding : Reader(text).findings()) {
      std::string& all = found[room + " " + finding.name];
      all += (all.empty() ? "" : ", ") + path + ":" + std::to_string(finding.line) + ": " + finding.what;
    }
  }
  return found;
}

TEST(Sizes, AreWhatAReaderCanHold) {
  const auto found = too_large(
      binosplat::test::sources_of_tree({"src", "stereo", "shaders/shared", "include"}, {".cpp", ".h"}));
  for (const auto& [name, places] : found) {
    if (!larger.count(name)) ADD_FAILURE() << name << ": " << places;
  }
}

std::size_t found_in(const std::string& text) { return too_large({{"src/base/a.h", text}}).size(); }

/// A text once for every number below `count`, with the number in place of "%".
std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int k = 0; k < count; ++k) {
    for (const char c : text) all += c == '%' ? std::to_string(k) : std::string(1, c);
  }
  return all;
}

TEST(Sizes, PlantedMembersAreCaught) {
  for (const std::string member :
       {"int a%;", "std::map<int, std::vector<int>> a% = {{1, {2, 3}}};", "double (*a%)(int, int) = nullptr;",
        "struct { int x, y; } a%;", "alignas(16) float a%[3];", "std::function<void(int)> a%{f(1, 2)};",
        "template_t<(3 > 2)> a%; enum class E% { x, y }; void f%(int a, int b);",
        "const char* a% = \"int b;\";",
        "mutable std::mutex a%;  // int b;\n public:\n  int f%() const { int x; return x; }",
        "static int s% = 1; using T% = int; friend class F%; int a%;",
        "Inner% a%; struct Inner% { int a, b; };"}) {
    const std::string begin = "namespace a {\nclass Many final : public Base<int> {\n", end = "};\n}\n";
    EXPECT_EQ(found_in(begin + repeated(member, members_max) + end), 0u) << member;
    EXPECT_EQ(found_in(begin + repeated(member, members_max) + "int more;" + end), 1u) << member;
  }
  EXPECT_EQ(found_in("struct A { int a0" + repeated(", b%", members_max) + "; };"), 1u);
  EXPECT_EQ(found_in("struct A { struct B { int a0" + repeated(", b%", members_max) + "; }; };"), 1u)
      << "within";
}

TEST(Sizes, PlantedParametersAreCaught) {
  const std::string six = "int a, std::map<int, int> b = {}, T (*c)(int, int), int d, int e, int f";
  for (const std::string function :
       {"void f(%);", "template <int a, int b> auto f(%) -> std::pair<int, int>;",
        "int f(%) { return g(1, 2, 3); }", "bool operator()(%) const;",
        "[[nodiscard]] static int f(%) noexcept(true) { if (a) { b(); } }",
        "struct A { A(%) : a_(a), b_{b} { f(); } int a_, b_; };", "A::A(%) : a_(a), b_{1, 2, 3} {}",
        "class A : B { virtual void f(%) = 0; };", "namespace { inline void A::f(%) {} }",
        "extern \"C\" { void f(%); }"}) {
    for (const std::string& more : {std::string(), std::string(", int g = 0")}) {
      const std::string whole = std::string(function).replace(function.find('%'), 1, six + more);
      EXPECT_EQ(found_in(whole + "\nint f(int a);"), more.empty() ? 0u : 1u) << whole;
    }
  }
  EXPECT_EQ(found_in("int f() { return g(1, 2, 3, 4, 5, 6, 7); }\nint a = g(1, 2, 3, 4, 5, 6, 7);"), 0u)
      << "calls";
  EXPECT_EQ(
      found_in("#define F(a, b, c, d, e, f, g) \\\n  x\nusing F = int(int, int, int, int, int, int, int);"),
      0u);
}

TEST(Sizes, PlantedLongClassesAreCaught) {
  const std::string lines(class_lines_max - 2, '\n');
  EXPECT_EQ(found_in("class A {" + lines + "\n};"), 0u);
  EXPECT_EQ(found_in("class A {" + lines + "\n\n};"), 1u);
  EXPECT_EQ(found_in("class A {" + lines + "};\nclass B {/*\n\n*/};"), 0u);
}

}  // namespace
