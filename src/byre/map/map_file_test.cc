#include "byre/map/map_file.h"

#include "byre/base/binary_file.h"
#include "byre/input_error.h"
#include "byre/map/map_bytes_scene.h"
#include "byre/map/stored_map_scene.h"

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

MapBytes scene_bytes() {
  return write_map(StoredMapScene().stored());
}

float largest_of(const Eigen::Vector2f& difference) {
  return difference.cwiseAbs().maxCoeff();
}

int largest_difference(const Patch& a, const Patch& b) {
  int largest = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) largest = std::max(largest, std::abs(a.pixels[i] - b.pixels[i]));
  return largest;
}

TEST(MapFile, ReadsBackTheScene) {
  const StoredMapScene scene;
  const StoredMap read = read_map(scene_bytes(), "file");
  EXPECT_THAT(find_faults(scene.stored()), IsEmpty());
  EXPECT_THAT(find_faults(read), IsEmpty());
  EXPECT_EQ(read.notes, scene.stored().notes);
  EXPECT_EQ(read.vocabulary_checksum, scene.stored().vocabulary_checksum);
  EXPECT_EQ(read.pose_source, PoseSource::given);
  EXPECT_EQ(read.scale, MapScale::metric);
  EXPECT_EQ(read.map.origin(), Origin::offline);
  EXPECT_EQ(read.map.rigs().size(), 2u);
  EXPECT_EQ(read.recordings.at(0).name, "barn_morning");
  EXPECT_EQ(read.recordings.at(0).last_time, std::chrono::seconds(200));
  EXPECT_TRUE(read.recordings.at(0).calibration.right.has_value());
  EXPECT_EQ(read.recordings.at(1).calibration.left.model, CameraModel::equidistant);
  EXPECT_EQ(read.recordings.at(1).calibration.left.distortion[1], -0.002);
}

TEST(MapFile, ReadsBackEveryLensModel) {
  for (int model = 0; model < kCameraModels; ++model) {
    StoredMap stored = StoredMapScene().stored();
    Camera& lens = stored.recordings[0].calibration.left;
    lens.model = static_cast<CameraModel>(model);
    lens.distortion = {0.1, 0.2, 0.3, 0.4, 0.5};
    if (lens.model > CameraModel::equidistant) lens.distortion.back() = 0.01;
    const StoredMap read = read_map(write_map(stored), "file");
    EXPECT_EQ(read.recordings.at(0).calibration, stored.recordings[0].calibration);
    EXPECT_EQ(read.recordings.at(1).calibration, stored.recordings[1].calibration);
  }
}

TEST(MapFile, ReadsBackKeyframesWithRoundedSightings) {
  const StoredMapScene scene;
  const StoredMap read = read_map(scene_bytes(), "file");
  ASSERT_EQ(read.map.keyframe_ids(), scene.stored().map.keyframe_ids());
  for (const KeyframeId id : read.map.keyframe_ids()) {
    const Keyframe& expected = *scene.stored().map.find_keyframe(id);
    const Keyframe& keyframe = *read.map.find_keyframe(id);
    EXPECT_EQ(keyframe.frame.time, expected.frame.time);
    EXPECT_EQ(keyframe.rig, expected.rig);
    EXPECT_EQ(keyframe.recording, expected.recording);
    EXPECT_EQ(keyframe.parent, expected.parent);
    EXPECT_EQ(keyframe.camera_from_world.rotation.coeffs(), expected.camera_from_world.rotation.coeffs());
    EXPECT_EQ(keyframe.camera_from_world.translation, expected.camera_from_world.translation);
    EXPECT_EQ(keyframe.covariance, expected.covariance);
    EXPECT_EQ(keyframe.words, expected.words);
    ASSERT_EQ(keyframe.sightings.size(), expected.sightings.size());
    for (std::size_t i = 0; i < keyframe.sightings.size(); ++i) {
      EXPECT_EQ(keyframe.sightings[i].point, expected.sightings[i].point);
      EXPECT_LE(largest_of(keyframe.sightings[i].pixel - expected.sightings[i].pixel), 1.0f / 256.0f + 1e-5f);
      EXPECT_NEAR(keyframe.sightings[i].pixel_sigma, expected.sightings[i].pixel_sigma, 0.022f);
    }
  }
}

