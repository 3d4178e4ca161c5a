// Each invariant of a stored map violated once, and each way to make a section invalid: detected and rejected.

#include "byre/input_error.h"
#include "byre/map/map_bytes_scene.h"
#include "byre/map/map_file.h"
#include "byre/map/stored_map_scene.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct BrokenInvariant {
  const char* name;
  const char* section;  // section of the file that is rejected
  const char* fault;
  std::function<void(StoredMap&, MapParts&)> break_it;
};

std::ostream& operator<<(std::ostream& out, const BrokenInvariant& broken) {
  return out << broken.name;
}

StoredMap broken_map(const BrokenInvariant& broken) {
  const StoredMapScene scene;
  StoredMap stored = scene.stored();
  MapParts parts = scene.parts();
  broken.break_it(stored, parts);
  stored.map = MapGraph(Origin::offline, parts);
  return stored;
}

// Changes the keypoints of a keyframe of the first rig, without patches.
void with_keypoints(Keyframe& keyframe, const std::function<void(std::vector<Keypoint>&)>& change) {
  std::vector<Keypoint> keypoints = to_vector(keyframe.frame.features->keypoints());
  change(keypoints);
  keyframe.frame.features = std::make_shared<const Features>(
      320, 240, keypoints, to_vector(keyframe.frame.features->descriptors()), std::vector<Patch>{});
}

auto with_keypoint(const std::function<void(Keypoint&)>& change) {
  return [change](StoredMap&, MapParts& parts) {
    with_keypoints(parts.keyframes[0], [&](std::vector<Keypoint>& keypoints) { change(keypoints[0]); });
  };
}

auto with_recording(const std::function<void(SourceRecording&)>& change) {
  return [change](StoredMap& stored, MapParts&) { change(stored.recordings[0]); };
}
auto with_camera(const std::function<void(Camera&)>& change) {
  return with_recording([change](SourceRecording& recording) { change(recording.calibration.left); });
}
auto with_rig(const std::function<void(Rig&)>& change) {
  return [change](StoredMap&, MapParts& parts) { change(parts.rigs[0]); };
}
auto with_keyframe(const std::function<void(Keyframe&)>& change) {
  return [change](StoredMap&, MapParts& parts) { change(parts.keyframes[2]); };
}
auto with_point(const std::function<void(MapPoint&)>& change) {
  return [change](StoredMap&, MapParts& parts) { change(parts.points[3]); };
}

std::shared_ptr<const Features> with_patch_at(const Features& features, const Eigen::Vector2f& centre) {
  std::vector<Patch> patches(features.keypoints().size());
  for (Patch& patch : patches) patch.centre = centre;
  return std::make_shared<const Features>(320, 240, to_vector(features.keypoints()), to_vector(features.descriptors()),
                                          patches);
}

