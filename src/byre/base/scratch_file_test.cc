#include "byre/base/scratch_file.h"

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace byre {
namespace {

std::vector<std::byte> pattern(std::size_t count, unsigned seed) {
  std::vector<std::byte> bytes(count);
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::byte>((i * 31 + i / 251 + seed) & 255u);
  return bytes;
}

bool are(const std::vector<std::byte>& expected, const std::shared_ptr<const std::byte>& piece) {
  return std::equal(expected.begin(), expected.end(), piece.get());
}

struct MemoryOfProcess {
  double addresses_mb = 0.0;
  double resident_mb = 0.0;
};

MemoryOfProcess memory_now() {
  long addresses = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> addresses >> resident;
  const double page_mb = 1e-6 * static_cast<double>(sysconf(_SC_PAGESIZE));
  return {page_mb * static_cast<double>(addresses), page_mb * static_cast<double>(resident)};
}

double resident_mb() {
  return memory_now().resident_mb;
}

// Sanitizers use memory for their own records, so that measured memory is meaningless.
#ifdef BYRE_SANITIZED
constexpr bool kMemoryIsTold = false;
#else
constexpr bool kMemoryIsTold = true;
#endif

TEST(ScratchFile, ReturnsStoredContent) {
  ScratchFile file;
  std::vector<std::shared_ptr<const std::byte>> pieces;
  for (unsigned i = 0; i < 400; ++i) pieces.push_back(file.put(pattern(200000 + i, i)));
  file.release_pages();
  for (unsigned i = 0; i < 400; ++i) {
    ASSERT_NE(pieces[i], nullptr);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(pieces[i].get()) % alignof(std::max_align_t), 0u);
    EXPECT_TRUE(are(pattern(200000 + i, i), pieces[i])) << i;
  }
}

TEST(ScratchFile, ReportsWhetherItContainsAnAddress) {
  ScratchFile file;
  const auto piece = file.put(pattern(10, 1));
  EXPECT_TRUE(file.holds(piece.get()));
  EXPECT_FALSE(file.holds(&file));
  EXPECT_FALSE(ScratchFile().holds(piece.get()));
  EXPECT_NE(file.put({}), nullptr);
}

TEST(ScratchFile, LivesAsLongAsAnyPiece) {
  std::shared_ptr<const std::byte> piece;
  {
    ScratchFile file;
    piece = file.put(pattern(1000, 7));
  }
  EXPECT_TRUE(are(pattern(1000, 7), piece));
}

TEST(ScratchFile, UsesNoMemoryForUnaccessedPieces) {
  if (!kMemoryIsTold) GTEST_SKIP() << "sanitizers use additional memory";
  ScratchFile file;
  std::vector<std::shared_ptr<const std::byte>> pieces;
  const std::vector<std::byte> bytes = pattern(1000000, 5);
  const double before = resident_mb();
  for (int i = 0; i < 60; ++i) pieces.push_back(file.put(bytes));
  EXPECT_LT(resident_mb(), before + 20.0);
  for (const auto& piece : pieces) ASSERT_TRUE(are(bytes, piece));
  EXPECT_GT(resident_mb(), before + 40.0);
  file.release_pages();
  EXPECT_LT(resident_mb(), before + 20.0);
}

// byre node locks its memory on request.
TEST(ScratchFile, UsesNoMemoryInAProgramWithLockedMemory) {
  if (!kMemoryIsTold) GTEST_SKIP() << "sanitizers use additional memory";
  if (mlockall(MCL_FUTURE | MCL_ONFAULT) != 0) GTEST_SKIP() << "no permission to lock memory";
  {
    ScratchFile file;
    const std::vector<std::byte> bytes = pattern(40000000, 5);
    const double before = resident_mb();
    const auto piece = file.put(bytes);
    EXPECT_TRUE(piece && are(bytes, piece));
    file.release_pages();
    EXPECT_LT(resident_mb(), before + 20.0);
  }
  munlockall();
}

TEST(ScratchFile, AcceptsPiecesOfAnySize) {
  ScratchFile file;
  const std::vector<std::byte> small = pattern(100, 1), large = pattern(70000000, 2);
  const auto first = file.put(small), second = file.put(large), third = file.put(small);
  ASSERT_TRUE(first && second && third);
  EXPECT_TRUE(are(small, first));
  EXPECT_TRUE(are(large, second));
  EXPECT_TRUE(are(small, third));
  EXPECT_TRUE(file.holds(second.get() + large.size() - 1));
}

// Address space may be limited, and emulators keep a record of each page.
TEST(ScratchFile, UsesOnlyTheAddressSpaceOfLivePieces) {
  if (!kMemoryIsTold) GTEST_SKIP() << "sanitizers use additional memory";
  const double before = memory_now().addresses_mb;
  ScratchFile file;
  const std::vector<std::byte> bytes = pattern(1000000, 5);
  for (int i = 0; i < 500; ++i) ASSERT_NE(file.put(bytes), nullptr);
  EXPECT_LT(memory_now().addresses_mb, before + 200.0);
}

TEST(ScratchFile, ReturnsDiskSpaceOfReleasedPieces) {
  ScratchFile file;
  const std::vector<std::byte> bytes = pattern(1000000, 5);
  auto kept = file.put(bytes), dropped = file.put(bytes);
  EXPECT_GE(file.bytes_on_disk(), 2000000u);
  dropped.reset();
  EXPECT_LT(file.bytes_on_disk(), 1100000u);
  EXPECT_TRUE(are(bytes, kept));
}

TEST(ScratchFile, IsReadableDuringWrites) {
  ScratchFile file;
  const std::vector<std::byte> bytes = pattern(300000, 9);
  const auto piece = file.put(bytes);
  bool are_same = true;
  {
    const std::jthread looks([&] {
      for (int i = 0; i < 100; ++i) are_same = are_same && are(bytes, piece);
    });
    for (int i = 0; i < 100; ++i) {
      file.put(bytes);
      file.release_pages();
    }
  }
  EXPECT_TRUE(are_same);
}

// A file size limit of zero simulates a full disk.
class FullDisk {
 public:
  FullDisk() {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit none = before_;
    none.rlim_cur = 0;
    setrlimit(RLIMIT_FSIZE, &none);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST(ScratchFile, RejectsPiecesOnceTheDiskIsFull) {
  ScratchFile file;
  const auto piece = file.put(pattern(100, 1));
  ASSERT_NE(piece, nullptr);
  {
    const FullDisk full;
    EXPECT_EQ(file.put(pattern(100, 2)), nullptr);
  }
  EXPECT_EQ(file.put(pattern(100, 3)), nullptr) << "it has failed once";
  EXPECT_TRUE(are(pattern(100, 1), piece));
}

TEST(ScratchFile, FallsBackToAnotherFolder) {
  const char* const told = std::getenv("TMPDIR");
  const std::optional<std::string> before = told ? std::optional<std::string>(told) : std::nullopt;
  setenv("TMPDIR", "/absent", 1);
  ScratchFile file;
  EXPECT_NE(file.put(pattern(100, 1)), nullptr);
  before ? setenv("TMPDIR", before->c_str(), 1) : unsetenv("TMPDIR");
}

}  // namespace
}  // namespace byre