TEST(MapFile, ReadsBackRoundedFeaturesWithExactDescriptors) {
  const StoredMapScene scene;
  const StoredMap read = read_map(scene_bytes(), "file");
  for (const KeyframeId id : read.map.keyframe_ids()) {
    const Features& expected = *scene.stored().map.find_keyframe(id)->frame.features;
    const Features& features = *read.map.find_keyframe(id)->frame.features;
    EXPECT_TRUE(std::ranges::equal(features.descriptors(), expected.descriptors()));
    for (int i = 0; i < features.size(); ++i) {
      const Keypoint& keypoint = features.keypoint(i);
      EXPECT_LE(largest_of(keypoint.pixel - expected.keypoint(i).pixel), 1.0f / 128.0f + 1e-4f);
      EXPECT_NEAR(keypoint.disparity, expected.keypoint(i).disparity, 1e-3f);
      EXPECT_NEAR(keypoint.disparity_sigma, expected.keypoint(i).disparity_sigma, 0.01f);
      EXPECT_EQ(keypoint.octave, expected.keypoint(i).octave);
      ASSERT_EQ(features.find_patch(i) == nullptr, expected.find_patch(i) == nullptr);
      if (!features.find_patch(i)) continue;
      EXPECT_LE(largest_difference(*features.find_patch(i), *expected.find_patch(i)), 255 / 30 + 1);
      EXPECT_EQ(features.find_patch(i)->centre, expected.find_patch(i)->centre);
    }
  }
}

TEST(MapFile, ReadsBackRoundedPoints) {
  const StoredMapScene scene;
  const StoredMap read = read_map(scene_bytes(), "file");
  ASSERT_EQ(read.map.point_ids(), scene.stored().map.point_ids());
  for (const PointId id : read.map.point_ids()) {
    const MapPoint& expected = *scene.stored().map.find_point(id);
    const MapPoint& point = *read.map.find_point(id);
    EXPECT_LT((point.position_in_world - expected.position_in_world).norm(), 1e-9);
    EXPECT_LT((point.covariance - expected.covariance).norm(), 1e-4 * expected.covariance.norm());
    EXPECT_LT((point.mean_viewing_direction - expected.mean_viewing_direction).norm(), 1e-4f);
    EXPECT_EQ(point.descriptor, expected.descriptor);
    EXPECT_NEAR(point.min_distance, expected.min_distance, expected.min_distance / 256.0f);
    EXPECT_NEAR(point.max_distance, expected.max_distance, expected.max_distance / 256.0f);
    EXPECT_EQ(point.reference, expected.reference);
    EXPECT_EQ(read.map.observations(id), scene.stored().map.observations(id));
  }
}

TEST(MapFile, UsesFewBytesPerObservation) {
  const StoredMapScene scene(12, 400, 1);  // each point has three observations
  const MapBytes bytes = write_map(scene.stored());
  const auto observations = static_cast<std::size_t>(12 * 399);
  EXPECT_LE(section_of(bytes, "observations").size, 9 * observations);
  EXPECT_LE(section_of(bytes, "points").size, 78 * observations / 3 + 4);
  EXPECT_LE(section_of(bytes, "patches").size, 113u * 12 * 200);  // half of the patches are noise
}

TEST(MapFile, IsUnchangedByASecondSave) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const MapBytes bytes = write_map(StoredMapScene(7, 40, seed).stored());
    EXPECT_EQ(write_map(read_map(bytes, "file")), bytes);
  }
}

TEST(MapFile, KeepsThePlanRegistration) {
  const StoredMapScene scene;
  const MapBytes bytes = write_map(scene.stored_with_plan());
  const StoredMap read = read_map(bytes, "file");
  ASSERT_TRUE(read.plan.has_value());
  EXPECT_EQ(read.plan->plan, "barn 3, ground floor");
  EXPECT_EQ(read.plan->plan_from_map.scale, 1.25);
  const Pose expected = scene.stored_with_plan().plan->plan_from_map.target_from_source;
  EXPECT_EQ(read.plan->plan_from_map.target_from_source.rotation.coeffs(), expected.rotation.coeffs());
  EXPECT_EQ(read.plan->plan_from_map.target_from_source.translation, expected.translation);
  EXPECT_EQ(read.plan->covariance, scene.stored_with_plan().plan->covariance);
  EXPECT_THAT(find_faults(read), IsEmpty());
  EXPECT_EQ(write_map(read), bytes);
}

TEST(MapFile, KeepsTheAbsenceOfAPlan) {
  EXPECT_FALSE(read_map(scene_bytes(), "file").plan.has_value());
}

TEST(MapFile, KeepsRefinedCalibrationsWithAndWithoutAPlan) {
  for (const bool has_plan : {false, true}) {
    const StoredMapScene scene;
    const StoredMap stored = with_refined_calibration(has_plan ? scene.stored_with_plan() : scene.stored());
    const MapBytes bytes = write_map(stored);
    const StoredMap read = read_map(bytes, "file");
    EXPECT_EQ(read.plan.has_value(), has_plan);
    ASSERT_TRUE(read.recordings.front().refined);
    const RefinedCalibration& refined = *read.recordings.front().refined;
    EXPECT_EQ(refined.calibration, stored.recordings.front().refined->calibration);
    EXPECT_EQ(refined.change, CalibrationVector::Constant(0.5));
    EXPECT_EQ(refined.sigma_after, CalibrationVector::Constant(0.125));
    EXPECT_EQ(refined.observations, 12345);
    EXPECT_EQ(write_map(read), bytes);
  }
}

