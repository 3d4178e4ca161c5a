#include "byre/cli/interrupt.h"

#include <csignal>

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
      testing::KilledBySignal(SIGINT), "");
}

TEST_F(Interrupt, StaysIgnoredWhereItWas) {
  std::signal(SIGINT, SIG_IGN);
  const InterruptCatcher catcher;
  std::raise(SIGINT);
  EXPECT_FALSE(catcher.caught());
}

}  // namespace
}  // namespace byre::cli
