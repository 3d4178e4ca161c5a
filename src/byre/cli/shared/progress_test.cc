#include "byre/cli/shared/progress.h"
#include "byre/base/output_file.h"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre::cli {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

std::string shown(ProgressStyle style, int total, double seconds_per_frame, bool is_total_known = true) {
  std::ostringstream stream;
  Progress progress(stream, style, is_total_known ? total : 0);
  for (int done = 1; done <= total; ++done) progress.update(done, done * seconds_per_frame, "tracking");
  progress.close();
  return stream.str();
}

TEST(Progress, PrintsTheFirstFrameAndEachTenthAsLines) {
  const std::string text = shown(ProgressStyle::lines, 1000, 0.01);
  EXPECT_EQ(std::ranges::count(text, '\n'), 11);
  EXPECT_THAT(text, StartsWith("1 of 1000 frames, 100.0 frames/s, 0:10 left, tracking\n100 of 1000 frames, "));
  EXPECT_THAT(text, EndsWith("1000 of 1000 frames, 100.0 frames/s, 0:00 left, tracking\n"));
}

TEST(Progress, PrintsALineAfterTenSecondsWhenFramesAreSlow) {
  EXPECT_EQ(std::ranges::count(shown(ProgressStyle::lines, 1000, 1.0), '\n'), 101);
}

TEST(Progress, RedrawsTheBarInOneLine) {
  const std::string text = shown(ProgressStyle::bar, 100, 0.0625);
  EXPECT_EQ(std::ranges::count(text, '\n'), 1);
  EXPECT_EQ(std::ranges::count(text, '\r'), 51);
  EXPECT_THAT(text, HasSubstr("\r[............"));
  EXPECT_THAT(text, HasSubstr("\r[############............] 51 of 100 frames"));
  EXPECT_THAT(
      text,
      EndsWith("[########################] 100 of 100 frames, 16.0 frames/s, 0:00 left, tracking\x1b[K\x1b[?7h\n"));
}

TEST(Progress, OmitsTheRemainingTimeIfUnknown) {
  EXPECT_EQ(shown(ProgressStyle::lines, 30, 1.0, false),
            "1 frames, 1.0 frames/s, tracking\n11 frames, 1.0 frames/s, tracking\n21 frames, 1.0 frames/s, tracking\n");
  const std::string text = shown(ProgressStyle::bar, 2, 1.0, false);
  EXPECT_THAT(text, HasSubstr("\r2 frames, 1.0 frames/s, tracking"));
}

std::string end_of_bar(ProgressStyle style, Tone tone) {
  std::ostringstream stream;
  Progress progress(stream, style, 1);
  progress.update(1, 1.0, "tracking", tone);
  return stream.str();
}

TEST(Progress, ColoursTheStateIfSupported) {
  EXPECT_THAT(end_of_bar(ProgressStyle::coloured_bar, Tone::good), HasSubstr(", \x1b[32mtracking\x1b[0m\x1b[K"));
  EXPECT_THAT(end_of_bar(ProgressStyle::coloured_bar, Tone::doubtful), HasSubstr(", \x1b[33mtracking\x1b[0m"));
  EXPECT_THAT(end_of_bar(ProgressStyle::coloured_bar, Tone::bad), HasSubstr(", \x1b[31mtracking\x1b[0m"));
  EXPECT_EQ(end_of_bar(ProgressStyle::coloured_bar, Tone::plain), end_of_bar(ProgressStyle::bar, Tone::bad));
  EXPECT_EQ(end_of_bar(ProgressStyle::lines, Tone::bad), "1 of 1 frames, 1.0 frames/s, 0:00 left, tracking\n");
}

TEST(Progress, IsSilentWhenQuiet) {
  EXPECT_EQ(shown(ProgressStyle::none, 100, 1.0), "");
}

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