TEST(MapFile, KeepsTheReadoutTimesOfRollingShutters) {
  for (const bool is_refined : {false, true}) {
    StoredMap stored = StoredMapScene().stored();
    stored.recordings.front().calibration.readout_time = 0.015;
    if (is_refined) {
      stored = with_refined_calibration(std::move(stored));
      stored.recordings.front().refined->calibration.readout_time = 0.021;
    }
    const MapBytes bytes = write_map(stored);
    const SourceRecording read = read_map(bytes, "file").recordings.front();
    EXPECT_EQ(read.calibration.readout_time, 0.015);
    EXPECT_EQ(read.refined.has_value(), is_refined);
    EXPECT_EQ(read.present_calibration().readout_time, is_refined ? 0.021 : 0.015);
    EXPECT_EQ(write_map(read_map(bytes, "file")), bytes);
  }
}

TEST(MapFile, RejectsARedundantReadoutTime) {
  MapBytes bytes = scene_bytes();
  put_at(bytes, section_of(bytes, "shutters").offset + 8, 0.01);
  refresh_checksums(bytes);
  EXPECT_THAT(refusal_of(bytes), HasSubstr("has a readout time other than the given calibration"));
}

TEST(MapFile, RejectsAnInvalidReadoutTime) {
  StoredMap stored = StoredMapScene().stored();
  stored.recordings.front().calibration.readout_time = 5.0;
  EXPECT_THAT(refusal_of(write_map(stored)), HasSubstr("has an invalid readout time"));
}

TEST(MapFile, RejectsAnInvalidRefinedCalibration) {
  StoredMap stored = with_refined_calibration(StoredMapScene().stored());
  stored.recordings.front().refined->calibration.left.fx = -1.0;
  EXPECT_THROW(read_map(write_map(stored), "file"), InputError);
}

TEST(MapFile, KeepsAnEmptyMap) {
  const StoredMap read = read_map(write_map({}), "file");
  EXPECT_EQ(read.map.keyframe_count(), 0);
  EXPECT_EQ(read.map.point_count(), 0);
  EXPECT_THAT(find_faults(read), IsEmpty());
}

TEST(MapFile, WritesANullFeatureSetAsAnEmptyOne) {
  const StoredMapScene scene;
  MapParts parts = scene.parts();
  parts.keyframes.back().frame.features.reset();
  StoredMap stored = scene.stored();
  stored.map = MapGraph(Origin::offline, parts);
  EXPECT_EQ(write_map(stored), scene_bytes());
}

TEST(MapFile, ReportsTheSizesOfItsSections) {
  const MapBytes bytes = scene_bytes();
  std::size_t sum = 0;
  std::vector<std::string> names;
  for (const SectionSize& section : section_sizes(bytes, "file")) {
    sum += section.bytes;
    names.push_back(section.name);
  }
  EXPECT_EQ(sum, bytes.size());
  EXPECT_THAT(names, ElementsAre("header", "summary", "notes", "provenance", "rigs", "keyframes", "features", "patches",
                                 "points", "observations", "words", "plan", "calibrations", "shutters", "descriptors",
                                 "observers", "lookup"));
}

TEST(MapFile, RejectsOtherFiles) {
  const std::string message = "barn.byre: is not a map of byre: the signature is missing (give a map file saved by ";
  EXPECT_THAT(refusal_of({}), StartsWith(message));
  EXPECT_THAT(refusal_of(MapBytes(1000)), StartsWith(message));
}

TEST(MapFile, RejectsOtherFormatsWithARemedy) {
  const auto refusal_of_format = [](std::uint32_t format) {
    MapBytes bytes = scene_bytes();
    put_at(bytes, kFormatAt, format);
    refresh_checksums(bytes);
    return refusal_of(bytes);
  };
  EXPECT_EQ(refusal_of_format(6),
            "barn.byre: header: has format 6; this program reads formats 7 and 8 "
            "(map the recordings again with byre map)");
  EXPECT_EQ(refusal_of_format(9),
            "barn.byre: header: has format 9; this program reads formats 7 and 8 "
            "(use the version of byre that wrote the map, or a newer one)");
}

TEST(MapFile, RejectsEveryTruncatedFile) {
  const MapBytes bytes = scene_bytes();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto end = bytes.begin() + static_cast<std::ptrdiff_t>(size);
    EXPECT_THROW(read_map(MapBytes(bytes.begin(), end), "file"), InputError) << size << " bytes";
  }
}

