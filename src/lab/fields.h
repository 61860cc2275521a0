#pragma once
// Makes JSON: object(name, value, ...) returns a JSON object. Converts structs to JSON and back: a struct's
// function fields(io, it) names each member once, for writing and for reading.

#include <cmath>
#include <concepts>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>

namespace binosplat::lab {

/// A JSON object of values by name. Unknown values are absent.
using Row = nlohmann::ordered_json;

/// Sets values by name. Omits empty optionals, and NaN that is not a JSON value. Infinity becomes null in
/// files.
template <typename T, typename... Rest>
void put(Row& row, const std::string& name, const T& value, const Rest&... rest) {
  if constexpr (requires { value.has_value(); }) {
    if (value) put(row, name, *value);
  } else if constexpr (std::is_floating_point_v<T>) {
    if (!std::isnan(value)) row[name] = static_cast<double>(value);
  } else {
    row[name] = value;
  }
  if constexpr (sizeof...(rest) > 0) put(row, rest...);
}

Row object(const auto&... names_and_values) {
  Row row = Row::object();
  put(row, names_and_values...);
  return row;
}

template <typename U, typename T>
concept Some = std::same_as<std::remove_const_t<U>, T>;

/// io(key, member, key, member, ...) writes the keys in this order and omits empty optionals.
struct FieldWriter {
  Row& json;

  void operator()() const {}
  template <typename T, typename... Rest>
  void operator()(const char* key, const T& value, const Rest&... rest) const {
    put(json, key, value);
    if constexpr (std::same_as<T, double>) json[key] = value;  // FieldReader reads NaN again
    (*this)(rest...);
  }
};

/// Reads the keys that exist, and leaves other members unchanged. In files, null represents a number that is
/// not finite.
struct FieldReader {
  const Row& json;

  void operator()() const {}
  template <typename T, typename... Rest>
  void operator()(const char* key, T& value, Rest&... rest) const {
    if (json.contains(key)) {
      if constexpr (std::same_as<T, double>) {
        value = json.at(key).is_null() ? NAN : json.at(key).template get<double>();
      } else {
        json.at(key).get_to(value);
      }
    }
    (*this)(rest...);
  }
};

template <typename T>
concept Described = requires(T& it, Row& json) {
  fields(FieldWriter{json}, it);
};

void to_json(Row& json, const Described auto& it) { fields(FieldWriter{json}, it); }
void from_json(const Row& json, Described auto& it) { fields(FieldReader{json}, it); }

}  // namespace binosplat::lab