const std::vector<BrokenInvariant>& broken_invariants() {
  static const std::vector<BrokenInvariant> all = {
      {"CameraSize", "provenance", "recording 0 has an invalid image size",
       with_camera([](Camera& c) { c.width = 0; })},
      {"HugeCamera", "provenance", "an invalid image size", with_camera([](Camera& c) { c.height = 16385; })},
      {"CameraFocal", "provenance", "recording 0 has an invalid camera", with_camera([](Camera& c) { c.fx = 0.0; })},
      {"CameraFocalNan", "provenance", "an invalid camera", with_camera([](Camera& c) { c.fy = kNan; })},
      {"CameraCentre", "provenance", "an invalid camera", with_camera([](Camera& c) { c.cx = kInfinity; })},
      {"Distortion", "provenance", "an invalid camera", with_camera([](Camera& c) { c.distortion[4] = kNan; })},
      {"RightCamera", "provenance", "an invalid camera",
       with_recording([](SourceRecording& r) { r.calibration.right->camera.fx = -1.0; })},
      {"RightPose", "provenance", "recording 0 has an invalid pose",
       with_recording([](SourceRecording& r) { r.calibration.right->right_from_left.translation.x() = kNan; })},
      {"BodyPose", "provenance", "recording 0 has an invalid pose",
       with_recording([](SourceRecording& r) { r.calibration.body_from_left.rotation.coeffs().setZero(); })},
      {"Times", "provenance", "recording 0 ends before it begins",
       with_recording([](SourceRecording& r) { r.first_time = r.last_time + Timestamp(1); })},
      {"RigSize", "rigs", "rig 0 has an invalid image size", with_rig([](Rig& rig) { rig.height = -1; })},
      {"RigFocal", "rigs", "rig 0 has an invalid camera", with_rig([](Rig& rig) { rig.focal = 0.0; })},
      {"RigCentre", "rigs", "rig 0 has an invalid camera", with_rig([](Rig& rig) { rig.cy = kNan; })},
      {"RigBaseline", "rigs", "rig 0 has an invalid camera", with_rig([](Rig& rig) { rig.baseline = -0.1; })},
      {"RigPose", "rigs", "rig 0 has an invalid pose",
       with_rig([](Rig& rig) { rig.body_from_camera.rotation.coeffs() *= 1.1; })},
      {"NoRecording", "keyframes", "keyframe 2 belongs to a recording that is not listed",
       with_keyframe([](Keyframe& k) { k.recording = 2; })},
      {"KeyframePose", "keyframes", "keyframe offline 2 has an invalid pose",
       with_keyframe([](Keyframe& k) { k.camera_from_world.translation.y() = kInfinity; })},
      {"KeyframeRotation", "keyframes", "keyframe offline 2 has an invalid pose",
       with_keyframe([](Keyframe& k) { k.camera_from_world.rotation.w() += 0.01; })},
      {"KeyframeCovariance", "keyframes", "keyframe 2 has a covariance that is not finite",
       with_keyframe([](Keyframe& k) { k.covariance(1, 2) = k.covariance(2, 1) = kNan; })},
      {"OwnParent", "keyframes", "keyframe offline 2 has a removed or younger parent",
       with_keyframe([](Keyframe& k) { k.parent->number = 2; })},
      {"YoungerParent", "keyframes", "keyframe offline 2 has a removed or younger parent",
       with_keyframe([](Keyframe& k) { k.parent->number = 4; })},
      {"KeypointOutside", "features", "keyframe 0 has a keypoint outside its image",
       with_keypoint([](Keypoint& k) { k.pixel.x() = 320.0f; })},
      {"KeypointOctave", "features", "keyframe 0 has a keypoint in an octave that does not exist",
       with_keypoint([](Keypoint& k) { k.octave = kOctaves; })},
      {"KeypointDisparity", "features", "keypoint with invalid values",
       with_keypoint([](Keypoint& k) { k.disparity = std::numeric_limits<float>::infinity(); })},
      {"KeypointDisparitySigma", "features", "keypoint with invalid values", with_keypoint([](Keypoint& k) {
         k.disparity = 3.0f;
         k.disparity_sigma = 0.0f;
       })},
      {"PatchCentre", "patches", "keyframe 0 has a patch without its centre",
       [](StoredMap&, MapParts& parts) {
         parts.keyframes[0].frame.features = with_patch_at(*parts.keyframes[0].frame.features, {8.0f, 15.5f});
       }},
      {"PatchCentreNan", "patches", "keyframe 0 has a patch without its centre",
       [](StoredMap&, MapParts& parts) {
         parts.keyframes[0].frame.features = with_patch_at(*parts.keyframes[0].frame.features, {kNan, 8.0f});
       }},
      {"PointPosition", "points", "has a position that is not finite",
       with_point([](MapPoint& p) { p.position_in_world.z() = kNan; })},
      {"PointCovariance", "points", "point 3 has a covariance that is not finite",
       with_point([](MapPoint& p) { p.covariance(0, 0) = kInfinity; })},
      {"PointDirection", "points", "a viewing direction that is not of unit length",
       with_point([](MapPoint& p) { p.mean_viewing_direction *= 1.1f; })},
      {"PointDistance", "points", "an invalid distance range",
       with_point([](MapPoint& p) { p.min_distance = p.max_distance * 1.1f; })},
      {"PointDistanceInfinite", "points", "an invalid distance range",
       with_point([](MapPoint& p) { p.max_distance = std::numeric_limits<float>::infinity(); })},
      {"PointReference", "observations", "has a reference keyframe that does not observe it",
       with_point([](MapPoint& p) { ++p.reference.feature; })},
      {"PointReferenceKeyframe", "observations", "has a reference keyframe that does not observe it",
       with_point([](MapPoint& p) { p.reference.keyframe.number = 1000; })},
      {"PointUnseen", "observations", "is not observed by any keyframe",
       [](StoredMap&, MapParts& parts) { parts.points.push_back(parts.points.back()); }},
      {"SightingPixel", "observations", "keyframe 2 has a sighting with invalid values",
       with_keyframe([](Keyframe& k) { k.sightings[1].pixel.x() = kNan; })},
      {"SightingSigma", "observations", "keyframe 2 has a sighting with invalid values",
       with_keyframe([](Keyframe& k) { k.sightings[1].pixel_sigma = 0.0f; })},
      {"WordsOfNoVocabulary", "words", "has words without a vocabulary",
       [](StoredMap& stored, MapParts&) { stored.vocabulary_checksum = 0; }},
      {"TooFewWords", "words", "keyframe 2 does not have one word per feature",
       with_keyframe([](Keyframe& k) { k.words.pop_back(); })},
  };
  return all;
}

