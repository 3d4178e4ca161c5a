#include "byre/base/binary_file.h"

#include "byre/base/output_file.h"
#include "byre/input_error.h"

#include <array>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

class BinaryFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("binary_file_" + std::to_string(getpid()));
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
};

TEST_F(BinaryFile, ReadsWrittenBytes) {
  write_atomically(folder_ / "file", bytes_of("a\0b"));
  EXPECT_EQ(text_of(read_file(folder_ / "file")), text_of(bytes_of("a\0b")));
}

TEST_F(BinaryFile, ThrowsIfUnreadable) {
  EXPECT_THROW(read_file(folder_ / "absent"), InputError);
  EXPECT_THROW(read_file(folder_), InputError);
  EXPECT_THROW(MappedFile(folder_ / "absent"), InputError);
}

TEST_F(BinaryFile, MapsTheBytesOfTheFile) {
  write_atomically(folder_ / "file", bytes_of("mapped"));
  EXPECT_EQ(text_of(MappedFile(folder_ / "file").bytes()), "mapped");
  write_atomically(folder_ / "empty", "");
  EXPECT_TRUE(MappedFile(folder_ / "empty").bytes().empty());
}

TEST_F(BinaryFile, ReadsPieces) {
  write_atomically(folder_ / "file", bytes_of("one two three"));
  const RandomAccessFile file(folder_ / "file");
  EXPECT_EQ(file.size(), 13u);
  std::array<std::byte, 3> piece;
  file.read(4, piece);
  EXPECT_EQ(text_of(piece), "two");
  write_atomically(folder_ / "file", bytes_of("another"));
  file.read(0, piece);
  EXPECT_EQ(text_of(piece), "one") << "the opened file";
  EXPECT_THROW(file.read(11, piece), InputError);
  EXPECT_THROW(RandomAccessFile(folder_ / "absent"), InputError);
  EXPECT_THROW(RandomAccessFile{folder_}, InputError);
}

TEST_F(BinaryFile, ReportsTruncationAfterOpening) {
  write_atomically(folder_ / "file", bytes_of("one two three"));
  const RandomAccessFile file(folder_ / "file");
  fs::resize_file(folder_ / "file", 5);
  std::array<std::byte, 3> piece;
  try {
    file.read(4, piece);
    FAIL() << "read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("was truncated after it was opened"));
  }
}

TEST_F(BinaryFile, RejectsPipesAndCircularLinks) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  fs::create_symlink("circle", folder_ / "circle");
  EXPECT_THROW(read_file(folder_ / "pipe"), InputError);
  EXPECT_THROW(MappedFile(folder_ / "pipe"), InputError);
  EXPECT_THROW(read_file(folder_ / "circle"), InputError);
  EXPECT_THROW(read_file("/dev/zero"), InputError);
}

}  // namespace
}  // namespace byre
