// Localisation of real frames without a pose prior: 100 stereo pairs of EuRoC V1_01 spread over its flight, every
// second one mapped at its true pose; and MH_01, whose first half byre maps.

#include "mapped_recording.h"

#include "byre/features/extract.h"
#include "byre/features/image_threads.h"
#include "byre/io/image/image_file.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/map/map_file.h"
#include "byre/place/map_words.h"
#include "byre/slam/places/localisation.h"
#include "byre/slam/window/map_from_poses.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSparse = "euroc/V1_01_easy_sparse";
constexpr const char* kHall = "euroc/MH_01_easy";
constexpr const char* kElsewhere = "vocabulary";

// A map with words, ready for localisation.
struct MappedPlace {
  explicit MappedPlace(const MapGraph& mapped) {
    stored.map = offline_copy(mapped);
    add_words(stored, shipped_vocabulary());
    index = index_of(stored.map, shipped_vocabulary());
  }

  Localisation find(const Frame& frame, const Rig& rig) const {
    return localise(frame, rig, {&stored.map, nothing_online}, index, {});
  }

  StoredMap stored;
  MapGraph nothing_online{Origin::online};
  PlaceIndex index{shipped_vocabulary()};
};

struct PosedFrames {
  Rig rig;
  std::vector<PosedFrame> frames;
};

// Extracts all frames with a true pose.
PosedFrames posed_frames(const char* name, const FrameRange& range) {
  limit_image_threads(1);
  const auto recording = open_recording(*find_recording(name), range);
  const Trajectory truth = load_truth(*find_recording(name));
  Extractor extractor(recording->calibration(), {});
  PosedFrames result{extractor.rig(), {}};
  for (int i = 0; i < recording->size(); ++i) {
    const Frame frame = extractor.extract(*recording->read(i)).frame;
    const auto world_from_body = pose_at(truth, frame.time, std::chrono::milliseconds(60));
    if (world_from_body) result.frames.push_back({frame, inverse(*world_from_body * result.rig.body_from_camera)});
  }
  return result;
}

double position_error(const Pose& camera_from_world, const Pose& true_camera_from_world) {
  return (inverse(camera_from_world).translation - inverse(true_camera_from_world).translation).norm();
}

class LocalisationInV101 : public testing::Test {
 protected:
  void SetUp() override {
    if (!find_recording(kSparse)) GTEST_SKIP() << missing(kSparse);
  }

  static const PosedFrames& all() {
    static const PosedFrames frames = posed_frames(kSparse, {});
    return frames;
  }

  // Every second frame, starting with frame first.
  static std::vector<PosedFrame> half(std::size_t first) {
    std::vector<PosedFrame> frames;
    for (std::size_t i = first; i < all().frames.size(); i += 2) frames.push_back(all().frames[i]);
    return frames;
  }

  static const MappedPlace& even_half() {
    static const MappedPlace place(map_from_poses({all().rig}, half(0), {}));
    return place;
  }
};

TEST_F(LocalisationInV101, LocatesNineInTenFramesAndNoneFarOff) {
  for (const std::size_t mapped : {0u, 1u}) {
    const MappedPlace place(map_from_poses({all().rig}, half(mapped), {}));
    const std::vector<PosedFrame> wanted = half(1 - mapped);
    int close = 0;
    for (const PosedFrame& frame : wanted) {
      const Localisation found = place.find(frame.frame, all().rig);
      if (!found.tracked) continue;
      const double error = position_error(found.tracked->camera_from_world, frame.camera_from_world);
      const Pose difference = found.tracked->camera_from_world * inverse(frame.camera_from_world);
      close += error < 0.1 && rotation_log(difference.rotation).norm() < 0.035;
      EXPECT_LT(error, 0.5);
    }
    EXPECT_GE(close, 0.9 * static_cast<double>(wanted.size()));
  }
}

TEST_F(LocalisationInV101, RejectsFramesOfTheHall) {
  if (!find_recording(kHall)) GTEST_SKIP() << missing(kHall);
  FrameRange range;
  range.stride = 5;
  const PosedFrames hall = posed_frames(kHall, range);
  ASSERT_TRUE(even_half().find(half(1).front().frame, all().rig).tracked) << "the map itself is valid";
  for (const PosedFrame& frame : hall.frames) EXPECT_FALSE(even_half().find(frame.frame, hall.rig).tracked);
}

TEST_F(LocalisationInV101, RejectsImagesOfOtherPlaces) {
  if (!find_recording(kElsewhere)) GTEST_SKIP() << missing(kElsewhere);
  Calibration camera = open_recording(*find_recording(kSparse), {})->calibration();
  camera.right.reset();
  Extractor extractor(camera, {});
  int looked_for = 0;
  for (const auto& entry : fs::directory_iterator(*find_recording(kElsewhere))) {
    const std::optional<Image> image = read_image(entry.path());
    if (!image) continue;
    ImageFrame images;
    images.left = resize_to_cover(*image, camera.left.width, camera.left.height);
    const Frame frame = extractor.extract(images).frame;
    EXPECT_FALSE(even_half().find(frame, extractor.rig()).tracked) << entry.path();
    ++looked_for;
  }
  EXPECT_GT(looked_for, 100);
}

TEST(LocalisationInMh01, LocatesTheSecondHalfOfAFlightInTheFirst) {
  if (!find_recording(kHall)) GTEST_SKIP() << missing(kHall);
  FrameRange first, second;
  first.last = 150;
  second.first = 150;
  const MappedPlace place(map_recording(*find_recording(kHall), first, make_inline_executor()).map);
  const PosedFrames wanted = posed_frames(kHall, second);
  Trajectory found;
  for (const PosedFrame& frame : wanted.frames) {
    const Localisation result = place.find(frame.frame, wanted.rig);
    if (!result.tracked) continue;
    found.push_back({frame.frame.time, inverse(wanted.rig.body_from_camera * result.tracked->camera_from_world)});
  }
  EXPECT_GE(static_cast<double>(found.size()), 0.99 * static_cast<double>(wanted.frames.size()));

  // The map is aligned to the truth once, by its own keyframes, not by localised frames.
  const Trajectory truth = load_truth(*find_recording(kHall));
  Trajectory keyframes;
  for (const KeyframeId id : place.stored.map.keyframe_ids()) {
    const Keyframe& keyframe = *place.stored.map.find_keyframe(id);
    keyframes.push_back({keyframe.frame.time, inverse(wanted.rig.body_from_camera * keyframe.camera_from_world)});
  }
  const auto aligned_map = absolute_trajectory_error(associate(keyframes, truth, {}), Scale::fixed);
  ASSERT_TRUE(aligned_map);
  const auto errors = absolute_trajectory_error(associate(found, truth, {}), aligned_map->truth_from_estimate);
  EXPECT_LE(errors.translation.median, 0.01);
}

}  // namespace
}  // namespace byre
