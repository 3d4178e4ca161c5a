#pragma once

#include <array>
#include <csignal>

namespace byre::cli {

// Records the first SIGINT (Ctrl-C), SIGTERM or SIGHUP (terminal closed) during its lifetime. A second signal removes
// temporary files, so that outputs are unchanged, and ends the program with exit code 128 plus the signal's number.
// SIGHUP never ends the program, because a closing terminal sends several. Ignored signals stay ignored, as with nohup.
// At most one instance may exist.
class InterruptCatcher {
 public:
  InterruptCatcher();
  ~InterruptCatcher();
  InterruptCatcher(const InterruptCatcher&) = delete;
  InterruptCatcher& operator=(const InterruptCatcher&) = delete;

  bool caught() const;

 private:
  std::array<struct sigaction, 3> previous_{};  // constant after construction
};

// Exit code for the signal that the last catcher recorded.
int exit_code_of_interrupt();

// From now on, writing to a closed pipe or beyond the file size limit fails, instead of ending the program before its
// other outputs are written.
void ignore_write_signals();

}  // namespace byre::cli
