#include "datasets/muted_errors.h"

#include <iostream>
#include <streambuf>

namespace morphodesic::datasets {

namespace {

thread_local int muted = 0;

/// Hands everything on at once, or drops it. It keeps nothing itself, so that threads need not wait for each other.
class Gate : public std::streambuf {
public:
    explicit Gate(std::streambuf* to) : to_(to) {}

protected:
    int_type overflow(int_type c) override {
        if (muted > 0 || traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
        return to_->sputc(traits_type::to_char_type(c));
    }
    std::streamsize xsputn(const char* text, std::streamsize size) override {
        return muted > 0 ? size : to_->sputn(text, size);
    }
    int sync() override { return muted > 0 ? 0 : to_->pubsync(); }

private:
    std::streambuf* to_;
};

}  // namespace

MutedErrors::MutedErrors() {
    // Installed once and never taken away: another thread may be writing.
    static const auto* const installed = [] {
        auto* const gate = new Gate(std::cerr.rdbuf());
        std::cerr.rdbuf(gate);
        return gate;
    }();
    static_cast<void>(installed);
    ++muted;
}

MutedErrors::~MutedErrors() {
    --muted;
}

}  // namespace morphodesic::datasets
