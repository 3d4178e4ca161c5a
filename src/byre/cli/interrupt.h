#pragma once

#include <csignal>

namespace byre::cli {

// While it lives, the first Ctrl-C (SIGINT) is only noted; a second one ends the program at once. Where SIGINT is
// ignored, as for a program started in the background, it stays so. Have one at a time.
class InterruptCatcher {
 public:
  InterruptCatcher();
  ~InterruptCatcher();
  InterruptCatcher(const InterruptCatcher&) = delete;
  InterruptCatcher& operator=(const InterruptCatcher&) = delete;

  bool caught() const;

 private:
  struct sigaction previous_ {};  // constant after construction
};

}  // namespace byre::cli
