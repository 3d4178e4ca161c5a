#include "byre/ros2/node/mission_sessions.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

class MissionSessions : public testing::Test {
 protected:
  MissionSessions() { fs::create_directories(folder_); }
  ~MissionSessions() override { fs::remove_all(folder_); }

  static std::chrono::system_clock::time_point at(int seconds) {
    return std::chrono::system_clock::time_point(std::chrono::seconds(1'764'379'800 + seconds));
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_sessions." + std::to_string(getpid()));
  fs::path map_ = folder_ / "barn.byre";
};

TEST_F(MissionSessions, AreNamedByMapAndTimeInUtc) {
  EXPECT_EQ(session_file(map_, at(0)), folder_ / "barn.20251129T013000Z.session");
  EXPECT_EQ(session_file("barn.byre", at(0)), "barn.20251129T013000Z.session");
  EXPECT_EQ(proposed_map(map_), folder_ / "barn.proposed.byre");
}

TEST_F(MissionSessions, AreThoseOfTheMapInOrderOfTime) {
  EXPECT_THAT(waiting_sessions(map_), IsEmpty());
  for (const int seconds : {7, 0, 90}) std::ofstream(session_file(map_, at(seconds))) << "session";
  for (const char* const other : {"barn.session", "barn.evening.session", "barn_2.20251129T013000Z.session",
                                  "barn.20251129T013000Z.session.0123abcd.unfinished"}) {
    std::ofstream(folder_ / other) << "session";
  }
  EXPECT_THAT(waiting_sessions(map_),
              ElementsAre(session_file(map_, at(0)), session_file(map_, at(7)), session_file(map_, at(90))));
}

TEST_F(MissionSessions, AreAtMostTheTenNewest) {
  for (int i = 0; i < 13; ++i) std::ofstream(session_file(map_, at(i))) << "session";
  EXPECT_EQ(waiting_sessions(map_).front(), session_file(map_, at(3)));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 10);
}

}  // namespace
}  // namespace byre
