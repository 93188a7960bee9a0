#pragma once

#include <stdexcept>

/// What toml++ takes for granted about its input does not hold for every damaged file ("[=]"): by default that stops
/// the program, and with NDEBUG anything may happen. Here it is an exception. All files include toml++ through this
/// one.
namespace morphodesic::pipeline {
struct NotToml : std::runtime_error {
    NotToml() : std::runtime_error("this is not TOML") {}
};
}  // namespace morphodesic::pipeline

#undef NDEBUG
#define TOML_ASSERT(expression) ((expression) ? void() : throw ::morphodesic::pipeline::NotToml())
// The tables of characters of toml++ 3.3 reach "unreachable" code for a letter with an accent outside of strings, where
// TOML has none; there "no" is the answer.
// clang-format off
#include <toml++/impl/forward_declarations.h>
#undef TOML_UNREACHABLE
#define TOML_UNREACHABLE return false
#include <toml++/impl/unicode.h>
#undef TOML_UNREACHABLE
#define TOML_UNREACHABLE __builtin_unreachable()
#include <toml++/toml.h>
// clang-format on
