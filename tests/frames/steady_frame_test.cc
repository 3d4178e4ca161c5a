#include "../accuracy/mapped_recording.h"
#include "../allocations.h"

#include "byre/features/extract.h"
#include "byre/features/image_threads.h"
#include "byre/simulation/simulated_mission_scene.h"
#include "byre/slam/session/session.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace byre {
namespace {

// Counts heap allocations of steady frames: frames with a pose, at least kFramesOfKeyframe after the last keyframe. By
// then mapping has nothing to hand over, and images and features reuse their memory. Skips warm-up frames.
class SteadyFrames {
 public:
  template <typename Process>
  void count(Process&& process) {
    constexpr int kFramesOfKeyframe = 3;
    const std::size_t before = allocations_so_far().count;
    const FrameReport report = process();
    const std::size_t made = allocations_so_far().count - before;
    const bool is_steady = report.map_from_body && !report.keyframe_added;
    frames_since_keyframe_ = is_steady ? frames_since_keyframe_ + 1 : 0;
    if (frames_since_keyframe_ < kFramesOfKeyframe) return;
    if (frames_to_warm_up_ > 0) {
      --frames_to_warm_up_;
    } else {
      allocations_.push_back(made);
    }
  }

  int counted() const { return static_cast<int>(allocations_.size()); }
  // Share of steady frames without an allocation. The others grow a list, such as that of poses, beyond its capacity.
  double share_without() const {
    return static_cast<double>(std::ranges::count(allocations_, 0U)) / static_cast<double>(counted());
  }

 private:
  std::vector<std::size_t> allocations_;  // per frame
  int frames_since_keyframe_ = 0;
  int frames_to_warm_up_ = 30;
};

SimulatedMission lap(std::uint64_t noise_seed) {
  SimulationOptions options;
  options.landmarks = 12000;
  options.seed = 1;
  options.noise_seed = noise_seed;
  return simulate_mission(simulated_rig(), circling_trajectory(300, 30.0, 2.0, 1.0), options);
}

TEST(SteadyFrame, OfAMissionAllocatesNothing) {
  MapGraph map = true_map(lap(1), 3, Origin::offline);
  for (const KeyframeId id : map.keyframe_ids()) {
    map.set_words(id, shipped_vocabulary().words_of(*map.find_keyframe(id)->frame.features));
  }
  const auto offline = std::make_shared<const OfflineMap>(std::move(map), shipped_vocabulary());
  const SimulatedMission mission = lap(2);
  Session session(mission.rig, {}, SessionExecutors(make_inline_executor(), make_inline_executor()),
                  shipped_vocabulary(), offline);
  SteadyFrames steady;
  for (const Frame& frame : mission.frames) steady.count([&] { return session.process(frame); });
  EXPECT_GE(steady.counted(), 200);
  EXPECT_GE(steady.share_without(), 0.95);
}

TEST(SteadyFrame, OfAStereoCameraAllocatesNothing) {
  const auto folder = find_recording("euroc/MH_01_easy");
  if (!folder) GTEST_SKIP() << missing("euroc/MH_01_easy");
  limit_image_threads(1);
  const std::unique_ptr<Recording> recording = open_recording(*folder, {}, {});
  Extractor extractor(recording->calibration(), {});
  Session session(extractor.rig(), {}, make_inline_executor());
  SteadyFrames steady;
  for (int i = 0; i < recording->size(); ++i) {
    const std::optional<ImageFrame> images = recording->read(i);
    ASSERT_TRUE(images);
    steady.count([&] { return session.process(extractor.extract(*images).frame); });
  }
  EXPECT_GE(steady.counted(), 100);
  EXPECT_GE(steady.share_without(), 0.95);
}

}  // namespace
}  // namespace byre
