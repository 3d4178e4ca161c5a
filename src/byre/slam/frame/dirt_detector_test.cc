#include "byre/slam/frame/dirt_detector.h"

#include "byre/slam/tracking/mission_scene.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

bool is_behind(const Eigen::Vector2f& pixel) {
  return pixel.x() > 300.0f && pixel.x() < 420.0f && pixel.y() > 150.0f && pixel.y() < 260.0f;
}

// Drive round a room on a true map with true predictions, optionally with dirt on the lens.
class Drive {
 public:
  explicit Drive(double laps)
      : mission_(simulate_mission(simulated_rig(), circling_trajectory(static_cast<int>(200 * laps), 10.0, 2.0, laps),
                                  without_noise())),
        map_(true_map(mission_, 5, Origin::online)) {}

  int frames() const { return static_cast<int>(mission_.frames.size()); }

  // late: delay of the frames.
  void go(DirtDetector& watch, int first, int last, bool is_dirty, Timestamp late = {}) {
    const MapView view(nullptr, map_);
    for (int i = first; i < last; ++i) {
      Frame seen = is_dirty ? soiled(mission_.frames[static_cast<std::size_t>(i)])
                            : mission_.frames[static_cast<std::size_t>(i)];
      seen.time += late;
      const auto tracked = track(seen, true_camera_from_world(mission_, static_cast<std::size_t>(i)), mission_.rig,
                                 view, local_points(view, {Origin::online, static_cast<std::uint32_t>(i / 5)}, 30), {});
      if (tracked) watch.note(seen, *tracked, mission_.rig, view);
      if (const auto event = watch.take_event()) reported_.push_back(*event);
    }
  }

  const std::vector<SessionEvent>& reported() const { return reported_; }
  const Rig& rig() const { return mission_.rig; }

 private:
  Frame soiled(const Frame& frame) const { return seen_beside(frame, mission_.rig, is_behind); }

  SimulatedMission mission_;
  MapGraph map_;
  std::vector<SessionEvent> reported_;
};

TEST(DirtDetector, StaysEmptyOnACleanLens) {
  Drive drive(1.0);
  DirtDetector watch;
  drive.go(watch, 0, drive.frames(), false);
  EXPECT_FALSE(watch.hidden().any());
  EXPECT_TRUE(drive.reported().empty());
}

TEST(DirtDetector, LocatesABlotAndItsRemoval) {
  Drive drive(2.0);
  DirtDetector watch;
  drive.go(watch, 0, drive.frames() / 2, true);
  EXPECT_TRUE(watch.hidden().hides({360.0, 205.0}, drive.rig()));
  EXPECT_FALSE(watch.hidden().hides({150.0, 205.0}, drive.rig()));
  EXPECT_FALSE(watch.hidden_right().any()) << "no right image";
  ASSERT_FALSE(drive.reported().empty());
  EXPECT_EQ(drive.reported().front(), SessionEvent::dirt_found);
  drive.go(watch, drive.frames() / 2, drive.frames(), false);
  EXPECT_FALSE(watch.hidden().any());
  EXPECT_EQ(drive.reported().back(), SessionEvent::dirt_gone);
}

TEST(DirtDetector, LearnsNothingAtAStandstill) {
  Drive drive(1.0);
  DirtDetector watch;
  for (int i = 0; i < 100; ++i) drive.go(watch, 20, 21, true, i * std::chrono::seconds(1));
  EXPECT_FALSE(watch.hidden().any());
}

}  // namespace
}  // namespace byre
