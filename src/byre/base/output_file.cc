#include "byre/base/output_file.h"

#include "byre/base/binary_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kUnfinished = ".unfinished";
constexpr std::size_t kMarkLength = 8;  // hexadecimal digits in a temporary name

[[noreturn]] void refuse(const fs::path& path, std::string_view reason, std::string_view remedy) {
  throw InputError(path.string(), reason, remedy);
}

std::string_view remedy_of(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free disk space, or choose a file on another disk";
    case EFBIG:
      return "raise the limit of file sizes (ulimit -f)";
    case EROFS:
      return "choose a file on a disk that is not mounted read-only";
    case EACCES:
    case EPERM:
      return "make the folder writable (chmod u+w), or choose a file in another folder";
    case ENOENT:
    case ENOTDIR:
      return "create the folder, or choose a file in another one";
    case EMFILE:
    case ENFILE:
      return "close other files, or raise the limit of open files (ulimit -n)";
    case ENAMETOOLONG:
      return "choose a shorter name";
    default:
      return "check that the folder exists, is writable and has free space";
  }
}

[[noreturn]] void fail_to_write(const fs::path& path, bool is_old_kept, int error) {
  refuse(path,
         std::string("cannot be written: ") + std::strerror(error) + (is_old_kept ? "; the old file is unchanged" : ""),
         remedy_of(error));
}

// Temporary files of this process, for the signal handler. The memory of the names is never freed.
struct Pending {
  std::atomic<bool> is_claimed = false;
  std::atomic<bool> is_active = false;
  std::array<char, 1024> name{};
};
std::array<Pending, 16> pending_files;
static_assert(std::atomic<bool>::is_always_lock_free, "signal handlers may read lock-free atomics only");

// Adds a file to the list and returns its index; -1 for a long name or a full list. Such a file stays if a signal ends
// the program; the next run that writes the same path removes it.
int add_pending(const fs::path& file) {
  const std::string& name = file.native();
  if (name.size() >= Pending{}.name.size()) return -1;
  for (std::size_t i = 0; i < pending_files.size(); ++i) {
    if (pending_files[i].is_claimed.exchange(true)) continue;
    std::memcpy(pending_files[i].name.data(), name.c_str(), name.size() + 1);
    pending_files[i].is_active = true;
    return static_cast<int>(i);
  }
  return -1;
}

void remove_pending(int& place) {
  if (place < 0) return;
  Pending& pending = pending_files[static_cast<std::size_t>(place)];
  pending.is_active = false;
  pending.is_claimed = false;
  place = -1;
}

// The descriptor of a path such as /dev/stdout or /dev/fd/3. Opening the path instead would truncate a file that output
// is redirected to, and lose its position.
std::optional<int> named_descriptor(const fs::path& path) {
  const std::string name = path.lexically_normal().string();
  if (name == "/dev/stdout") return STDOUT_FILENO;
  if (name == "/dev/stderr") return STDERR_FILENO;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!name.starts_with(folder)) continue;
    int number = 0;
    const char* const end = name.data() + name.size();
    const auto [last, fault] = std::from_chars(name.data() + folder.size(), end, number);
    if (fault == std::errc() && last == end && number >= 0) return number;
  }
  return std::nullopt;
}

bool is_below(const fs::path& path, std::string_view folder) {
  return path.native().starts_with(folder);
}

// Whether the file is in a system folder without user files. /dev/shm has user files.
bool is_of_system(const fs::path& target) {
  return (is_below(target, "/dev/") && !is_below(target, "/dev/shm/")) || is_below(target, "/proc/") ||
         is_below(target, "/sys/");
}

// Target of a path, and how it is written.
struct Destination {
  fs::path target;
  bool is_direct = false;
  std::optional<int> descriptor{};     // open descriptor to write to, if is_direct
  std::optional<struct stat> there{};  // status of the present regular file; empty without one
};

void require_replaceable(const fs::path& path, const fs::path& target, FileContent content, const struct stat& there) {
  constexpr mode_t kWritable = S_IWUSR | S_IWGRP | S_IWOTH;
  if ((there.st_mode & kWritable) == 0 || access(target.c_str(), W_OK) != 0) {
    refuse(path, "is write-protected", "choose another file, or make this one writable (chmod u+w)");
  }
  const auto present = content_of(target);
  if (!present) {
    refuse(path, "exists and cannot be read, so its kind is unknown",
           "choose another file, or remove the existing one first");
  }
  if (may_replace(*present, content)) return;
  refuse(path, "exists and is not the expected kind of file (" + std::string(name_of(content)) + ")",
         "choose another file, or remove the existing one first");
}

void require_folder(const fs::path& path, const fs::path& target) {
  const fs::path folder = folder_of(target);
  std::error_code unknown;
  if (!fs::is_directory(folder, unknown)) {
    refuse(path, "cannot be written: the folder does not exist", "create the folder " + folder.string());
  }
  if (access(folder.c_str(), W_OK | X_OK) == 0) return;
  refuse(path, std::string("cannot be written: ") + std::strerror(errno), remedy_of(errno));
}

