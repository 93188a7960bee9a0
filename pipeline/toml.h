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
#include <toml++/toml.h>
