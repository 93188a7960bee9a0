#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace morphodesic::tests {

/// What is wrong with a document by a schema file (draft 7); empty if nothing.
std::string schema_errors(const nlohmann::json& document, const std::filesystem::path& schema_file);

}  // namespace morphodesic::tests
