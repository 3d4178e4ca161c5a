#include "byre/cli/interrupt.h"

#include "byre/cli/commands.h"

#include <atomic>
#include <string>

#include <unistd.h>

namespace byre::cli {
namespace {

std::atomic<bool> was_interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "else a signal handler may not write it");

// Written only while SIGINT is not caught.
std::vector<std::string> unfinished_files;

// Calls only what a signal handler may.
extern "C" void note_interrupt(int) {
  if (!was_interrupted.exchange(true)) return;
  for (const std::string& file : unfinished_files) unlink(file.c_str());
  _exit(ExitCode::interrupted);
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
  was_interrupted = false;
  unfinished_files = unfinished_of(outputs);
  sigaction(SIGINT, nullptr, &previous_);
  if (previous_.sa_handler == SIG_IGN) return;
  struct sigaction noted {};
  noted.sa_handler = note_interrupt;
  noted.sa_flags = SA_RESTART;
  sigaction(SIGINT, &noted, nullptr);
}

InterruptCatcher::~InterruptCatcher() {
  sigaction(SIGINT, &previous_, nullptr);
}

bool InterruptCatcher::caught() const {
  return was_interrupted;
}

}  // namespace byre::cli