// Throws InputError if the path is not writable. content: empty for a check of the place alone.
Destination destination_of(const fs::path& path, std::optional<FileContent> content) {
  if (const auto descriptor = named_descriptor(path)) {
    const int flags = fcntl(*descriptor, F_GETFL);
    const int mode = flags & O_ACCMODE;
    if (flags >= 0 && (mode == O_WRONLY || mode == O_RDWR)) return {path, true, descriptor};
    refuse(path, "is not open for writing", "choose a file");
  }
  if (path.filename().empty()) refuse(path, "is a folder", "choose a file in it");
  struct stat status {};
  const bool is_link = lstat(path.c_str(), &status) == 0 && S_ISLNK(status.st_mode);
  Destination to{is_link ? target_of(path) : path};
  const bool is_active = stat(to.target.c_str(), &status) == 0;
  if (!is_active && errno == ELOOP) {
    refuse(path, "is a circular link", "choose a regular file");
  }
  if (is_active && S_ISDIR(status.st_mode)) refuse(path, "is a folder", "choose a file in it");
  if (is_active && !S_ISREG(status.st_mode)) {
    to.is_direct = !is_link && (S_ISCHR(status.st_mode) || S_ISFIFO(status.st_mode));
    if (!to.is_direct) refuse(path, "is a link to a device, a socket or a block device", "choose a regular file");
    if (access(path.c_str(), W_OK) != 0) refuse(path, "is not writable", "check its permissions");
    return to;
  }
  if (is_of_system(target_of(to.target))) {
    refuse(path, "is in a system folder", "choose a file in another folder");
  }
  require_folder(path, to.target);
  if (!is_active) return to;
  to.there = status;
  if (content) require_replaceable(path, to.target, *content, status);
  return to;
}

// First part of a temporary name, short enough for the rest.
std::string beginning_of(const fs::path& target) {
  constexpr std::size_t kMaxPending = 200;  // bytes, of the 255 of file systems
  return target.filename().string().substr(0, kMaxPending) + ".";
}

// Last part of a temporary name. The video library chooses the format by the extension.
std::string ending_of(const fs::path& target, FileContent content) {
  return std::string(kUnfinished) + (content == FileContent::video ? target.extension().string() : "");
}

fs::path temporary_path_for(const fs::path& target, FileContent content) {
  unsigned number = 0;
  while (getrandom(&number, sizeof(number), 0) != sizeof(number)) {
  }
  std::array<char, kMarkLength> digits{};
  digits.fill('0');
  std::array<char, kMarkLength> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number, 16).ptr;
  std::copy_backward(text.data(), end, digits.data() + digits.size());
  return folder_of(target) /
         (beginning_of(target) + std::string(digits.data(), digits.size()) + ending_of(target, content));
}