class BrokenMap : public testing::TestWithParam<BrokenInvariant> {};

TEST_P(BrokenMap, IsReportedByFindFaults) {
  EXPECT_THAT(find_faults(broken_map(GetParam())), Contains(HasSubstr(GetParam().fault)));
}

TEST_P(BrokenMap, IsRejectedWithItsSection) {
  EXPECT_THAT(refusal_of(write_map(broken_map(GetParam()))),
              StartsWith("barn.byre: section " + std::string(GetParam().section) + " at byte "));
}

INSTANTIATE_TEST_SUITE_P(Invariants, BrokenMap, testing::ValuesIn(broken_invariants()),
                         [](const auto& test) { return test.param.name; });

TEST(StoredMapFaults, ReportInvariantsThatAFileCannotViolate) {
  const StoredMapScene scene;
  StoredMap stored = scene.stored();
  MapParts parts = scene.parts();
  parts.keyframes[2].covariance(0, 1) = 1.0;
  parts.points[3].covariance(0, 1) = 1.0;
  stored.map = MapGraph(Origin::offline, parts);
  EXPECT_THAT(find_faults(stored), AllOf(Contains("keyframe 2 has an asymmetric covariance"),
                                         Contains("point 3 has an asymmetric covariance")));
  stored.map = MapGraph(Origin::online);
  EXPECT_THAT(find_faults(stored), Contains("the map is not offline"));
  stored = scene.stored();
  stored.map.remove_point({Origin::offline, 0});
  stored.map.remove_keyframe({Origin::offline, 1});
  EXPECT_THAT(find_faults(stored),
              AllOf(Contains("the numbers of keyframes have gaps"), Contains("the numbers of points have gaps")));
}

// An invalid value in the bytes of a section, which no map is written as.
struct BrokenValue {
  const char* name;
  const char* section;
  const char* refusal;
  std::size_t place;  // byte offset in the section
  MapBytes value;
};

std::ostream& operator<<(std::ostream& out, const BrokenValue& broken) {
  return out << broken.name;
}

template <typename T>
MapBytes bytes_of(T value) {
  MapBytes bytes(sizeof(T));
  put_at(bytes, 0, value);
  return bytes;
}

constexpr std::uint32_t kHuge = 0xfffffff0;