TEST(MapFile, RejectsEveryFlippedBit) {
  MapBytes bytes = scene_bytes();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::byte bit{static_cast<unsigned char>(1u << (i % 8))};
    bytes[i] ^= bit;
    EXPECT_THROW(read_map(bytes, "file"), InputError) << "byte " << i;
    bytes[i] ^= bit;
  }
}

TEST(MapFile, ReportsTheSectionWithAWrongChecksum) {
  const MapBytes sound = write_map(StoredMapScene().stored_with_plan());
  for (std::size_t i = 0; i < kSections; ++i) {
    MapBytes bytes = sound;
    const TableEntry section = table_entry(bytes, i);
    if (section.size == 0) continue;
    bytes[section.offset + section.size / 2] ^= std::byte{1};
    EXPECT_THAT(refusal_of(bytes), StartsWith("barn.byre: section " + section.name + " at byte " +
                                              std::to_string(section.offset) + ": has a wrong checksum"));
  }
}

TEST(MapFile, RejectsAnInconsistentHeader) {
  const MapBytes sound = scene_bytes();
  const auto refusal_with = [&sound](std::size_t place, auto value) {
    MapBytes bytes = sound;
    put_at(bytes, place, value);
    refresh_checksums(bytes);
    return refusal_of(bytes);
  };
  EXPECT_THAT(refusal_with(kSectionCountAt, std::uint32_t{9}),
              HasSubstr("has a wrong number of sections for its format"));
  EXPECT_THAT(refusal_with(kFileSizeAt, std::uint64_t{5}), HasSubstr("has a file size other than the actual"));
  EXPECT_THAT(refusal_with(kTableAt, 'S'), HasSubstr("does not list the section summary at the expected position"));
  EXPECT_THAT(refusal_with(kTableAt + 15, 'S'),
              HasSubstr("does not list the section summary at the expected position"));
  EXPECT_THAT(refusal_with(kTableAt + 16, std::uint64_t{0}), HasSubstr("has a wrong offset of the section summary"));
  EXPECT_THAT(refusal_with(kTableAt + 24, ~std::uint64_t{0}), HasSubstr("has a wrong offset of the section summary"));
  MapBytes bytes = sound;
  bytes[kHeaderChecksumAt] ^= std::byte{1};
  EXPECT_THAT(refusal_of(bytes), HasSubstr("header at byte 672: has a wrong checksum"));
}

TEST(MapFile, RejectsBytesOutsideOfAllSections) {
  MapBytes bytes = scene_bytes();
  bytes.push_back({});
  put_at(bytes, kFileSizeAt, std::uint64_t{bytes.size()});
  refresh_checksums(bytes);
  EXPECT_THAT(refusal_of(bytes), HasSubstr("leaves bytes outside of all sections"));
}

class MapFileOnDisk : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("map_file_" + std::to_string(getpid()));
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
};

TEST_F(MapFileOnDisk, ContainsTheMap) {
  const StoredMapScene scene;
  save_map(scene.stored(), folder_ / "barn.byre");
  EXPECT_EQ(read_file(folder_ / "barn.byre"), scene_bytes());
  EXPECT_EQ(write_map(load_map(folder_ / "barn.byre")), scene_bytes());
}

TEST_F(MapFileOnDisk, ReadsBackTheWrittenMap) {
  StoredMap stored = StoredMapScene().stored();
  save_and_reread(stored, folder_ / "barn.byre");
  EXPECT_EQ(read_file(folder_ / "barn.byre"), scene_bytes());
  EXPECT_EQ(write_map(stored), scene_bytes());
  EXPECT_THROW(save_and_reread(stored, folder_ / "no_folder" / "barn.byre"), InputError);
  EXPECT_EQ(write_map(stored), scene_bytes()) << "a map that could not be written is lost";
}

TEST_F(MapFileOnDisk, ReportsAPlanWithoutReadingTheMap) {
  save_map(StoredMapScene().stored(), folder_ / "barn.byre");
  EXPECT_FALSE(load_plan_registration(folder_ / "barn.byre").has_value());
  save_map(StoredMapScene().stored_with_plan(), folder_ / "barn.byre");
  EXPECT_EQ(load_plan_registration(folder_ / "barn.byre").value().plan, "barn 3, ground floor");
}

TEST_F(MapFileOnDisk, IsNotReplacedByAnInvalidMap) {
  const StoredMapScene scene;
  save_map(scene.stored(), folder_ / "barn.byre");
  StoredMap unsound = scene.stored();
  unsound.recordings.clear();
  try {
    save_map(unsound, folder_ / "barn.byre");
    FAIL() << "an invalid map was saved";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is not written: the map is invalid: refers to recording 0 of 0"));
  }
  EXPECT_EQ(read_file(folder_ / "barn.byre"), scene_bytes());
}

}  // namespace
}  // namespace byre
