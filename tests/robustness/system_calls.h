#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

struct SystemCall {
  std::string name;            // open, write, fsync, rename
  std::filesystem::path path;  // the file's; of rename: the new one
};

// While it lives, notes the calls that change files of a folder, as they reach the operating system, and may let them
// fail. One at a time.
class SystemCallTrace {
 public:
  explicit SystemCallTrace(const std::filesystem::path& folder);
  ~SystemCallTrace();
  SystemCallTrace(const SystemCallTrace&) = delete;
  SystemCallTrace& operator=(const SystemCallTrace&) = delete;

  // The n-th call from now on fails with this error and changes nothing.
  void fail_call(std::size_t n, int error) { failing_call_ = calls_.size() + n, error_ = error; }
  // From now on a call writes at most so many bytes.
  void shorten_writes(std::size_t bytes) { max_write_ = bytes; }

  const std::vector<SystemCall>& calls() const { return calls_; }

  // For the calls themselves. Whether it may go on; sets errno if not.
  bool note(const char* name, const std::filesystem::path& path);
  std::optional<std::size_t> max_write() const { return max_write_; }

 private:
  std::filesystem::path folder_;
  std::vector<SystemCall> calls_;
  std::optional<std::size_t> failing_call_;
  int error_ = 0;
  std::optional<std::size_t> max_write_;
};

}  // namespace byre
