// A save that fails or is killed at any moment leaves a complete readable map: the old one or the new one.

#include "system_calls.h"

#include "byre/base/binary_file.h"
#include "byre/input_error.h"
#include "byre/map/stored_map_scene.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <functional>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

using testing::AnyOf;
using testing::Eq;

MATCHER_P2(IsCall, name, path, "") {
  return arg.name == name && arg.path == path;
}

bool is_unfinished(const fs::path& file) {
  return file.extension() == ".unfinished";
}

MATCHER_P(IsCallOfTemporary, name, "") {
  return arg.name == name && is_unfinished(arg.path);
}

class InterruptedSave : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::weakly_canonical(testing::TempDir()) / ("interrupted_save_" + std::to_string(getpid()));
    fs::create_directory(folder_);
    save_map(old_map_, file_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void expect_old_map() const { EXPECT_EQ(read_file(file_), old_bytes_); }
  void expect_old_or_new_map() const {
    EXPECT_NO_THROW(load_map(file_));
    EXPECT_THAT(read_file(file_), AnyOf(Eq(old_bytes_), Eq(new_bytes_)));
  }

  const StoredMap old_map_ = StoredMapScene(20, 100, 1).stored();
  const StoredMap new_map_ = StoredMapScene(20, 120, 2).stored();
  const std::vector<std::byte> old_bytes_ = write_map(old_map_);
  const std::vector<std::byte> new_bytes_ = write_map(new_map_);
  fs::path folder_ = fs::weakly_canonical(testing::TempDir()) / ("interrupted_save_" + std::to_string(getpid()));
  fs::path file_ = folder_ / "barn.byre";

  bool has_unfinished_files() const {
    return std::any_of(fs::directory_iterator(folder_), {},
                       [](const fs::directory_entry& entry) { return is_unfinished(entry.path()); });
  }
};

TEST_F(InterruptedSave, WritesSyncsRenamesAndSyncsTheFolderInOrder) {
  SystemCallTrace trace(folder_);
  save_map(new_map_, file_);
  EXPECT_THAT(trace.calls(),
              testing::ElementsAre(IsCallOfTemporary("open"), IsCallOfTemporary("write"), IsCallOfTemporary("fsync"),
                                   IsCall("rename", file_), IsCall("open", folder_), IsCall("fsync", folder_)));
}

TEST_F(InterruptedSave, ContinuesAfterShortWrites) {
  SystemCallTrace trace(folder_);
  trace.shorten_writes(10000);
  save_map(new_map_, file_);
  EXPECT_GT(trace.calls().size(), 10u);
  EXPECT_EQ(read_file(file_), new_bytes_);
}

TEST_F(InterruptedSave, KeepsTheOldMapIfAnyStepFails) {
  constexpr std::size_t kStepsBeforeTheNewMap = 4;  // open, write, fsync, rename
  for (std::size_t step = 0; step < kStepsBeforeTheNewMap; ++step) {
    SystemCallTrace trace(folder_);
    trace.fail_call(step, ENOSPC);
    EXPECT_THROW(save_map(new_map_, file_), InputError) << "step " << step;
    expect_old_map();
    EXPECT_FALSE(has_unfinished_files());
  }
}

TEST_F(InterruptedSave, KeepsTheNewMapIfOnlyTheFolderSyncFails) {
  for (const std::size_t step : {4, 5}) {
    save_map(old_map_, file_);
    SystemCallTrace trace(folder_);
    trace.fail_call(step, EIO);
    EXPECT_THROW(save_map(new_map_, file_), InputError);
    EXPECT_EQ(read_file(file_), new_bytes_);
  }
}

TEST_F(InterruptedSave, KeepsTheOldMapIfTheDiskFillsUp) {
  SystemCallTrace trace(folder_);
  trace.shorten_writes(10000);
  for (const std::size_t writes_before : {1, 5, 9}) {
    trace.fail_call(1 + writes_before, ENOSPC);
    EXPECT_THROW(save_map(new_map_, file_), InputError);
    expect_old_map();
    EXPECT_FALSE(has_unfinished_files());
  }
}

