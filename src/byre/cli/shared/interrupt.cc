#include "byre/cli/shared/interrupt.h"

#include <array>
#include <atomic>
#include <string>

#include <unistd.h>

namespace byre::cli {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};
constexpr int kSignalled = 128;  // added to a signal, as shells do it

std::atomic<int> noted_signal = 0;  // 0: none
static_assert(std::atomic<int>::is_always_lock_free, "else a signal handler may not write it");

// Written only while no signal is caught.
std::vector<std::string> unfinished_files;

// Calls only what a signal handler may.
extern "C" void note_signal(int signal) {
  int none = 0;
  if (noted_signal.compare_exchange_strong(none, signal) || signal == SIGHUP) return;
  for (const std::string& file : unfinished_files) unlink(file.c_str());
  _exit(kSignalled + signal);
}

// Where write_whole and replace_file write, the latter beside what a link points to.
std::vector<std::string> unfinished_of(const std::vector<std::filesystem::path>& outputs) {
  std::vector<std::string> files;
  for (const std::filesystem::path& output : outputs) {
    std::error_code unresolved;
    const std::filesystem::path target = std::filesystem::weakly_canonical(output, unresolved);
    files.push_back((unresolved ? output : target).string() + ".unfinished");
  }
  return files;
}

}  // namespace

InterruptCatcher::InterruptCatcher(const std::vector<std::filesystem::path>& outputs) {
  noted_signal = 0;
  unfinished_files = unfinished_of(outputs);
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

void let_writing_fail() {
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

}  // namespace byre::cli
