// Occupancy grid of a map of the simulated barn, compared with the barn itself.

#include "cowshed_grid.h"
#include "mapped_recording.h"

#include "byre/map/plan/occupancy_grid.h"

#include <string>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

class CowshedGrid : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    CowshedRecordingOptions options;
    options.image_divisor = 2;
    options.frame_rate_hz = 8.0;
    options.duration_s = 18.0;
    CowshedRecording recording(options);
    folder_ = fs::path(testing::TempDir()) / ("byre_cowshed_grid." + std::to_string(getpid()));
    write_cowshed_recording(recording, folder_, [](int) { return true; });
    const MappedRecording mapped = map_recording(folder_, {}, make_inline_executor());
    PlanRegistration registration;  // exact: the map begins at the first frame's body
    registration.plan_from_map.target_from_source = recording.world_from_body(recording.times().front());
    const OccupancyGrid grid = occupancy_grid(mapped.map, registration).value();
    BarnView view;
    view.range = 4.0;
    score_ = score_of(grid.plan, grid.occupancy, barn_from_above(recording, view));
    RecordProperty("walls", score_.walls);
    RecordProperty("found_percent", static_cast<int>(100.0 * score_.found));
    RecordProperty("occupied", score_.occupied);
    RecordProperty("right_percent", static_cast<int>(100.0 * score_.right));
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static inline fs::path folder_;
  static inline GridScore score_;
};

TEST_F(CowshedGrid, HasNoWallOnTheDrivenPath) {
  EXPECT_EQ(score_.driven_occupied, 0);
}

TEST_F(CowshedGrid, HasWallsWhereTheBarnHasThem) {
  EXPECT_GT(score_.occupied, 1000);
  EXPECT_GT(score_.right, 0.95);
}

// Bars of fences, smooth curbs and the tops of troughs have few points.
TEST_F(CowshedGrid, HasMostWallsWithinFourMetres) {
  EXPECT_GT(score_.walls, 5000);
  EXPECT_GT(score_.found, 0.6);
}

}  // namespace
}  // namespace byre
