#include "byre/cli/interrupt.h"

#include <csignal>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

namespace byre::cli {
namespace {

// Sets what SIGINT does, and puts back what it did before.
class Interrupt : public testing::Test {
 protected:
  ~Interrupt() override { std::signal(SIGINT, before_); }

 private:
  void (*before_)(int) = std::signal(SIGINT, SIG_DFL);
};

TEST_F(Interrupt, IsNotedOnce) {
  const InterruptCatcher catcher;
  EXPECT_FALSE(catcher.caught());
  std::raise(SIGINT);
  EXPECT_TRUE(catcher.caught());
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
  std::signal(SIGINT, SIG_IGN);
  const InterruptCatcher catcher;
  std::raise(SIGINT);
  EXPECT_FALSE(catcher.caught());
}

}  // namespace
}  // namespace byre::cli
