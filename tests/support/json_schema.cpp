#include "tests/support/json_schema.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

namespace morphodesic::tests {

std::string schema_errors(const nlohmann::json& document, const std::filesystem::path& schema_file) {
    std::ifstream file(schema_file, std::ios::binary);
    const nlohmann::json schema_json = nlohmann::json::parse(file);
    valijson::Schema schema;
    valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
    parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_json), schema);
    valijson::ValidationResults results;
    valijson::Validator validator;
    const valijson::adapters::NlohmannJsonAdapter target(document);
    if (validator.validate(schema, target, &results)) return {};
    std::string text = "invalid";
    for (const auto& error : results) {
        for (const auto& part : error.context) text += part;
        text += ": " + error.description + "\n";
    }
    return text;
}

}  // namespace morphodesic::tests
