#include "byre/cli/shared/interrupt.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>

namespace byre::cli {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

// Sets what the signals do, and puts back what they did before.
class Interrupt : public testing::Test {
 protected:
  Interrupt() {
    for (const int signal : kSignals) before_.push_back(std::signal(signal, SIG_DFL));
  }
  ~Interrupt() override {
    for (std::size_t i = 0; i < before_.size(); ++i) std::signal(kSignals[i], before_[i]);
  }

 private:
  std::vector<void (*)(int)> before_;
};

TEST_F(Interrupt, IsNotedOnce) {
  for (const int signal : kSignals) {
    const InterruptCatcher catcher;
    EXPECT_FALSE(catcher.caught());
    std::raise(signal);
    EXPECT_TRUE(catcher.caught());
    EXPECT_EQ(exit_code_of_interrupt(), 128 + signal);
  }
}

TEST_F(Interrupt, ByATerminalThatClosesNeverEndsTheProgramAtOnce) {
  const InterruptCatcher catcher;
  std::raise(SIGTERM);
  std::raise(SIGHUP);
  std::raise(SIGHUP);
  EXPECT_EQ(exit_code_of_interrupt(), 128 + SIGTERM);
}

TEST_F(Interrupt, OfAnEarlierCatcherIsForgotten) {
  {
    const InterruptCatcher earlier;
    std::raise(SIGINT);
  }
  EXPECT_FALSE(InterruptCatcher().caught());
}

TEST_F(Interrupt, EndsTheProgramTheSecondTime) {
  EXPECT_EXIT(
      {
        const InterruptCatcher catcher;
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      testing::ExitedWithCode(130), "");
  EXPECT_EXIT(
      {
        const InterruptCatcher catcher;
        std::raise(SIGHUP);
        std::raise(SIGTERM);
      },
      testing::ExitedWithCode(143), "");
}

TEST_F(Interrupt, RemovesWhatWasBeingWrittenTheSecondTimeAndNothingElse) {
  const std::filesystem::path output = std::filesystem::path(testing::TempDir()) / "byre_interrupted.byre";
  const std::filesystem::path unfinished = output.string() + ".unfinished";
  std::ofstream(output) << "whole";
  std::ofstream(unfinished) << "ha";
  EXPECT_EXIT(
      {
        const InterruptCatcher catcher({output});
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      testing::ExitedWithCode(130), "");
  EXPECT_TRUE(std::filesystem::exists(output));
  EXPECT_FALSE(std::filesystem::exists(unfinished));
  std::filesystem::remove(output);
}

TEST_F(Interrupt, StaysIgnoredWhereItWas) {
  for (const int signal : kSignals) {
    std::signal(signal, SIG_IGN);
    const InterruptCatcher catcher;
    std::raise(signal);
    EXPECT_FALSE(catcher.caught());
  }
}

}  // namespace
}  // namespace byre::cli
