#include "byre/playback/missing_poses.h"

#include "byre/playback/play.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/slam.h"
#include "byre/trajectory_error.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

// A finished map of a recording, and its final trajectory.
class FinishedMap : public ::testing::Test {
 protected:
  FinishedMap() {
    for (int i = 0; i < recording_->size(); ++i) slam_.impl().process(*recording_->read(i));
    slam_.impl().finish({[] { return false; }, {}});
    final_ = slam_.impl().session().final_trajectory();
    again_ = {recording_->times(), [this](int number) { return recording_->read(number); }, [] { return false; }};
  }

  // The final trajectory without the poses of these frames.
  Trajectory without(std::size_t begin, std::size_t end) const {
    Trajectory rest = final_;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(begin), rest.begin() + static_cast<std::ptrdiff_t>(end));
    return rest;
  }
  double largest_difference(const Trajectory& found) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < final_.size(); ++i) {
      largest =
          std::max(largest, (found[i].world_from_body.translation - final_[i].world_from_body.translation).norm());
    }
    return largest;
  }

  std::unique_ptr<Recording> recording_ = open_recording(RenderedFixture::shared().folder(), {});
  Slam slam_ = [this] {
    SlamOptions options;
    options.workers = Workers::none;
    return Slam::mapping(recording_->calibration(), options);
  }();
  Trajectory final_;
  FramesAgain again_;
};

TEST_F(FinishedMap, LocatesFramesBeforeItsBeginningAndInGaps) {
  ASSERT_EQ(final_.size(), again_.times.size());
  for (const auto& [begin, end] : {std::pair(0u, 3u), std::pair(3u, 6u)}) {
    const Trajectory found = with_missing_poses(slam_.impl(), without(begin, end), again_);
    ASSERT_EQ(found.size(), final_.size());
    EXPECT_LT(largest_difference(found), 0.02) << "metres";
  }
}

TEST_F(FinishedMap, LeavesOutFramesThatItDoesNotShow) {
  again_.read = [this](int number) {
    auto images = recording_->read(number);
    if (number >= 3 && number < 5) std::ranges::fill(images->left.pixels, std::uint8_t{90});
    return images;
  };
  EXPECT_EQ(with_missing_poses(slam_.impl(), without(3, 6), again_).size(), final_.size() - 2);
}

TEST_F(FinishedMap, StopsOnRequest) {
  again_.should_stop = [] { return true; };
  EXPECT_EQ(with_missing_poses(slam_.impl(), without(3, 6), again_).size(), final_.size() - 3);
}

}  // namespace
}  // namespace byre
