#pragma once

#include <csignal>
#include <filesystem>
#include <vector>

namespace byre::cli {

// While it lives, the first Ctrl-C (SIGINT) is only noted; a second one ends the program at once with exit code 130,
// and the outputs are left as they were: what was being written beside them is removed. Where SIGINT is ignored, as for
// a program started in the background, it stays so. Have one at a time.
class InterruptCatcher {
 public:
  explicit InterruptCatcher(const std::vector<std::filesystem::path>& outputs = {});
  ~InterruptCatcher();
  InterruptCatcher(const InterruptCatcher&) = delete;
  InterruptCatcher& operator=(const InterruptCatcher&) = delete;

  bool caught() const;

 private:
  struct sigaction previous_ {};  // constant after construction
};

}  // namespace byre::cli
