#include "byre/cli/interrupt.h"

#include <atomic>

namespace byre::cli {
namespace {

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "else a signal handler may not write it");

extern "C" void note_interrupt(int) {
  interrupted = true;
}

}  // namespace

InterruptCatcher::InterruptCatcher() {
  interrupted = false;
  sigaction(SIGINT, nullptr, &previous_);
  if (previous_.sa_handler == SIG_IGN) return;
  struct sigaction once {};
  once.sa_handler = note_interrupt;
  once.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigaction(SIGINT, &once, nullptr);
}

InterruptCatcher::~InterruptCatcher() {
  sigaction(SIGINT, &previous_, nullptr);
}

bool InterruptCatcher::caught() const {
  return interrupted;
}

}  // namespace byre::cli
