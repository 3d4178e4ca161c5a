#include "byre/playback/archive/register_map.h"

#include "byre/input_error.h"
#include "byre/map/mapped_tag.h"
#include "byre/map/scaled_copy.h"
#include "byre/playback/archive/register_scene.h"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::SizeIs;
using testing::ThrowsMessage;

class RegisterMap : public testing::Test {
 protected:
  ~RegisterMap() override { std::filesystem::remove(picks_); }

  Registering register_with(const StoredMap& stored, const std::vector<PlanCorrespondence>& correspondences) const {
    std::ofstream(picks_) << picks_csv(correspondences);
    return register_map(stored, "barn.byre", plan_, picks_, {});
  }

  ScaleCorrectedMap correct_with(const StoredMap& stored, const std::string& picks) const {
    std::ofstream(picks_) << picks;
    return correct_scale(stored, "barn.byre", plan_, picks_, {});
  }

  ScaleCorrectedMap correct(const StoredMap& stored, const std::vector<PlanCorrespondence>& correspondences) const {
    return correct_with(stored, picks_csv(correspondences));
  }

  FloorPlan plan_{"plan.yaml", "plan.png", 420, 140, Eigen::Matrix2d::Identity(), Eigen::Vector2d::Zero()};
  std::filesystem::path picks_ =
      std::filesystem::path(testing::TempDir()) / ("register_" + std::to_string(getpid()) + ".csv");
};

TEST_F(RegisterMap, HasSmallerSigmasWithSmallerResiduals) {
  FloorPlanScene scene;
  const StoredMap stored = driven_barn(scene);
  const Registering exact = register_with(stored, scene.correspondences(12));
  const Registering noisy = register_with(stored, scene.correspondences(12, 0.2));
  EXPECT_THAT(exact.correspondences, SizeIs(12));
  EXPECT_LT(exact.largest_path_sigma, 0.02);
  EXPECT_GT(noisy.largest_path_sigma, 3.0 * exact.largest_path_sigma);
}

TEST_F(RegisterMap, EstimatesTheScaleOnlyOfUnscaledMaps) {
  FloorPlanScene scene(1, 2.0);
  StoredMap stored = driven_barn(scene);
  stored.scale = MapScale::unknown;
  const Registering registering = register_with(stored, scene.correspondences(6));
  EXPECT_NEAR(registering.fit.registration.plan_from_map.scale, 2.0, 1e-6);
  EXPECT_FALSE(registering.measured_scale.has_value());
}

TEST_F(RegisterMap, RegistersAMetricMapWithoutScaling) {
  FloorPlanScene scene(1, 1.0 / 1.016);
  const Registering registering = register_with(driven_barn(scene), scene.correspondences(8, 0.03));
  EXPECT_EQ(registering.fit.registration.plan_from_map.scale, 1.0);
  ASSERT_TRUE(registering.measured_scale.has_value());
  EXPECT_TRUE(registering.has_baseline);
}

TEST_F(RegisterMap, RegistersByTheSurveyedTagsOfTheMap) {
  FloorPlanScene scene;
  StoredMap stored = driven_barn(scene);
  RegisterOptions options;
  int number = 0;
  for (const PlanCorrespondence& pick : scene.correspondences(6)) {
    const MappedTag tag{
        {TagFamily::tag36h11, number++}, 0.2, {Eigen::Quaterniond::Identity(), pick.point_in_map}, 0.02};
    write_tags(std::span(&tag, 1), stored.notes);
    options.tags.push_back({tag.id, 0.2, SurveyedTag{{pick.point_in_plan.x(), pick.point_in_plan.y(), 1.0}}});
  }
  const Registering registering = register_map(stored, "barn.byre", plan_, {}, options);
  EXPECT_THAT(registering.correspondences, SizeIs(6));
  EXPECT_LT(registering.fit.rms, 0.01);
  options.tags.resize(1);
  EXPECT_THAT([&] { register_map(stored, "barn.byre", plan_, {}, options); },
              ThrowsMessage<InputError>(HasSubstr("too few of the surveyed tags")));
}

