#include "datasets/content_digest.h"

#include <xxhash.h>

#include <bit>
#include <cstdint>
#include <fstream>
#include <memory>
#include <vector>

#include "datasets/read_error.h"

namespace morphodesic::datasets {

namespace {

struct FreeState {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};

class Digest {
public:
    Digest() : state_(XXH3_createState()) {
        if (!state_ || XXH3_128bits_reset(state_.get()) != XXH_OK) throw std::bad_alloc();
    }
    void add(const void* data, std::size_t bytes) { XXH3_128bits_update(state_.get(), data, bytes); }

    /// Same bytes on every machine: little endian, -0 as 0.
    void add_as_float(const std::vector<double>& values) {
        std::vector<unsigned char> bytes;
        bytes.reserve(4 * values.size());
        for (const double value : values) {
            const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value) + 0.0F);
            for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<unsigned char>(bits >> shift));
        }
        add(bytes.data(), bytes.size());
    }
    [[nodiscard]] std::string hexadecimal() const {
        XXH128_canonical_t canonical;
        XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
        std::string result;
        for (const unsigned char byte : canonical.digest) {
            result += "0123456789abcdef"[byte >> 4];
            result += "0123456789abcdef"[byte & 15];
        }
        return result;
    }

private:
    std::unique_ptr<XXH3_state_t, FreeState> state_;
};

}  // namespace

template <int Dim>
std::string content_digest(const LevelSet<Dim>& level_set, const ScalarField<Dim>& occlusion_mask) {
    Digest digest;
    const unsigned char head[] = {1, Dim, static_cast<unsigned char>(level_set.grid.level()),
                                  static_cast<unsigned char>(!occlusion_mask.values.empty())};
    digest.add(head, sizeof head);
    digest.add_as_float(level_set.values);
    digest.add_as_float(occlusion_mask.values);
    return digest.hexadecimal();
}

std::string file_digest(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw ReadError(file, "the file cannot be opened", "check that it exists and that you may read it");
    Digest digest;
    std::vector<char> buffer(1 << 18);
    while (in) {
        in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
        digest.add(buffer.data(), static_cast<std::size_t>(in.gcount()));
    }
    if (in.bad()) throw ReadError(file, "reading stopped with an error", "check the disk it lies on");
    return digest.hexadecimal();
}

template std::string content_digest<2>(const LevelSet<2>&, const ScalarField<2>&);
template std::string content_digest<3>(const LevelSet<3>&, const ScalarField<3>&);

}  // namespace morphodesic::datasets
