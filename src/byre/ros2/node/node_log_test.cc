#include "byre/ros2/node/process.h"

#include <sstream>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

TEST(NodeLogger, WritesPrioritiesForTheJournal) {
  std::ostringstream journal, terminal;
  NodeLogger(journal, true).log(LogLevel::warning, "untrusted: no pose", {});
  NodeLogger(terminal, false).log(LogLevel::warning, "untrusted: no pose", {});
  EXPECT_EQ(journal.str(), "<4>untrusted: no pose\n");
  EXPECT_EQ(terminal.str(), "byre node: untrusted: no pose\n");
}

TEST(NodeLogger, EscapesLineBreaksOfExternalText) {
  std::ostringstream journal, terminal;
  NodeLogger(journal, true).log(LogLevel::info, "save\n<3>fake", {});
  NodeLogger(terminal, false).log(LogLevel::info, "\x1b[2J\xff", {});
  EXPECT_EQ(journal.str(), "<6>save\\n<3>fake\n");
  EXPECT_EQ(terminal.str(), "byre node: \\x1b[2J\\xff\n");
}

TEST(NodeLogger, LimitsTheRateAndCountsSuppressedLines) {
  std::ostringstream stream;
  NodeLogger log(stream, false);
  for (int i = 0; i < 100; ++i) log.log(LogLevel::notice, "line " + std::to_string(i), {});
  EXPECT_THAT(stream.str(), HasSubstr("line 29\n"));
  EXPECT_THAT(stream.str(), Not(HasSubstr("line 30\n")));
  log.log(LogLevel::notice, "much later", from_seconds(1.0));
  EXPECT_THAT(stream.str(), EndsWith("70 log lines suppressed\nbyre node: much later\n"));
}

TEST(NodeLogger, NeverSuppressesErrors) {
  std::ostringstream stream;
  NodeLogger log(stream, false);
  for (int i = 0; i < 50; ++i) log.log(LogLevel::error, "error " + std::to_string(i), {});
  EXPECT_THAT(stream.str(), HasSubstr("error 49\n"));
}

}  // namespace
}  // namespace byre