TEST_F(RegisterMap, CorrectsTheScaleAndRegistersTheCorrectedMap) {
  FloorPlanScene scene(1, 1.0 / 1.016);
  const auto correspondences = scene.correspondences(8, 0.03);
  const ScaleCorrectedMap corrected = correct(driven_barn(scene), correspondences);
  EXPECT_NEAR(corrected.factor * 1.016, 1.0, 3.0 * corrected.registering.measured_scale->sigma);
  EXPECT_EQ(corrected.registering.fit.registration.plan_from_map.scale, 1.0);
  EXPECT_LT(corrected.registering.fit.rms, 0.05);
  EXPECT_DOUBLE_EQ(corrected.stored.map.rigs()[0].baseline, corrected.factor * 0.11);
  EXPECT_DOUBLE_EQ(baseline_factor(corrected.stored, 0), corrected.factor);
}

// Picks by keyframe remain valid after a correction of the scale; picks by position do not.
TEST_F(RegisterMap, CorrectsNothingTheSecondTime) {
  FloorPlanScene scene(1, 1.0 / 1.016);
  const StoredMap stored = driven_barn(scene);
  const std::string picks = keyframe_picks_csv(scene, stored);
  const ScaleCorrectedMap once = correct_with(stored, picks);
  EXPECT_NEAR(once.factor * 1.016, 1.0, 0.001);
  const ScaleCorrectedMap twice = correct_with(once.stored, picks);
  EXPECT_EQ(twice.factor, 1.0);
  EXPECT_LT(std::abs(twice.registering.measured_scale->excess()), 0.001);
  EXPECT_EQ(twice.stored.map.rigs()[0].baseline, once.stored.map.rigs()[0].baseline);
  const std::string positions = picks_csv(scene.correspondences(8, 0.03));
  EXPECT_THAT([&] { correct_with(once.stored, positions); },
              ThrowsMessage<InputError>(HasSubstr("gives positions, but the map has been scaled by 0.98")));
}

TEST_F(RegisterMap, RejectsCorrectionWithoutABaseline) {
  FloorPlanScene scene(1, 1.0 / 1.016);
  const auto correspondences = scene.correspondences(8);
  const auto refusal_of = [&](const StoredMap& stored, const std::string& reason) {
    EXPECT_THAT([&] { correct(stored, correspondences); }, ThrowsMessage<InputError>(HasSubstr(reason)));
  };
  StoredMap stored = driven_barn(scene);
  stored.scale = MapScale::unknown;
  refusal_of(stored, "omit --fix-scale, and the scale is estimated; or set it with byre scale");
  stored = driven_barn(scene);
  stored.pose_source = PoseSource::given;
  refusal_of(stored, "has the scale of given poses");
  MapParts one_camera{stored.map.rigs(), {}, {}};
  one_camera.rigs[0].baseline = 0.0;
  for (const KeyframeId id : stored.map.keyframe_ids()) one_camera.keyframes.push_back(*stored.map.find_keyframe(id));
  stored = driven_barn(scene);
  stored.map = MapGraph(Origin::offline, one_camera);
  refusal_of(stored, "has no baseline to correct (use byre scale with a known distance)");
}

TEST_F(RegisterMap, RejectsCorrectionWithInsufficientPicks) {
  FloorPlanScene scene(1, 1.0 / 1.016);
  const StoredMap stored = driven_barn(scene);
  EXPECT_THAT([&] { correct(stored, scene.correspondences(3)); },
              ThrowsMessage<InputError>(HasSubstr("does not determine the scale: fewer than four")));
  EXPECT_THAT([&] { correct(stored, scene.correspondences(8, 2.0)); },
              ThrowsMessage<InputError>(HasSubstr("the correspondences are inconsistent")));
}

TEST_F(RegisterMap, RejectsAMapWithoutVertical) {
  EXPECT_THROW(register_with(StoredMap(), FloorPlanScene().correspondences(6)), InputError);
}

}  // namespace
}  // namespace byre