// Saves in a child process whose files are limited to this size. Returns whether the save succeeded.
bool save_with_file_limit(const StoredMap& map, const fs::path& file, std::size_t bytes) {
  const pid_t process = fork();
  if (process == 0) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      save_map(map, file);
      _exit(0);
    } catch (const InputError&) {
      _exit(3);
    }
  }
  int status = 0;
  waitpid(process, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 3));
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST_F(InterruptedSave, KeepsTheOldMapAtTheFileSizeLimit) {
  const std::size_t size = new_bytes_.size();
  for (const std::size_t limit : {std::size_t{0}, std::size_t{1}, size / 2, size - 1}) {
    EXPECT_FALSE(save_with_file_limit(new_map_, file_, limit));
    expect_old_map();
    EXPECT_FALSE(has_unfinished_files());
  }
  EXPECT_TRUE(save_with_file_limit(new_map_, file_, size));
  EXPECT_EQ(read_file(file_), new_bytes_);
}

// Alternately saves two maps to one file until killed; is_saving: set during saves.
[[noreturn]] void save_forever(const StoredMap& first, const StoredMap& second, const fs::path& file,
                               std::atomic<bool>& is_saving) {
  for (bool is_first = true;; is_first = !is_first) {
    is_saving = true;
    save_map(is_first ? first : second, file);
    is_saving = false;
  }
}

// A flag that outlives the process that sets it.
class SharedFlag {
 public:
  SharedFlag()
      : memory_(mmap(nullptr, sizeof(Flag), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)),
        flag_(new (memory_) Flag(false)) {}
  ~SharedFlag() { munmap(memory_, sizeof(Flag)); }
  SharedFlag(const SharedFlag&) = delete;
  SharedFlag& operator=(const SharedFlag&) = delete;

  using Flag = std::atomic<bool>;
  Flag& operator*() const { return *flag_; }

 private:
  void* memory_;
  Flag* flag_;
};

// Waits up to five seconds until the condition holds.
void wait_until(const std::function<bool()>& holds) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (!holds() && std::chrono::steady_clock::now() < deadline) {
  }
}

TEST_F(InterruptedSave, LeavesAMapIfItsProcessIsKilled) {
  constexpr int kKills = 100;
  const auto start = std::chrono::steady_clock::now();
  save_map(old_map_, file_);
  const auto duration = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
  const SharedFlag is_saving;
  std::mt19937_64 random(1);
  int inside = 0;
  int while_writing = 0;
  for (int attempt = 0; attempt < 20 * kKills && inside < kKills && !HasFailure(); ++attempt) {
    *is_saving = false;
    const pid_t process = fork();
    if (process == 0) save_forever(new_map_, old_map_, file_, *is_saving);
    if (attempt % 2 == 0) {
      std::this_thread::sleep_for(duration * static_cast<double>(random() % 1000) / 400.0);
    } else {
      wait_until([this] { return has_unfinished_files(); });  // writing is a small part of saving
    }
    kill(process, SIGKILL);
    waitpid(process, nullptr, 0);
    inside += *is_saving ? 1 : 0;
    while_writing += has_unfinished_files() ? 1 : 0;
    expect_old_or_new_map();
    EXPECT_LE(std::distance(fs::directory_iterator(folder_), {}), 2)
        << "temporary files of killed processes do not accumulate";
    if (has_unfinished_files()) save_map(old_map_, file_);  // removes the temporary file
    EXPECT_FALSE(has_unfinished_files());
  }
  std::printf("%d kills inside a save, %d of them between the first byte and the rename\n", inside, while_writing);
  EXPECT_EQ(inside, kKills);
  EXPECT_GT(while_writing, 0);
  save_map(new_map_, file_);  // must succeed whatever files the kills left
  EXPECT_EQ(read_file(file_), new_bytes_);
}

}  // namespace
}  // namespace byre
