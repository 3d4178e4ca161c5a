#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

struct SystemCall {
  std::string name;            // open, write, fsync, rename
  std::filesystem::path path;  // path of the file; the new one for rename
};

// Records the calls that change files of a folder, and can make them fail. At most one instance at a time.
class SystemCallTrace {
 public:
  explicit SystemCallTrace(const std::filesystem::path& folder);
  ~SystemCallTrace();
  SystemCallTrace(const SystemCallTrace&) = delete;
  SystemCallTrace& operator=(const SystemCallTrace&) = delete;

  // Makes the n-th next call fail with this error, without effect.
  void fail_call(std::size_t n, int error) { failing_call_ = calls_.size() + n, error_ = error; }
  // Limits each following write to this number of bytes.
  void shorten_writes(std::size_t bytes) { max_write_ = bytes; }

  const std::vector<SystemCall>& calls() const { return calls_; }

  // For the intercepted calls only. Returns false, with errno set, if the call must fail.
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
