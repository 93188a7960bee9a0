#include "pipeline/standard_streams.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <iostream>

namespace morphodesic::pipeline {

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

}  // namespace morphodesic::pipeline
