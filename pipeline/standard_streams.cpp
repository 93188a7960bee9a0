#include "pipeline/standard_streams.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <iostream>

namespace morphodesic::pipeline {
namespace {

/// Hands every piece of text on as printable().
class PrintableBuffer : public std::streambuf {
public:
    explicit PrintableBuffer(std::streambuf* to) : to_(to) {}

protected:
    std::streamsize xsputn(const char* text, std::streamsize count) override {
        const std::string shown = printable({text, static_cast<std::size_t>(count)});
        const auto size = static_cast<std::streamsize>(shown.size());
        return to_->sputn(shown.data(), size) == size ? count : 0;
    }
    int_type overflow(int_type c) override {
        if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
        const char text = traits_type::to_char_type(c);
        return xsputn(&text, 1) == 1 ? c : traits_type::eof();
    }
    int sync() override { return to_->pubsync(); }

private:
    std::streambuf* to_;
};

}  // namespace

void open_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) == -1 && errno == EBADF) {
            [[maybe_unused]] const int lowest_free = ::open("/dev/null", O_RDWR);
        }
    }
}

bool output_lost() {
    const bool arrived = std::cout.flush().good() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
    if (arrived) return false;
    pollfd out = {STDOUT_FILENO, POLLOUT, 0};
    return !(::poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0);
}

std::string printable(std::string_view text) {
    std::string shown;
    shown.reserve(text.size());
    const auto escape = [&](unsigned char c) {
        constexpr char digits[] = "0123456789abcdef";
        shown += {'\\', 'x', digits[c >> 4], digits[c & 15]};
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0;
        if ((c < 0x20 && c != '\n' && c != '\t') || c == 0x7f) {
            escape(c);
        } else if (c == 0xc2 && next >= 0x80 && next < 0xa0) {  // U+0080 to U+009F, control characters too
            escape(c);
            escape(next);
            ++i;
        } else {
            shown += text[i];
        }
    }
    return shown;
}

PrintableErrors::PrintableErrors() : filter_(std::make_unique<PrintableBuffer>(std::cerr.rdbuf())) {
    before_ = std::cerr.rdbuf(filter_.get());
}

PrintableErrors::~PrintableErrors() {
    std::cerr.rdbuf(before_);
}

}  // namespace morphodesic::pipeline
