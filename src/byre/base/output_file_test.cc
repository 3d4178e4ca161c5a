#include "byre/base/output_file.h"

#include "byre/base/binary_file.h"
#include "byre/input_error.h"

#include <fstream>
#include <iterator>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kMap =
    "\x89"
    "BYRE\r\n old";
const std::string kNewMap =
    "\x89"
    "BYRE\r\n new";
const std::string kPng = "\x89PNG\r\n\x1a\n";

class OutputFileTest : public testing::Test {
 protected:
  OutputFileTest() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~OutputFileTest() override { fs::remove_all(folder_); }

  void put(const std::string& name, const std::string& content) const { std::ofstream(folder_ / name) << content; }
  std::string read(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  auto entries() const { return std::distance(fs::directory_iterator(folder_), {}); }

  // The refusal of a write; empty if it was written. name: in the folder, or an absolute path.
  std::string refusal(const fs::path& name, const std::string& content) const {
    try {
      write_atomically(folder_ / name, content);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  const fs::path folder_ = fs::weakly_canonical(testing::TempDir()) / ("byre_output_file." + std::to_string(getpid()));
};

TEST_F(OutputFileTest, ReplacesAtomicallyWithoutLeftovers) {
  put("barn.byre", kMap);
  {
    OutputFile file(folder_ / "barn.byre", FileContent::map);
    file.append(kNewMap);
    EXPECT_EQ(read("barn.byre"), kMap);
    EXPECT_EQ(file.temporary().parent_path(), folder_);
    file.publish();
  }
  EXPECT_EQ(read("barn.byre"), kNewMap);
  EXPECT_EQ(entries(), 1);
}

TEST_F(OutputFileTest, KeepsTheOldFileUnlessPublished) {
  put("barn.byre", kMap);
  { OutputFile(folder_ / "barn.byre", FileContent::map).append("half"); }
  EXPECT_EQ(read("barn.byre"), kMap);
  EXPECT_EQ(entries(), 1);
}

TEST_F(OutputFileTest, GrowsUnderItsNameAfterPublishing) {
  OutputFile file(folder_ / "events.json", FileContent::json);
  file.publish();
  file.append("{}\n");
  EXPECT_EQ(read("events.json"), "{}\n");
  file.append("{}\n");
  EXPECT_EQ(read("events.json"), "{}\n{}\n");
}

TEST_F(OutputFileTest, ReplacesOnlyFilesOfTheSameKindAndEmptyOnes) {
  const std::vector<std::pair<std::string, std::string>> others = {
      {"text.txt", "Dear reader\n"},  {"robot.yaml", "slam:\n  map: a\n"}, {"image.png", kPng},
      {"walk.mcap", "\x89MCAP0\r\n"}, {"photo.jpg", "\xff\xd8\xff\xe0"},   {"stats.json", "{}"}};
  for (const auto& [name, content] : others) {
    put(name, content);
    EXPECT_THAT(
        refusal(name, kNewMap),
        HasSubstr("exists and is not the expected kind of file (map) (choose another file, or remove the existing one"))
        << name;
    EXPECT_EQ(read(name), content);
  }
  put("barn.byre", kMap);
  EXPECT_EQ(refusal("barn.byre", kNewMap), "");
  EXPECT_THAT(refusal("barn.byre", "a,b\n1,2\n"),
              HasSubstr("is not the expected kind of file (table of comma-separated values)"));
  put("empty", "");
  EXPECT_EQ(refusal("empty", kNewMap), "");
  EXPECT_EQ(entries(), static_cast<long>(others.size()) + 2);
}

TEST_F(OutputFileTest, DoesNotFollowPlantedLinks) {
  put("letter.txt", "Dear reader\n");
  for (const char* const name : {"barn.byre.unfinished", "barn.byre.00000000.unfinished"}) {
    fs::create_symlink("letter.txt", folder_ / name);
  }
  EXPECT_EQ(refusal("barn.byre", kNewMap), "");
  EXPECT_EQ(read("barn.byre"), kNewMap);
  EXPECT_EQ(read("letter.txt"), "Dear reader\n");
}

TEST_F(OutputFileTest, WritesThroughALinkUnderTheSameRules) {
  fs::create_directory(folder_ / "maps");
  put("maps/real.byre", kMap);
  fs::create_symlink("maps/real.byre", folder_ / "link.byre");
  EXPECT_EQ(refusal("link.byre", kNewMap), "");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.byre"));
  EXPECT_EQ(read("maps/real.byre"), kNewMap);
  EXPECT_EQ(entries(), 2) << "the temporary file was beside the target";

  put("letter.txt", "Dear reader\n");
  fs::create_symlink("letter.txt", folder_ / "trap.byre");
  EXPECT_THAT(refusal("trap.byre", kNewMap), HasSubstr("exists and is not the expected kind of file (map)"));
  fs::create_symlink("new.byre", folder_ / "dangling.byre");
  EXPECT_EQ(refusal("dangling.byre", kNewMap), "");
  EXPECT_EQ(read("new.byre"), kNewMap);
  fs::create_symlink("circle", folder_ / "circle");
  EXPECT_THAT(refusal("circle", kNewMap), HasSubstr("is a circular link"));
  fs::create_symlink("/dev/null", folder_ / "device");
  EXPECT_THAT(refusal("device", kNewMap), HasSubstr("a link to a device"));
}

TEST_F(OutputFileTest, WritesToDevicesDirectlyButNotIntoSystemFolders) {
  EXPECT_EQ(refusal(fs::path("/dev/null"), kNewMap), "");
  EXPECT_THAT(refusal(fs::path("/dev/byre_null.previous"), kNewMap), HasSubstr("is in a system folder"));
  EXPECT_THAT(refusal(fs::path("/proc/byre"), kNewMap), HasSubstr("is in a system folder"));
  EXPECT_THAT(refusal(fs::path("/dev/fd/999"), kNewMap), HasSubstr("is not open for writing"));
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  const int reader = open((folder_ / "pipe").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  EXPECT_EQ(refusal("pipe", "text"), "");
  char received[5] = {};
  EXPECT_EQ(::read(reader, received, 4), 4);
  EXPECT_STREQ(received, "text");
  close(reader);
  EXPECT_TRUE(fs::is_fifo(folder_ / "pipe"));
}

TEST_F(OutputFileTest, ContinuesAFileThatOutputIsRedirectedTo) {
  const int log = open((folder_ / "log").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  EXPECT_EQ(write(log, "before\n", 7), 7);
  write_atomically("/dev/fd/" + std::to_string(log), "in between\n");
  EXPECT_EQ(write(log, "after\n", 6), 6);
  close(log);
  EXPECT_EQ(read("log"), "before\nin between\nafter\n");
}

TEST_F(OutputFileTest, ReportsReasonAndRemedy) {
  EXPECT_THAT(refusal("absent/out.byre", kNewMap), HasSubstr("the folder does not exist (create the folder"));
  EXPECT_THAT(refusal(folder_, kNewMap), HasSubstr("is a folder (choose a file in it)"));
  EXPECT_THAT(refusal(fs::path(""), kNewMap), HasSubstr("is a folder"));
  EXPECT_THAT(
      refusal(fs::path("/dev/full"), kNewMap),
      HasSubstr("/dev/full: cannot be written: No space left on device (free disk space, or choose a file on another"));
  put("protected.byre", kMap);
  fs::permissions(folder_ / "protected.byre", fs::perms::owner_read);
  EXPECT_THAT(refusal("protected.byre", kNewMap), HasSubstr("is write-protected"));
  EXPECT_EQ(read("protected.byre"), kMap);
  EXPECT_NO_THROW(require_writable(folder_ / "out.txt"));
  EXPECT_NO_THROW(require_writable("out.txt"));
  EXPECT_THROW(require_writable(folder_ / "protected.byre", FileContent::map), InputError);
  EXPECT_EQ(entries(), 1) << "nothing was written";
}

TEST_F(OutputFileTest, KeepsThePermissionsOfTheReplacedFile) {
  put("barn.byre", kMap);
  fs::permissions(folder_ / "barn.byre", fs::perms(0640));
  EXPECT_EQ(refusal("barn.byre", kNewMap), "");
  EXPECT_EQ(fs::status(folder_ / "barn.byre").permissions(), fs::perms(0640));
}

TEST_F(OutputFileTest, RemovesOnlyTemporaryFilesOfKilledProcesses) {
  put("barn.byre.0123abcd.unfinished", "of a killed process");
  put("barn.byre.unfinished", "another name");
  put("barn.byre.0123abcz.unfinished", "another name");
  put("other.byre.0123abcd.unfinished", "of another file");
  put("letter.txt", "Dear reader\n");
  fs::create_symlink("letter.txt", folder_ / "barn.byre.00000001.unfinished");
  put("barn.byre.00000002.unfinished", "being written by another process");
  const int other = open((folder_ / "barn.byre.00000002.unfinished").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(flock(other, LOCK_EX), 0);
  EXPECT_EQ(refusal("barn.byre", kNewMap), "");
  EXPECT_FALSE(fs::exists(folder_ / "barn.byre.0123abcd.unfinished"));
  EXPECT_EQ(entries(), 7);
  close(other);
  EXPECT_EQ(refusal("barn.byre", kNewMap), "");
  EXPECT_EQ(entries(), 6);
  EXPECT_EQ(read("letter.txt"), "Dear reader\n");
}

TEST_F(OutputFileTest, RemovesTemporaryFilesOnATerminatingSignal) {
  const pid_t process = fork();
  if (process == 0) {
    OutputFile file(folder_ / "barn.byre", FileContent::map);
    OutputFile published(folder_ / "events.json", FileContent::json);
    published.publish();
    remove_unpublished_files();
    _exit(fs::exists(file.temporary()) ? 1 : 0);
  }
  int status = 0;
  waitpid(process, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "events.json"));
  EXPECT_EQ(entries(), 1);
}

TEST_F(OutputFileTest, AcceptsLongNames) {
  const std::string longest(250, 'n');
  EXPECT_EQ(refusal(longest, "text"), "");
  EXPECT_EQ(read(longest), "text");
  EXPECT_THAT(refusal(std::string(300, 'n'), "text"), HasSubstr("choose a shorter name"));
  EXPECT_EQ(entries(), 1);
}

TEST_F(OutputFileTest, IsKeptUnderASecondName) {
  put("barn.byre", kMap);
  link_or_copy(folder_ / "barn.byre", folder_ / "previous.byre");
  EXPECT_EQ(refusal("barn.byre", kNewMap), "");
  EXPECT_EQ(read("previous.byre"), kMap);
  link_or_copy(folder_ / "barn.byre", folder_ / "previous.byre");
  link_or_copy(folder_ / "barn.byre", folder_ / "previous.byre");  // already the same file
  EXPECT_EQ(read("previous.byre"), kNewMap);
  put("letter.txt", "Dear reader\n");
  EXPECT_THROW(link_or_copy(folder_ / "barn.byre", folder_ / "letter.txt"), InputError);
  EXPECT_EQ(read("letter.txt"), "Dear reader\n");
  EXPECT_EQ(entries(), 3);
}

}  // namespace
}  // namespace byre
