#include "byre/io/image/image_names.h"

#include "byre/io/recording/folder_scene.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Optional;

TEST(ComesBefore, SortsDigitsAsNumbers) {
  std::vector<std::string> names = {"frame10.png", "frame9.png", "frame2.png", "a1b10", "a1b9", "a", "frame010.png"};
  std::ranges::sort(names, natural_less);
  EXPECT_THAT(names, ElementsAre("a", "a1b9", "a1b10", "frame2.png", "frame9.png", "frame010.png", "frame10.png"));
}

TEST(ComesBefore, IsAStrictOrder) {
  const std::vector<std::string> names = {"", "0", "00", "1", "01", "1a", "a", "a0", "a1", "99999999999999999999999"};
  for (const std::string& a : names) {
    EXPECT_FALSE(natural_less(a, a)) << a;
    for (const std::string& b : names) {
      EXPECT_EQ(natural_less(a, b) != natural_less(b, a), a != b) << a << " " << b;
    }
  }
}

TEST(TimesInNames, AcceptNanosecondsOrSeconds) {
  EXPECT_THAT(times_in_names({"1403636579763555584.png", "1403636579813555456.png"}),
              Optional(ElementsAre(Timestamp(1403636579763555584), Timestamp(1403636579813555456))));
  EXPECT_THAT(times_in_names({"rgb/1305031102.175304.png", "rgb/1305031102.211214.png"}),
              Optional(ElementsAre(Timestamp(1305031102175304000), Timestamp(1305031102211214000))));
  EXPECT_THAT(times_in_names({"0.png", "50000000.png"}), Optional(ElementsAre(milliseconds(0), milliseconds(50))));
}

TEST(TimesInNames, RejectFrameNumbers) {
  const std::vector<std::vector<fs::path>> cases = {{"000000.png", "000001.png"},
                                                    {"1403636579763555.png", "1403636579796888.png"},
                                                    {"frame1.0.png", "frame2.0.png"},
                                                    {"1403636579763555584.png", "x.png"},
                                                    {"1.5.png", "2.png"},
                                                    {"99999999999999999999999.png", "99999999999999999999999999.png"},
                                                    {"1403636579763555584.png"},
                                                    {}};
  for (const std::vector<fs::path>& files : cases) {
    EXPECT_EQ(times_in_names(files), std::nullopt) << (files.empty() ? "none" : files.front());
  }
}

TEST(TimeInName, IsReadFromOneFileIfUnambiguous) {
  EXPECT_THAT(time_in_name("cam0/1403636579763555584.png"), Optional(Timestamp(1403636579763555584)));
  EXPECT_THAT(time_in_name("1305031102.175304.png"), Optional(Timestamp(1305031102175304000)));
  for (const char* const name : {"000123.png", "1403636579763555.png", "photo.png", "frame1.5.png", ".png"}) {
    EXPECT_EQ(time_in_name(name), std::nullopt) << name;
  }
}

TEST(SteadyTimes, StartAtZero) {
  EXPECT_THAT(uniform_times(3, 20.0), ElementsAre(milliseconds(0), milliseconds(50), milliseconds(100)));
  EXPECT_THAT(uniform_times(0, 20.0), IsEmpty());
}

using ImagesIn = TestFolder;

TEST_F(ImagesIn, ListDirectFilesInNaturalOrder) {
  for (const char* const name : {"10.png", "9.JPG", "notes.txt", "below/1.png"}) write(name, "");
  EXPECT_THAT(images_in(folder_), ElementsAre(folder_ / "9.JPG", folder_ / "10.png"));
  EXPECT_THAT(images_in(folder_ / "absent"), IsEmpty());
}

}  // namespace
}  // namespace byre
