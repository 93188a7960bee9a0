#include "datasets/vdb_values.h"

#include <fcntl.h>
#include <openvdb/io/Stream.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string_view>

#include "datasets/interruption.h"
#include "datasets/read_error.h"
#include "datasets/vdb_check.h"

namespace morphodesic::datasets {
namespace {

namespace fs = std::filesystem;

constexpr const char* remedy = "export or download the file again";
constexpr unsigned patience = 300;  // seconds

/// What the reading process sends first: whether a stream follows or a sentence.
enum class Answer : char { grid = 'g', nothing = 'n', fault = 'f' };

/// The values as floats, also those that are not active, such as the inside of a level set; null for other grids.
template <class Grid>
openvdb::FloatGrid::Ptr converted(const openvdb::GridBase::Ptr& base) {
    const auto grid = openvdb::gridPtrCast<Grid>(base);
    return grid ? std::make_shared<openvdb::FloatGrid>(*grid) : nullptr;
}

openvdb::FloatGrid::Ptr float_grid(const openvdb::GridBase::Ptr& base) {
    if (auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(base)) return grid;
    if (const auto mask = openvdb::gridPtrCast<openvdb::MaskGrid>(base)) {
        auto tree = std::make_shared<openvdb::FloatTree>(mask->tree(), 0.0F, 1.0F, openvdb::TopologyCopy());
        auto grid = openvdb::FloatGrid::create(tree);
        grid->setTransform(mask->transformPtr());
        return grid;
    }
    auto grid = converted<openvdb::DoubleGrid>(base);
    if (!grid) grid = converted<openvdb::Int32Grid>(base);
    if (!grid) grid = converted<openvdb::Int64Grid>(base);
    if (!grid) grid = converted<openvdb::BoolGrid>(base);
    return grid;
}

openvdb::GridBase::Ptr first_grid(std::string content) {
    std::istringstream in(std::move(content));
    // At the end of damaged values, too, the library would read on.
    in.exceptions(std::ios::eofbit | std::ios::failbit | std::ios::badbit);
    openvdb::io::Stream stream(in, false);
    const auto grids = stream.getGrids();
    return grids && !grids->empty() ? grids->front() : nullptr;
}

/// Reads the values and writes them down anew, or says what is wrong.
std::string answer_to(std::string content) {
    const auto say = [](Answer answer, const std::string& text) { return static_cast<char>(answer) + text; };
    try {
        const auto grid = float_grid(first_grid(std::move(content)));
        if (!grid) return say(Answer::nothing, "");
        std::ostringstream out;
        openvdb::io::Stream stream(out);
        stream.setCompression(openvdb::io::COMPRESS_ACTIVE_MASK);
        stream.write(openvdb::GridCPtrVec{grid});
        return say(Answer::grid, out.str());
    } catch (const std::ios_base::failure&) {
        return say(Answer::fault, "its values break off");
    } catch (const std::bad_alloc&) {
        return say(Answer::fault, "it promises more than memory can hold");
    } catch (const std::exception& error) {
        return say(Answer::fault, "it cannot be read (" + shortened(error.what()) + ")");
    }
}

/// No more memory than any sound stream of that size can need, beyond what there is already. Measured against the
/// format: leaves take at least 128 bytes there and at most 4.3 kB in memory, and what is written down anew comes on
/// top.
void limit_memory(std::size_t content_size) {
    constexpr std::size_t most_per_byte = 300, always = std::size_t{256} << 20;
    std::ifstream statm("/proc/self/statm");
    std::size_t total = 0, resident = 0, shared = 0, text = 0, library = 0, data = 0;  // pages
    if (!(statm >> total >> resident >> shared >> text >> library >> data)) return;
    const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    const rlim_t most = data * page + always + most_per_byte * content_size;
    rlimit limit{};
    if (::getrlimit(RLIMIT_DATA, &limit) != 0 || limit.rlim_cur <= most) return;
    limit.rlim_cur = most;
    ::setrlimit(RLIMIT_DATA, &limit);
}

/// What the reading process does; it ends with it.
[[noreturn]] void read_apart(std::string content, int to) {
    // What the library or a sanitizer has to say of its end is of no use to anybody.
    const int nowhere = ::open("/dev/null", O_WRONLY);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
        if (nowhere >= 0) ::dup2(nowhere, stream);
    }
    const rlimit no_dump{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_dump);
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGALRM}) std::signal(signal, SIG_DFL);
    ::alarm(patience);
    limit_memory(content.size());
    // A process born of one with threads has none of them and must not make new ones; the library takes grids apart in
    // loops of TBB.
    const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
    const std::string answer = answer_to(std::move(content));
    for (std::size_t done = 0; done < answer.size();) {
        const ssize_t written = ::write(to, answer.data() + done, answer.size() - done);
        if (written < 0 && errno != EINTR) ::_exit(1);
        if (written > 0) done += static_cast<std::size_t>(written);
    }
    ::_exit(0);
}

std::string all_of(int from) {
    std::string result;
    std::array<char, 65536> block;
    for (;;) {
        interruption_point();
        pollfd ready{from, POLLIN, 0};
        if (::poll(&ready, 1, 200) == 0) continue;
        const ssize_t size = ::read(from, block.data(), block.size());
        if (size < 0 && errno == EINTR) continue;
        if (size <= 0) return result;
        result.append(block.data(), static_cast<std::size_t>(size));
    }
}

}  // namespace

openvdb::FloatGrid::Ptr read_vdb_values(std::string content, const fs::path& file) {
    // One at a time: the reading process must not be born while another thread holds a lock of the library.
    static std::mutex mutex;
    const std::scoped_lock lock(mutex);
    openvdb::initialize();
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) {
        throw ReadError(file, std::string("it cannot be read (") + std::strerror(errno) + ")", "close other programs");
    }
    const pid_t reader = ::fork();
    if (reader == 0) {
        ::close(ends[0]);
        read_apart(std::move(content), ends[1]);
    }
    const int error = errno;
    ::close(ends[1]);
    if (reader < 0) {
        ::close(ends[0]);
        throw ReadError(file, std::string("it cannot be read (") + std::strerror(error) + ")", "close other programs");
    }
    std::string answer;
    int status = 0;
    const auto end_reader = [&] {
        ::close(ends[0]);
        while (::waitpid(reader, &status, 0) < 0 && errno == EINTR) continue;
    };
    try {
        answer = all_of(ends[0]);
    } catch (const Interrupted&) {
        ::kill(reader, SIGKILL);
        end_reader();
        throw;
    }
    end_reader();
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) {
        throw ReadError(file, "its values were not read within " + std::to_string(patience / 60) + " minutes", remedy);
    }
    const ReadError broken(file, "its values are damaged: the library that reads them breaks down", remedy);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || answer.empty()) throw broken;
    switch (static_cast<Answer>(answer.front())) {
        case Answer::grid:
            try {
                return float_grid(first_grid(answer.substr(1)));
            } catch (const std::exception&) {
                throw broken;
            }
        case Answer::fault:
            throw ReadError(file, answer.substr(1), remedy);
        case Answer::nothing:
            break;
    }
    return nullptr;
}

}  // namespace morphodesic::datasets