// Offsets follow docs/reference/map_format.md; the scene's keyframes have 9 features each, 8 of them with a point.
const std::vector<BrokenValue>& broken_values() {
  static const std::vector<BrokenValue> all = {
      {"Summary", "summary", "does not match the other sections", 8, bytes_of(std::uint64_t{1})},
      {"NoteCount", "notes", "declares 4294967280 entries", 0, bytes_of(kHuge)},
      {"NoteLength", "notes", "declares 4294967280 entries", 4, bytes_of(kHuge)},
      {"NoteOrder", "notes", "has unsorted notes", 8, bytes_of('z')},
      {"Scale", "provenance", "has the invalid value 2", 0, bytes_of(std::uint8_t{2})},
      {"PoseSource", "provenance", "has the invalid value 3", 1, bytes_of(std::uint8_t{3})},
      {"RecordingCount", "provenance", "declares 4294967280 entries", 2, bytes_of(kHuge)},
      {"CameraModel", "provenance", "has the invalid value 9", 22, bytes_of(std::uint8_t{9})},
      {"HasRight", "provenance", "has the invalid value 2", 22 + 81, bytes_of(std::uint8_t{2})},
      {"RigCount", "rigs", "declares 4294967280 entries", 0, bytes_of(kHuge)},
      {"FewerRigs", "rigs", "bytes are left over", 0, bytes_of(std::uint32_t{1})},
      {"KeyframeCount", "keyframes", "declares 4294967280 entries", 0, bytes_of(kHuge)},
      {"NoRig", "keyframes", "refers to rig 2 of 2", 4 + 8, bytes_of(std::uint32_t{2})},
      {"FewerKeyframes", "keyframes", "bytes are left over", 0, bytes_of(std::uint32_t{5})},
      {"FeatureCount", "features", "declares 4294967280 entries", 0, bytes_of(kHuge)},
      {"KeypointKind", "features", "has a keypoint of an unknown kind", 4, bytes_of(std::uint8_t{0x80})},
      {"KeypointPlace", "features", "has a keypoint outside its image", 5, bytes_of(std::uint16_t{320 * 64})},
      {"PatchGrey", "patches", "keyframe 0 has an invalid patch", 0, bytes_of(std::uint16_t{0x00ff})},
      {"PatchPlace", "patches", "keyframe 0 has a patch without its centre", 2, bytes_of(std::uint16_t{0xffff})},
      {"PointCount", "points", "declares 4294967280 entries", 0, bytes_of(kHuge)},
      {"FewerPoints", "points", "bytes are left over", 0, bytes_of(std::uint32_t{1})},
      {"PointCovariance", "points", "point 0 has an invalid covariance", 4 + 18, bytes_of(std::int16_t{-1})},
      {"ObservationPoint", "observations", "refers to point 255 of 16", 0, bytes_of(std::uint8_t{255})},
      {"ObservationTwice", "observations", "point 0 is observed twice by a keyframe", 4, bytes_of(std::uint8_t{0})},
      {"ObservationSigma", "observations", "keyframe 0 has a sighting with invalid values", 3,
       bytes_of(std::uint8_t{0})},
      {"WordBytes", "words", "has words of 5 bytes", 8, bytes_of(std::uint8_t{5})},
      {"HasWords", "words", "has the invalid value 2", 9, bytes_of(std::uint8_t{2})},
  };
  return all;
}

class BrokenSection : public testing::TestWithParam<BrokenValue> {};

TEST_P(BrokenSection, IsRejected) {
  const auto& [name, section, refusal, place, value] = GetParam();
  MapBytes bytes = write_map(StoredMapScene().stored());
  std::ranges::copy(value, bytes.begin() + static_cast<std::ptrdiff_t>(section_of(bytes, section).offset + place));
  refresh_checksums(bytes);
  EXPECT_THAT(refusal_of(bytes),
              AllOf(StartsWith("barn.byre: section " + std::string(section) + " at byte "), HasSubstr(refusal)));
}

INSTANTIATE_TEST_SUITE_P(Values, BrokenSection, testing::ValuesIn(broken_values()),
                         [](const auto& test) { return test.param.name; });

TEST(BrokenSections, AreRejectedIfKeypointsAreNotInGridOrder) {
  MapBytes bytes = write_map(StoredMapScene().stored());
  const std::size_t first = section_of(bytes, "features").offset + 4;
  put_at(bytes, first + 1, std::uint16_t{319 * 64});  // moves the first keypoint to the opposite corner
  put_at(bytes, first + 3, std::uint16_t{239 * 64});
  refresh_checksums(bytes);
  EXPECT_THAT(refusal_of(bytes), HasSubstr("keyframe 0 has keypoints that are not sorted by grid cell"));
}

