#include "analysis/npy.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <regex>
#include <stdexcept>

#include "analysis/csv.h"

namespace morphodesic::analysis {

static_assert(std::endian::native == std::endian::little, ".npy files are written as they lie in memory");

void write_npy(std::ostream& out, const NpyArray& array) {
    std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(array.rows) + ", " +
                         std::to_string(array.columns) + "), }";
    header.append((64 - (10 + header.size() + 1) % 64) % 64, ' ');  // data begin at a multiple of 64
    header += '\n';
    const auto length = static_cast<std::uint16_t>(header.size());
    out.write("\x93NUMPY\x01\x00", 8);
    out.put(static_cast<char>(length & 0xff));
    out.put(static_cast<char>(length >> 8));
    out << header;
    out.write(reinterpret_cast<const char*>(array.values.data()),
              static_cast<std::streamsize>(array.values.size() * sizeof(double)));
}

void write_npy(const std::filesystem::path& file, const DistanceMatrix& matrix) {
    std::filesystem::path draft = file;
    draft += ".part";
    {
        std::ofstream out(draft, std::ios::binary);
        write_npy(out, {matrix.size(), matrix.size(), matrix.dense()});
        out.close();
        if (!out) throw std::runtime_error(file.string() + ": cannot be written; check the folder and the free space");
    }
    std::filesystem::rename(draft, file);
}

NpyArray read_npy(std::istream& in, const std::string& source) {
    const auto fail = [&](const std::string& problem, const std::string& remedy) -> void {
        throw ParseError(source, 0, 0, problem, remedy);
    };
    char start[8];
    if (!in.read(start, 8) || std::memcmp(start, "\x93NUMPY", 6) != 0)
        fail("is not an .npy file", "save it with numpy.save");
    unsigned char length_bytes[4] = {};
    const int count = start[6] == 1 ? 2 : 4;
    if (!in.read(reinterpret_cast<char*>(length_bytes), count)) fail("is cut off", "save it again");
    std::size_t length = 0;
    for (int b = count; b-- > 0;) length = length * 256 + length_bytes[b];
    if (length > 65536) fail("has a header of " + std::to_string(length) + " bytes", "save it with numpy.save");
    std::string header(length, '\0');
    if (!in.read(header.data(), static_cast<std::streamsize>(length))) fail("is cut off", "save it again");
    std::smatch type, order, shape;
    if (!std::regex_search(header, type, std::regex("'descr': *'([^']*)'")) ||
        !std::regex_search(header, order, std::regex("'fortran_order': *(True|False)")) ||
        !std::regex_search(header, shape, std::regex("'shape': *\\(([0-9]{1,9}),? *([0-9]{0,9})\\)"))) {
        fail("its header is not that of a table of numbers", "save a two-dimensional float64 array");
    }
    if (type[1] != "<f8" && type[1] != "<f4") fail("holds numbers of type " + type[1].str(), "save it as float64");
    NpyArray array;
    array.rows = std::stoull(shape[1]);
    array.columns = shape[2].length() > 0 ? std::stoull(shape[2]) : 1;
    if (array.columns > 0 && array.rows > 2'000'000'000 / array.columns) fail("is too large", "save a smaller table");
    const std::size_t total = array.rows * array.columns, width = type[1] == "<f8" ? 8 : 4;
    std::vector<double> raw;
    std::vector<char> block(width * 65536);
    for (std::size_t done = 0; done < total;) {  // in blocks: a lying header must not allocate gigabytes
        const std::size_t part = std::min<std::size_t>(65536, total - done);
        if (!in.read(block.data(), static_cast<std::streamsize>(part * width))) fail("is cut off", "save it again");
        for (std::size_t k = 0; k < part; ++k) {
            if (width == 8) {
                double v;
                std::memcpy(&v, &block[k * 8], 8);
                raw.push_back(v);
            } else {
                float v;
                std::memcpy(&v, &block[k * 4], 4);
                raw.push_back(v);
            }
        }
        done += part;
    }
    if (order[1] == "False") {
        array.values = std::move(raw);
    } else {
        array.values.resize(total);
        for (std::size_t i = 0; i < array.rows; ++i) {
            for (std::size_t j = 0; j < array.columns; ++j)
                array.values[i * array.columns + j] = raw[j * array.rows + i];
        }
    }
    return array;
}

NpyArray read_npy(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw ParseError(file.string(), 0, 0, "cannot be opened", "check the name and the permission to read");
    return read_npy(in, file.string());
}

}  // namespace morphodesic::analysis
