#pragma once

#include <array>
#include <csignal>

namespace byre::cli {

// During its life the first Ctrl-C (SIGINT), request to end (SIGTERM) or loss of the terminal (SIGHUP) is only noted. A
// second one removes temporary files, so that outputs are unchanged, and ends the program with exit code 128 plus the
// signal's number. SIGHUP never ends the program, because a closing terminal sends several. An ignored signal, as by
// nohup, stays ignored. Only one may exist at a time.
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

// The exit code of a program that ends for the signal that the last catcher noted.
int exit_code_of_interrupt();

// From now on, writing to a pipe that nobody reads and beyond the limit of file sizes fails, instead of ending the
// program before its other outputs are written.
void let_writing_fail();

}  // namespace byre::cli
