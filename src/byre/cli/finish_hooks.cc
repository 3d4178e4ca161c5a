#include "byre/cli/finish_hooks.h"

#include <iostream>

namespace byre::cli {

FinishHooks finish_hooks(const InterruptCatcher& interrupt, bool quiet) {
  FinishHooks hooks;
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  if (!quiet) hooks.before_step = [](const char* step) { std::cerr << "finishing: " << step << std::endl; };
  return hooks;
}

}  // namespace byre::cli
