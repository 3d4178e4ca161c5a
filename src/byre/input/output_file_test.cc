#include "byre/input/output_file.h"

#include "byre/input_error.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include <gmock/gmock.h>
#include <sys/stat.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

class OutputFile : public testing::Test {
 protected:
  OutputFile() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~OutputFile() override { fs::remove_all(folder_); }

  std::string read(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  auto entries() const { return std::distance(fs::directory_iterator(folder_), {}); }

  const fs::path folder_ = fs::path(testing::TempDir()) / "byre_output_file";
};

TEST_F(OutputFile, IsWrittenUnderAnotherNameFirst) {
  std::ofstream(folder_ / "out.txt") << "old";
  write_whole(folder_ / "out.txt", [this](const fs::path& path) {
    std::ofstream(path) << "new";
    EXPECT_EQ(read("out.txt"), "old");
  });
  EXPECT_EQ(read("out.txt"), "new");
  EXPECT_EQ(entries(), 1);
}

TEST_F(OutputFile, KeepsTheOldOneWhenWritingFails) {
  std::ofstream(folder_ / "out.txt") << "old";
  const auto fail = [](const fs::path& path) {
    std::ofstream(path) << "half";
    throw std::runtime_error("disk full");
  };
  EXPECT_THAT([&] { write_whole(folder_ / "out.txt", fail); }, ThrowsMessage<std::runtime_error>("disk full"));
  EXPECT_EQ(read("out.txt"), "old");
  EXPECT_EQ(entries(), 1);
}

TEST_F(OutputFile, IsWrittenThroughALink) {
  std::ofstream(folder_ / "real.txt") << "old";
  fs::create_symlink("real.txt", folder_ / "link.txt");
  write_whole(folder_ / "link.txt", [](const fs::path& path) { std::ofstream(path) << "new"; });
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
  EXPECT_EQ(read("real.txt"), "new");
}

TEST_F(OutputFile, IsNotReplacedWhereItIsAPipe) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  require_writable(pipe);
  fs::path written;
  write_whole(pipe, [&written](const fs::path& path) { written = path; });
  EXPECT_EQ(written, pipe);
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST_F(OutputFile, IsRefusedBeforeAnythingIsWritten) {
  const auto refusal = [](const fs::path& path) { return [path] { require_writable(path); }; };
  EXPECT_THAT(refusal(folder_ / "absent" / "out.txt"),
              ThrowsMessage<InputError>(HasSubstr("its folder does not exist (make the folder")));
  EXPECT_THAT(refusal(folder_), ThrowsMessage<InputError>(HasSubstr("is a folder (name a file in it)")));
  EXPECT_THAT(refusal(""), ThrowsMessage<InputError>(HasSubstr("is a folder")));
  EXPECT_NO_THROW(require_writable(folder_ / "out.txt"));
  EXPECT_NO_THROW(require_writable("out.txt"));
  EXPECT_EQ(entries(), 0);
}

}  // namespace
}  // namespace byre
