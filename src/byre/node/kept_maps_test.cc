#include "byre/node/kept_maps.h"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

class KeptMaps : public testing::Test {
 protected:
  KeptMaps() { fs::create_directories(folder_); }
  ~KeptMaps() override { fs::remove_all(folder_); }

  static std::string content(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_kept_maps." + std::to_string(getpid()));
  fs::path map_ = folder_ / "barn.byre";
};

TEST_F(KeptMaps, AreTheOneThatIsSavedAndTheOneBefore) {
  keep_as_previous(map_);
  EXPECT_FALSE(fs::exists(previous_map(map_))) << "there was none";
  for (const char* day : {"monday", "tuesday", "wednesday"}) {
    keep_as_previous(map_);
    fs::remove(map_);  // another file takes the name
    std::ofstream(map_) << day;
  }
  EXPECT_EQ(content(map_), "wednesday");
  EXPECT_EQ(content(folder_ / "barn.previous.byre"), "tuesday");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2);
}

TEST_F(KeptMaps, LeaveNothingBesideWhereASaveWasInterruptedBeforeTheMapWasReplaced) {
  std::ofstream(map_) << "monday";
  for (int save = 0; save < 2; ++save) keep_as_previous(map_);
  EXPECT_EQ(content(previous_map(map_)), "monday");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2);
}

TEST_F(KeptMaps, OutliveWhatAnInterruptedSaveLeft) {
  std::ofstream(map_) << "monday";
  std::ofstream(folder_ / "barn.previous.byre.unfinished") << "half";
  keep_as_previous(map_);
  EXPECT_EQ(content(previous_map(map_)), "monday");
  EXPECT_FALSE(fs::exists(folder_ / "barn.previous.byre.unfinished"));
}

}  // namespace
}  // namespace byre