TEST(BrokenSections, AreRejectedIfAKeyframeWithoutFeaturesHasWords) {
  MapBytes bytes = write_map(StoredMapScene().stored());
  const TableEntry words = section_of(bytes, "words");
  bytes[words.offset + words.size - 1] = std::byte{1};
  refresh_checksums(bytes);
  EXPECT_THAT(refusal_of(bytes), HasSubstr("has words for a keyframe without features"));
}

TEST(BrokenSections, AreRejectedIfTooShortOrTooLong) {
  const MapBytes sound = write_map(StoredMapScene().stored_with_plan());
  for (std::size_t i = 0; i < kSections; ++i) {
    const TableEntry section = table_entry(sound, i);
    if (section.size == 0) continue;
    MapBytes shorter = sound;
    replace_in_section(shorter, i, section.size - 1, 1, {});
    refresh_checksums(shorter);
    EXPECT_THAT(refusal_of(shorter), HasSubstr("section " + section.name + " at byte "));
    MapBytes longer = sound;
    replace_in_section(longer, i, section.size, 0, MapBytes(1));
    refresh_checksums(longer);
    EXPECT_THAT(refusal_of(longer), AllOf(HasSubstr("section " + section.name), HasSubstr("1 bytes are left over")));
  }
}

struct PlanDefect {
  const char* name;
  const char* fault;
  void (*breaks)(PlanRegistration& plan);
};

class DefectivePlan : public testing::TestWithParam<PlanDefect> {};

TEST_P(DefectivePlan, IsReportedAndRejected) {
  StoredMap stored = StoredMapScene().stored_with_plan();
  GetParam().breaks(*stored.plan);
  const std::string fault = std::string("the plan ") + GetParam().fault;
  EXPECT_THAT(find_faults(stored), Contains(fault));
  EXPECT_THAT(refusal_of(write_map(stored)), AllOf(StartsWith("barn.byre: section plan at byte "), HasSubstr(fault)));
}

INSTANTIATE_TEST_SUITE_P(Values, DefectivePlan,
                         testing::Values(PlanDefect{"Scale", "has a scale that is not positive",
                                                    [](auto& plan) { plan.plan_from_map.scale = 0.0; }},
                                         PlanDefect{"Pose", "has an invalid pose",
                                                    [](auto& plan) {
                                                      plan.plan_from_map.target_from_source.rotation.coeffs() *= 2.0;
                                                    }},
                                         PlanDefect{"Covariance", "has a covariance that is not finite",
                                                    [](auto& plan) { plan.covariance.setConstant(kNan); }},
                                         PlanDefect{"Variance", "has a negative variance",
                                                    [](auto& plan) { plan.covariance(2, 2) = -1.0; }}),
                         [](const auto& test) { return test.param.name; });

TEST(DefectivePlans, AreReportedForAnAsymmetricCovariance) {
  StoredMap stored = StoredMapScene().stored_with_plan();
  stored.plan->covariance(0, 6) += 1e-3;
  EXPECT_THAT(find_faults(stored), ElementsAre("the plan has an asymmetric covariance"));
}

// Every keyframe observes the same point with its only feature: a small file, but a large map.
StoredMap crowd(std::uint32_t keyframes) {
  const StoredMapScene scene;
  StoredMap stored = scene.stored();
  MapParts parts{scene.parts().rigs, {}, {scene.parts().points[0]}};
  Keyframe keyframe;
  keyframe.frame.features = std::make_shared<const Features>(320, 240, std::vector<Keypoint>(1, {{1.0f, 1.0f}}),
                                                             std::vector<Descriptor>(1), std::vector<Patch>{});
  keyframe.sightings.push_back({PointId{Origin::offline, 0}, {1.0f, 1.0f}});
  parts.keyframes.assign(keyframes, keyframe);
  parts.points[0].reference = {{Origin::offline, 0}, 0};
  stored.map = MapGraph(Origin::offline, parts);
  return stored;
}

TEST(BrokenSections, AreRejectedIfCovisibleKeyframesExceedTheFile) {
  EXPECT_EQ(refusal_of(write_map(crowd(700))), "");
  EXPECT_THAT(refusal_of(write_map(crowd(1000))), HasSubstr("has more covisible keyframes than a file of this"));
}

}  // namespace
}  // namespace byre
