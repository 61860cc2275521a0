#pragma once
// What tells the variants of a shader apart.

#include <cstdint>
#include <span>

#include "gl/shader_source.h"

namespace binosplat::gl {

/// A number that a shader is compiled with.
struct Number {
  const char* name;
  std::uint64_t value;
  std::uint64_t count;         // how many values it may have, from 0 on
  const char* word = nullptr;  // the value's name, defined as NAME_NAME: files of the variant are called so
  bool is_real = false;        // bits of a float; 0 leaves the shader its own number
};

/// One number for all of them, which no other variant of the shader has: all list the same numbers in one
/// order. Throws std::logic_error for a value that its number may not have, and where 64 bits are too few.
std::uint64_t key_of(std::span<const Number> numbers);

Defines defines_of(std::span<const Number> numbers);

}  // namespace binosplat::gl
