#include "datasets/csv_rows.h"

#include <fstream>
#include <iterator>

#include "datasets/read_error.h"

namespace morphodesic::datasets {

std::vector<CsvRow> read_csv(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw ReadError(file, "the file cannot be opened", "check that it exists and that you may read it");
    std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);

    std::vector<CsvRow> rows;
    int line = 1, quote_line = 0;
    bool in_row = false, quoted = false;
    const auto row = [&]() -> CsvRow& {
        if (!in_row) rows.push_back({line, {""}});
        in_row = true;
        return rows.back();
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            if (c != '"') {
                rows.back().fields.back() += c;
            } else if (i + 1 < text.size() && text[i + 1] == '"') {
                rows.back().fields.back() += '"';
                ++i;
            } else {
                quoted = false;
            }
        } else if (c == '"' && row().fields.back().empty()) {
            quoted = true;
            quote_line = line;
        } else if (c == ',') {
            row().fields.emplace_back();
        } else if (c == '\n') {
            row();
            in_row = false;
        } else if (!(c == '\r' && (i + 1 == text.size() || text[i + 1] == '\n'))) {
            row().fields.back() += c;
        }
        if (c == '\n') ++line;
    }
    if (quoted) {
        throw ReadError(file, "the quote opened in line " + std::to_string(quote_line) + " is never closed",
                        "close it, and double quotes that are part of a name");
    }
    return rows;
}

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"') result += '"';
        result += c;
    }
    return result + '"';
}

}  // namespace morphodesic::datasets
