#pragma once
// The numbers that distinguish the variants of a shader.

#include <cstdint>
#include <span>

#include "gl/shader_source.h"

namespace binosplat::gl {

/// A number that a shader is compiled with.
struct Number {
  const char* name;
  std::uint64_t value;
  std::uint64_t count;         // number of legal values, from 0 on
  const char* word = nullptr;  // the value's name, defined as NAME_NAME: it selects the variant's files
  bool is_real = false;        // the bits of a float; 0 keeps the shader's default
};

/// Combines all numbers into one, unique among the shader's variants: all list the same numbers in one order.
/// Throws std::logic_error for an illegal value, and if 64 bits are too few.
std::uint64_t key_of(std::span<const Number> numbers);

Defines defines_of(std::span<const Number> numbers);

}  // namespace binosplat::gl
