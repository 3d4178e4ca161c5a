// One hand-held camera at one desk, recorded twice (TUM RGB-D): a walk around the desk is mapped; in the mission the
// camera is turned by hand on the spot. Both truths are in one frame, so errors in the map's frame need no further
// alignment. The camera has a rolling shutter that its calibration does not mention.

#include "mapped_recording.h"

#include "byre/features/extract.h"
#include "byre/features/image_threads.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/map/map_file.h"
#include "byre/place/map_words.h"
#include "byre/slam/places/offline_map.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr const char* kDesk = "tum/freiburg1_desk";
constexpr const char* kTurns = "tum/freiburg1_rpy";
constexpr double kAsGood = 1.1;  // largest ratio of errors

struct Poses {
  Trajectory causal;
  Trajectory final;
};

// Like the program: with the map's calibration of the camera, only the readout time is refined further.
void refine(Session& session, const Calibration& given, const std::optional<RefinedCalibration>& known) {
  if (known) {
    session.refine_readout(*known);
  } else {
    session.refine_calibration(given, {});
  }
}

Poses follow(Session& session, Recording& recording, Extractor& extractor) {
  Poses poses;
  for (int i = 0; i < recording.size(); ++i) {
    const auto images = recording.read(i);
    if (!images) continue;
    const FrameReport report = session.process(extractor.extract(*images).frame);
    if (report.map_from_body) poses.causal.push_back({report.time, *report.map_from_body});
  }
  session.finish();
  poses.final = session.final_trajectory();
  return poses;
}

// A monocular map, scaled by the truth.
struct DeskMap {
  std::shared_ptr<const OfflineMap> map;
  Similarity truth_from_map;
};

DeskMap make_desk_map() {
  const auto recording = open_recording(*find_recording(kDesk), {});
  Extractor extractor(recording->calibration(), {});
  Session session(extractor.rig(), {}, SessionExecutors(make_inline_executor(), make_inline_executor()),
                  shipped_vocabulary());
  refine(session, recording->calibration(), std::nullopt);
  follow(session, *recording, extractor);
  session.finish_map({[] { return false; }, [](const char*) {}});
  const auto error = absolute_trajectory_error(
      associate(session.final_trajectory(), load_truth(*find_recording(kDesk)), {}), Scale::free);
  Similarity truth_from_map = error.value().truth_from_estimate;
  StoredMap stored;
  stored.map = scaled_copy(offline_copy(session.map().online()), truth_from_map.scale);
  truth_from_map.scale = 1.0;
  stored.recordings = {{kDesk, recording->calibration(), {}, {}, session.self_calibration()}};
  add_words(stored, shipped_vocabulary());
  return {std::make_shared<const OfflineMap>(std::move(stored.map), shipped_vocabulary(), std::move(stored.recordings)),
          truth_from_map};
}

Poses run_mission(const std::shared_ptr<const OfflineMap>& map, bool map_online) {
  const auto recording = open_recording(*find_recording(kTurns), {});
  const Calibration given = recording->calibration();
  const auto known = map ? stored_calibration(map->recordings(), given) : std::nullopt;
  Extractor extractor(known ? known->calibration : given, {});
  SessionOptions options;
  options.map_online = map_online;
  Session session(extractor.rig(), options, SessionExecutors(make_inline_executor(), make_inline_executor()),
                  shipped_vocabulary(), map);
  refine(session, given, known);
  return follow(session, *recording, extractor);
}

Trajectory at_times_of(const Trajectory& other, const Trajectory& trajectory) {
  Trajectory common;
  for (const StampedPose& pose : trajectory) {
    if (std::ranges::binary_search(other, pose.time, {}, &StampedPose::time)) common.push_back(pose);
  }
  return common;
}

class DeskMissions : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {kDesk, kTurns}) {
      if (!find_recording(name)) GTEST_SKIP() << missing(name);
    }
    limit_image_threads(1);
  }

  // RMSE in the map's frame, metres.
  static double error_in_map(const Trajectory& poses) {
    return absolute_trajectory_error(associate(poses, truth(), {}), desk().truth_from_map).translation.rmse;
  }

  // RMSE after Sim(3) alignment, metres.
  static double error_of_shape(const Trajectory& poses) {
    return absolute_trajectory_error(associate(poses, truth(), {}), Scale::free).value().translation.rmse;
  }

  static const Trajectory& truth() {
    static const Trajectory read = load_truth(*find_recording(kTurns));
    return read;
  }
  static const DeskMap& desk() {
    static const DeskMap made = make_desk_map();
    return made;
  }
  static const Poses& hybrid() {
    static const Poses flown = run_mission(desk().map, true);
    return flown;
  }
};

TEST_F(DeskMissions, EstimateTheShutterAndTrackATurnOnTheMap) {
  const double readout_time = desk().map->recordings().front().present_calibration().readout_time;
  EXPECT_GT(readout_time, 0.015);
  EXPECT_LT(readout_time, 0.035);
  EXPECT_GT(hybrid().causal.size(), 455);
  EXPECT_LT(error_in_map(hybrid().causal), 0.022);
}

TEST_F(DeskMissions, TrackATurnNoWorseThanLocalisationAlone) {
  const Poses localised = run_mission(desk().map, false);
  const double by_hybrid = error_in_map(at_times_of(localised.causal, hybrid().causal));
  const double alone = error_in_map(at_times_of(hybrid().causal, localised.causal));
  EXPECT_GT(localised.causal.size(), 240);
  EXPECT_LE(by_hybrid, kAsGood * alone) << "of " << localised.causal.size() << " poses";
}

TEST_F(DeskMissions, TrackATurnNoWorseThanWithoutAMap) {
  const Poses without = run_mission(nullptr, true);
  ASSERT_GT(without.final.size(), 100);
  const double by_hybrid = error_of_shape(at_times_of(without.final, hybrid().final));
  const double alone = error_of_shape(at_times_of(hybrid().final, without.final));
  EXPECT_LE(by_hybrid, kAsGood * alone) << "of " << without.final.size() << " poses";
}

}  // namespace
}  // namespace byre
