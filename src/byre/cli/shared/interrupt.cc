#include "byre/cli/shared/interrupt.h"

#include "byre/base/output_file.h"

#include <array>
#include <atomic>

#include <unistd.h>

namespace byre::cli {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};
constexpr int kSignalled = 128;  // added to a signal's number, as shells do

std::atomic<int> noted_signal = 0;  // 0: none
static_assert(std::atomic<int>::is_always_lock_free, "else a signal handler may not write it");

// Async-signal-safe.
extern "C" void note_signal(int signal) {
  int none = 0;
  if (noted_signal.compare_exchange_strong(none, signal) || signal == SIGHUP) return;
  remove_unpublished_files();
  _exit(kSignalled + signal);
}

}  // namespace

InterruptCatcher::InterruptCatcher() {
  noted_signal = 0;
  struct sigaction noted {};
  noted.sa_handler = note_signal;
  noted.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], nullptr, &previous_[i]);
    if (previous_[i].sa_handler != SIG_IGN) sigaction(kSignals[i], &noted, nullptr);
  }
}

InterruptCatcher::~InterruptCatcher() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &previous_[i], nullptr);
}

bool InterruptCatcher::caught() const {
  return noted_signal != 0;
}

int exit_code_of_interrupt() {
  return kSignalled + (noted_signal == 0 ? SIGINT : noted_signal.load());
}

void ignore_write_signals() {
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

}  // namespace byre::cli
