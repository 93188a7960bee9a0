#include "pipeline/stop_signals.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

namespace morphodesic::pipeline {
namespace {

std::atomic<int> stop_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void on_stop_signal(int signal) {
    if (stop_signal.exchange(signal) != 0) ::_exit(128 + signal);
}

}  // namespace

void StopSignals::install() {
    struct sigaction action = {};
    action.sa_handler = on_stop_signal;
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    struct sigaction hangup = {};
    sigaction(SIGHUP, nullptr, &hangup);
    if (hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // nohup ignores it
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

int StopSignals::caught() {
    return stop_signal.load();
}

}  // namespace morphodesic::pipeline
