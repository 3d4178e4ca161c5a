#include "system_calls.h"

#include <algorithm>
#include <cerrno>
#include <cstdarg>

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

namespace fs = std::filesystem;

namespace {

byre::SystemCallTrace* current_trace = nullptr;

// The C library's own function.
template <typename Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

fs::path path_of(int descriptor) {
  std::error_code none;
  return fs::read_symlink("/proc/self/fd/" + std::to_string(descriptor), none);
}

bool note(const char* name, const fs::path& path) {
  return current_trace == nullptr || current_trace->note(name, path);
}

bool note(const char* name, int descriptor) {
  return current_trace == nullptr || current_trace->note(name, path_of(descriptor));
}

}  // namespace

// Symbol lookup finds these before the C library's.
extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  static auto* const real_open = real<int(const char*, int, ...)>("open");
  return note("open", fs::path(path)) ? real_open(path, flags, mode) : -1;
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
  static auto* const real_write = real<ssize_t(int, const void*, size_t)>("write");
  if (!note("write", descriptor)) return -1;
  if (current_trace != nullptr && current_trace->max_write()) count = std::min(count, *current_trace->max_write());
  return real_write(descriptor, bytes, count);
}

int fsync(int descriptor) {
  static auto* const real_fsync = real<int(int)>("fsync");
  return note("fsync", descriptor) ? real_fsync(descriptor) : -1;
}

int rename(const char* from, const char* to) noexcept {
  static auto* const real_rename = real<int(const char*, const char*)>("rename");
  return note("rename", fs::path(to)) ? real_rename(from, to) : -1;
}
}

namespace byre {

SystemCallTrace::SystemCallTrace(const fs::path& folder) : folder_(folder) {
  current_trace = this;
}

SystemCallTrace::~SystemCallTrace() {
  current_trace = nullptr;
}

bool SystemCallTrace::note(const char* name, const fs::path& path) {
  if (path != folder_ && path.parent_path() != folder_) return true;
  calls_.push_back({name, path});
  if (failing_call_ != calls_.size() - 1) return true;
  errno = error_;
  return false;
}

}  // namespace byre
