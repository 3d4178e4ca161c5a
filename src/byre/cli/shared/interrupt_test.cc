#include "byre/cli/shared/interrupt.h"

#include "byre/base/output_file.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>

namespace byre::cli {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

// Sets the signals' handlers, and restores the previous ones.
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

TEST_F(Interrupt, IsCaughtOnce) {
  for (const int signal : kSignals) {
    const InterruptCatcher catcher;
    EXPECT_FALSE(catcher.caught());
    std::raise(signal);
    EXPECT_TRUE(catcher.caught());
    EXPECT_EQ(exit_code_of_interrupt(), 128 + signal);
  }
}

TEST_F(Interrupt, ByHangupNeverEndsTheProgramAtOnce) {
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

TEST_F(Interrupt, RemovesOnlyUnfinishedFilesTheSecondTime) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "byre_interrupted";
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "whole.txt") << "whole";
  EXPECT_EXIT(
      {
        const InterruptCatcher catcher;
        OutputFile half(folder / "whole.txt", FileContent::text);
        half.append("ha");
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      testing::ExitedWithCode(130), "");
  EXPECT_TRUE(std::filesystem::exists(folder / "whole.txt"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
  std::filesystem::remove_all(folder);
}

TEST_F(Interrupt, StaysIgnoredIfItWasIgnored) {
  for (const int signal : kSignals) {
    std::signal(signal, SIG_IGN);
    const InterruptCatcher catcher;
    std::raise(signal);
    EXPECT_FALSE(catcher.caught());
  }
}

}  // namespace
}  // namespace byre::cli
