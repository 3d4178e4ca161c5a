#include "byre/node/node_log.h"

#include "byre/input/printable.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

namespace byre {

void NodeLogger::write(LogLevel level, const std::string& content) {
  const std::string line = printable(content);
  if (is_for_journal_) {
    stream_ << '<' << static_cast<int>(level) << '>' << line << std::endl;
  } else {
    stream_ << "byre node: " << line << std::endl;
  }
}

void NodeLogger::tell(LogLevel level, const std::string& line, Timestamp now) {
  allowed_ = std::min(kAtOnce, allowed_ + kPerSecond * to_seconds(now - std::exchange(last_, now)));
  if (allowed_ < 1.0 && level != LogLevel::error) {
    ++left_out_;
    return;
  }
  if (left_out_ > 0) write(LogLevel::notice, std::to_string(std::exchange(left_out_, 0)) + " log lines suppressed");
  allowed_ = std::max(0.0, allowed_ - 1.0);
  write(level, line);
}

bool is_journal_read() {
  const char* const told = std::getenv("JOURNAL_STREAM");
  struct stat stream {};
  if (told == nullptr || fstat(STDERR_FILENO, &stream) != 0) return false;
  return std::to_string(stream.st_dev) + ":" + std::to_string(stream.st_ino) == std::string_view(told);
}

}  // namespace byre