bool is_temporary_of(const fs::path& file, const fs::path& target, FileContent content) {
  const std::string name = file.filename().string();
  const std::string beginning = beginning_of(target), ending = ending_of(target, content);
  return name.size() == beginning.size() + kMarkLength + ending.size() && name.starts_with(beginning) &&
         name.ends_with(ending) &&
         std::ranges::all_of(std::string_view(name).substr(beginning.size(), kMarkLength),
                             [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

// A process that writes a temporary file holds its lock, which ends with the process.
bool lock(int descriptor) {
  return flock(descriptor, LOCK_EX | LOCK_NB) == 0;
}

void remove_if_stale(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return;
  struct stat status {};
  const bool is_own = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == geteuid();
  if (is_own && lock(descriptor)) unlink(file.c_str());
  close(descriptor);
}

// Removes temporary files of killed processes that wrote to the same path.
void remove_leftovers(const fs::path& target, FileContent content) {
  std::error_code error;
  for (fs::directory_iterator entry(folder_of(target), error), end; !error && entry != end; entry.increment(error)) {
    if (is_temporary_of(entry->path(), target, content)) remove_if_stale(entry->path());
  }
}

// Returns descriptor and name.
std::pair<int, fs::path> create_temporary(const fs::path& path, const Destination& to, FileContent content) {
  constexpr int kAttempts = 100;
  for (int i = 0; i < kAttempts; ++i) {
    fs::path name = temporary_path_for(to.target, content);
    const int descriptor = open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno == EEXIST) continue;
    if (descriptor < 0) fail_to_write(path, to.there.has_value(), errno);
    // Another process may have removed it as a leftover before it was locked. File systems without locks are accepted.
    struct stat status {};
    const bool is_locked = lock(descriptor) || (errno != EWOULDBLOCK);
    if (is_locked && fstat(descriptor, &status) == 0 && status.st_nlink > 0) return {descriptor, std::move(name)};
    close(descriptor);
  }
  fail_to_write(path, to.there.has_value(), EEXIST);
}

// Takes over owner and mode as far as the system allows.
void copy_owner_and_mode(int descriptor, const struct stat& there) {
  constexpr mode_t kPermissions = 0777;
  const bool is_owner_kept = fchown(descriptor, there.st_uid, there.st_gid) == 0;
  if (is_owner_kept) fchmod(descriptor, there.st_mode & kPermissions);
}

// False on failure. File systems that cannot sync a folder are accepted.
bool sync_descriptor(int descriptor) {
  return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
}

void sync_folder_of(const fs::path& path, const fs::path& target) {
  const int folder = open(folder_of(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool is_synced = folder >= 0 && sync_descriptor(folder);
  const int error = errno;
  if (folder >= 0) close(folder);
  if (!is_synced) fail_to_write(path, false, error);
}

}  // namespace

fs::path target_of(fs::path path) {
  constexpr int kMaxLinks = 40;
  std::error_code error;
  for (int i = 0; i < kMaxLinks && fs::is_symlink(path, error); ++i) {
    path = path.parent_path() / fs::read_symlink(path, error);
  }
  const fs::path target = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path : target;
}

void require_writable(const fs::path& path, std::optional<FileContent> content) {
  destination_of(path, content);
}

OutputFile::OutputFile(const fs::path& path, FileContent content, Durability durability)
    : path_(path), durability_(durability) {
  const Destination to = destination_of(path, content);
  target_ = to.target;
  is_direct_ = to.is_direct;
  replaces_ = to.there.has_value();
  if (is_direct_) {
    descriptor_ = to.descriptor ? fcntl(*to.descriptor, F_DUPFD_CLOEXEC, 0)
                                : open(path.c_str(), O_WRONLY | O_NOCTTY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor_ < 0) fail_to_write(path_, false, errno);
    return;
  }
  if (durability_ == Durability::synced) remove_leftovers(target_, content);
  std::tie(descriptor_, temporary_) = create_temporary(path_, to, content);
  pending_ = add_pending(temporary_);
  if (to.there) copy_owner_and_mode(descriptor_, *to.there);
}

OutputFile::~OutputFile() {
  if (!temporary_.empty() && !is_kept_) unlink(temporary_.c_str());
  remove_pending(pending_);
  close(descriptor_);
}

void OutputFile::keep_unpublished(bool is_kept) {
  is_kept_ = is_kept;
  if (is_kept) remove_pending(pending_);
}

void OutputFile::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno != EINTR) fail_to_write(path_, replaces_ && !temporary_.empty(), errno);
    if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void OutputFile::append(std::string_view text) {
  append(std::as_bytes(std::span(text)));
}

void OutputFile::sync() {
  if (is_direct_ || durability_ != Durability::synced || sync_descriptor(descriptor_)) return;
  fail_to_write(path_, replaces_ && !temporary_.empty(), errno);
}

void OutputFile::publish() {
  if (is_direct_) return;
  sync();
  if (rename(temporary_.c_str(), target_.c_str()) != 0) fail_to_write(path_, replaces_, errno);
  temporary_.clear();
  remove_pending(pending_);
  if (durability_ == Durability::synced) sync_folder_of(path_, target_);
}

void write_atomically(const fs::path& path, std::span<const std::byte> bytes, Durability durability) {
  OutputFile file(path, content_of(bytes, path), durability);
  file.append(bytes);
  file.publish();
}

void write_atomically(const fs::path& path, std::string_view text) {
  write_atomically(path, std::as_bytes(std::span(text)));
}

std::vector<std::byte> read_leftover(const fs::path& path, FileContent content) {
  const fs::path target = target_of(path);
  std::vector<std::byte> longest;
  std::error_code error;
  for (fs::directory_iterator entry(folder_of(target), error), end; !error && entry != end; entry.increment(error)) {
    if (!is_temporary_of(entry->path(), target, content)) continue;
    std::vector<std::byte> bytes = read_file(entry->path());
    if (bytes.size() > longest.size()) longest = std::move(bytes);
  }
  return longest;
}

void link_or_copy(const fs::path& file, const fs::path& path) {
  const FileContent content = content_of(file).value_or(FileContent::other);
  const Destination to = destination_of(path, content);
  if (to.is_direct) refuse(path, "is a device or a pipe", "choose a regular file");
  remove_leftovers(to.target, content);
  const fs::path temporary = temporary_path_for(to.target, content);
  if (link(target_of(file).c_str(), temporary.c_str()) != 0) return write_atomically(path, read_file(file));
  const bool is_renamed = rename(temporary.c_str(), to.target.c_str()) == 0;
  const int error = errno;
  unlink(temporary.c_str());  // still there if both paths were the same file, or renaming failed
  if (!is_renamed) fail_to_write(path, to.there.has_value(), error);
  sync_folder_of(path, to.target);
}

void remove_unpublished_files() noexcept {
  for (const Pending& pending : pending_files) {
    if (pending.is_active) unlink(pending.name.data());
  }
}

}  // namespace byre
