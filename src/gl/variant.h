#pragma once
// The numbers that distinguish the variants of a shader.

#include <cstdint>
#include <span>

#include "gl/shader_source.h"

namespace binosplat::gl {

/// A number that a shader gets as a #define.
struct Number {
  const char* name;
  std::uint64_t value;
  std::uint64_t count;  // number of legal values, from 0 on
  /// The name of the value, or null. The shader gets it as <name>_NAME, and includes files by it.
  const char* word = nullptr;
  bool is_real = false;  // `value` is the bits of a float; 0 keeps the shader's default
};

/// Combines a variant's numbers into a key, unique among the shader's variants, which must all list the same
/// numbers in the same order. Throws std::logic_error for an illegal value, or if 64 bits are too few.
std::uint64_t key_of(std::span<const Number> numbers);

Defines defines_of(std::span<const Number> numbers);

}  // namespace binosplat::gl
