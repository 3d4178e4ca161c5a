#include "byre/ros2/node/node_log.h"

#include "byre/base/printable.h"

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

void NodeLogger::log(LogLevel level, const std::string& line, Timestamp now) {
  tokens_ = std::min(kBurst, tokens_ + kPerSecond * to_seconds(now - std::exchange(last_, now)));
  if (tokens_ < 1.0 && level != LogLevel::error) {
    ++dropped_;
    return;
  }
  if (dropped_ > 0) write(LogLevel::notice, std::to_string(std::exchange(dropped_, 0)) + " log lines suppressed");
  tokens_ = std::max(0.0, tokens_ - 1.0);
  write(level, line);
}

bool is_connected_to_journal() {
  const char* const journal_stream = std::getenv("JOURNAL_STREAM");
  struct stat stream {};
  if (journal_stream == nullptr || fstat(STDERR_FILENO, &stream) != 0) return false;
  return std::to_string(stream.st_dev) + ":" + std::to_string(stream.st_ino) == std::string_view(journal_stream);
}

}  // namespace byre
