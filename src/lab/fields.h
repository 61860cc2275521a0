#pragma once
// Converts structs to JSON and back. object(key, value, ...) returns a JSON object. A struct's function
// fields(io, it) names each member once, for writing and for reading.

#include <cmath>
#include <concepts>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>
#include <vector>

namespace binosplat::lab {

template <typename U, typename T>
concept Some = std::same_as<std::remove_const_t<U>, T>;

/// io(key, member, key, member, ...) writes the keys in this order and omits empty optionals.
struct FieldWriter {
  nlohmann::ordered_json& json;

  void operator()() const {}
  template <typename T, typename... Rest>
  void operator()(const char* key, const T& value, const Rest&... rest) const {
    if constexpr (requires { value.has_value(); }) {
      if (value) json[key] = *value;
    } else {
      json[key] = value;
    }
    (*this)(rest...);
  }
};

/// Reads the keys that exist, and leaves other members unchanged. In files, null represents a number that is
/// not finite.
struct FieldReader {
  const nlohmann::ordered_json& json;

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

nlohmann::ordered_json object(const auto&... keys_and_values) {
  nlohmann::ordered_json json;
  FieldWriter{json}(keys_and_values...);
  return json;
}

template <typename T>
concept Described = requires(T& it, nlohmann::ordered_json& json) {
  fields(FieldWriter{json}, it);
};

void to_json(nlohmann::ordered_json& json, const Described auto& it) { fields(FieldWriter{json}, it); }
void from_json(const nlohmann::ordered_json& json, Described auto& it) { fields(FieldReader{json}, it); }

}  // namespace binosplat::lab
