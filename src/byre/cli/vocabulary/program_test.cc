
#include "byre/cli/shared/program_fixture.h"
#include "byre/io/image/image_names.h"

#include <random>
#include <string>

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class VocabularyProgram : public ProgramTest {
 protected:
  // Writes a binary PGM image of random rectangles.
  void write_image(const std::string& name, int width, int height, unsigned seed) const {
    std::mt19937 random(seed);
    std::string pixels(static_cast<std::size_t>(width * height), '\x80');
    for (int rectangle = 0; rectangle < 60; ++rectangle) {
      const auto left = static_cast<int>(random() % static_cast<unsigned>(width));
      const auto top = static_cast<int>(random() % static_cast<unsigned>(height));
      const auto grey = static_cast<char>(random() % 256);
      for (int y = top; y < std::min(top + 25, height); ++y) {
        for (int x = left; x < std::min(left + 30, width); ++x) pixels[static_cast<std::size_t>(y * width + x)] = grey;
      }
    }
    write(name, "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" + pixels);
  }

  void write_images() const {
    std::filesystem::create_directories(folder_ / "images");
    write_image("images/b.pgm", 320, 240, 1);
    write_image("images/a.PGM", 320, 240, 2);
    write_image("images/c.pgm", 200, 260, 3);
    write("images/readme.txt", "no image");
  }
};

TEST_F(VocabularyProgram, TrainsTheSameVocabularyEachTime) {
  write_images();
  const std::string command = "vocabulary train images --branching 5 --depth 2 --features 300 -o ";
  const Outcome first = run(command + "first.vocabulary");
  EXPECT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_THAT(first.output,
              StartsWith("vocabulary   first.vocabulary\nwords        25\nbranching    5\ndepth        2\n"));
  EXPECT_THAT(first.output, HasSubstr(" descriptors of 3 images\n"));
  EXPECT_THAT(first.errors, HasSubstr("3 of 3 images"));
  EXPECT_EQ(run(command + "second.vocabulary --quiet").errors, "");
  EXPECT_EQ(run(command + "other.vocabulary --seed 2").exit_code, 0);
  EXPECT_EQ(read("second.vocabulary"), read("first.vocabulary"));
  EXPECT_NE(read("other.vocabulary"), read("first.vocabulary"));
}

TEST_F(VocabularyProgram, SkipsUnreadableImagesWithAWarning) {
  write_images();
  write("images/broken.png", "not a PNG");
  write_image("images/tiny.pgm", 3, 2, 4);
  const Outcome outcome = run("vocabulary train images --features 300 -o out.vocabulary");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr(" descriptors of 4 images\n"));
  EXPECT_THAT(outcome.errors, HasSubstr("byre: warning: images/broken.png: cannot be read as an image, skipped\n"));
}

TEST_F(VocabularyProgram, ImportsAndShowsAVocabularyOfDbow2) {
  std::string bytes;
  for (int i = 0; i < 32; ++i) bytes += " 17";
  write("dbow2.txt", "2 1 0 0\n0 1" + bytes + " 1.5\n0 1" + bytes + " 2.5\n");
  const Outcome imported = run("vocabulary import dbow2.txt -o imported.vocabulary");
  EXPECT_EQ(imported.exit_code, 0) << imported.errors;
  EXPECT_THAT(imported.output, HasSubstr("words        2\nbranching    2\ndepth        1\n"));
  EXPECT_EQ(run("vocabulary show imported.vocabulary").output, imported.output);
}

TEST_F(VocabularyProgram, ShowsTheVocabularyInUse) {
  const Outcome shipped = run("vocabulary show");
  EXPECT_EQ(shipped.exit_code, 0) << shipped.errors;
  EXPECT_THAT(shipped.output, HasSubstr("default.vocabulary\n"));
}

TEST_F(VocabularyProgram, RejectsWrongUsage) {
  write_images();
  for (const char* const arguments :
       {"", "teach", "train", "train images", "train images -o out --branching 1", "train images -o out --depth 17",
        "train images -o out --seed -1", "import -o out", "show a b"}) {
    const Outcome outcome = run(std::string("vocabulary ") + arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith("byre: error: ")) << arguments;
    EXPECT_THAT(outcome.output, IsEmpty()) << arguments;
  }
}

TEST_F(VocabularyProgram, NamesBadInput) {
  write_images();
  std::filesystem::create_directories(folder_ / "empty");
  write("broken.txt", "10 6 0 0\n0 1 2\n");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"train absent -o out", "byre: error: absent: does not exist"},
      {"train empty -o out", "byre: error: empty: contains no images"},
      {"train images -o absent/out", "byre: error: absent/out: cannot be written"},
      {"train images/a.PGM --quiet -o out", "byre: error: vocabulary: fewer than two training images"},
      {"import broken.txt -o out", "byre: error: broken.txt:2: has 3 fields"},
      {"show broken.txt", "byre: error: broken.txt: section header at byte 0: is not a vocabulary of byre"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run("vocabulary " + arguments);
    EXPECT_EQ(outcome.exit_code, 3) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith(message));
    EXPECT_THAT(outcome.output, IsEmpty()) << arguments;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }
}

TEST_F(VocabularyProgram, ReadsImagesOfAFolderInOrderOfNames) {
  write_images();
  const std::vector<std::filesystem::path> paths = {folder_ / "images", folder_ / "images/readme.txt"};
  EXPECT_THAT(find_images(paths), testing::ElementsAre(folder_ / "images/a.PGM", folder_ / "images/b.pgm",
                                                       folder_ / "images/c.pgm", folder_ / "images/readme.txt"));
}

}  // namespace
}  // namespace byre::cli
