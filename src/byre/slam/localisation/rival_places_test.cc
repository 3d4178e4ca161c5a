#include "byre/slam/localisation/rival_places.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/places/place_view_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using View = RivalPlaces::View;

Pose camera_at(double x) {
  return {Eigen::Quaterniond::Identity(), {-x, 0.0, 0.0}};
}

// A place that is neither accepted nor rejected.
PlaceHypothesis open_place(const PlaceView& view = view_of_room(4, 6)) {
  PlaceHypothesis place(0.0, 3);
  place.observe(view, true);
  return place;
}

// A camera at the robot's place, with a rival 5 m to the side.
class RivalPlaceTest : public ::testing::Test {
 protected:
  RivalPlaceTest() { rivals_.propose(camera_at(0.0), camera_at(5.0), 0.0); }

  // Observes a frame at x with the same view at every rival.
  void observe(double x, const PlaceView& view, bool is_tracked = true) {
    rivals_.observe(camera_at(x), [&](const Pose& predicted) { return View{predicted, view, is_tracked}; });
  }
  void observe_along(double from, double to, const PlaceView& view) {
    for (double x = from; x <= to; x += 0.25) observe(x, view);
  }

  const PlaceView shown_ = view_of_room(10, 0);
  const PlaceView not_shown_ = view_of_room(0, 10);
  RivalPlaces rivals_{RegistrationOptions{}};
};

TEST_F(RivalPlaceTest, HasTheLogOddsOfItsViews) {
  observe(0.0, shown_);
  EXPECT_NEAR(rivals_.log_odds(), open_place(shown_).log_odds(), 1e-9);
}

TEST_F(RivalPlaceTest, IsTestedAtThePredictedPose) {
  Pose tested_at;
  observe(0.0, shown_);
  rivals_.observe(camera_at(1.0), [&](const Pose& predicted) {
    tested_at = predicted;
    return View{predicted, shown_, true};
  });
  EXPECT_NEAR(inverse(tested_at).translation.x(), 6.0, 1e-12);
}

TEST_F(RivalPlaceTest, IsDroppedIfItShowsNothingOfTheMap) {
  observe(0.0, shown_);
  for (int i = 0; i < 20; ++i) observe(0.1 * i, not_shown_);
  EXPECT_EQ(rivals_.log_odds(), kNoRivals);
}

TEST_F(RivalPlaceTest, IsDroppedIfTheFirstFrameIsNotTracked) {
  observe(0.0, not_shown_, false);
  EXPECT_EQ(rivals_.log_odds(), kNoRivals);
}

TEST_F(RivalPlaceTest, IsKeptWithoutKeyframesNearby) {
  observe(0.0, shown_);
  const double before = rivals_.log_odds();
  PlaceView from_afar = not_shown_;
  from_afar.is_near_keyframe = false;
  for (int i = 0; i < 20; ++i) observe(0.0, from_afar, false);
  EXPECT_EQ(rivals_.log_odds(), before);
}

TEST_F(RivalPlaceTest, IsAddedOncePerPlace) {
  rivals_.propose(camera_at(0.0), camera_at(5.2), 0.0);
  rivals_.propose(camera_at(0.0), camera_at(0.2), 0.0);
  observe(0.0, shown_);
  EXPECT_NEAR(rivals_.log_odds(), open_place(shown_).log_odds(), 1e-9);
}

TEST_F(RivalPlaceTest, RefutesAnUnacceptedPlaceAfterThreeFrames) {
  observe(0.0, shown_);
  observe(0.0, shown_);
  EXPECT_FALSE(rivals_.refute(open_place(), false));
  observe(0.0, shown_);
  EXPECT_TRUE(rivals_.refute(open_place(), false));
  EXPECT_FALSE(rivals_.refute(open_place(view_of_room(20, 0)), false));
}

TEST_F(RivalPlaceTest, RefutesAnAcceptedPlaceOnlyAlongAPath) {
  const PlaceHypothesis accepted;
  for (int i = 0; i < 50; ++i) observe(0.01 * i, shown_);
  EXPECT_FALSE(rivals_.refute(accepted, false)) << "from one spot";
  observe_along(0.5, 2.0, shown_);
  EXPECT_TRUE(rivals_.refute(accepted, false));
}

TEST_F(RivalPlaceTest, RefutesNoAcceptedPlaceIfEarlierFramesOutweighIt) {
  observe_along(0.0, 3.0, shown_);
  const PlaceHypothesis accepted;
  int calls = 0;
  const auto of_path = [&](const Pose& rival_from_place) {
    ++calls;
    EXPECT_THAT(rival_from_place, PoseNear(inverse(camera_at(5.0)) * camera_at(0.0), 1e-9, 1e-9));
    return -100.0;
  };
  EXPECT_FALSE(rivals_.refute(accepted, false, of_path));
  EXPECT_FALSE(rivals_.refute(accepted, false, of_path));
  EXPECT_EQ(calls, 1);
}

TEST_F(RivalPlaceTest, IsTestedOnThePathOfEachPlace) {
  int calls = 0;
  const auto of_path = [&](const Pose&) { return ++calls, -100.0; };
  observe_along(0.0, 3.0, shown_);
  EXPECT_FALSE(rivals_.refute({}, false, of_path));
  rivals_.note_place(Timestamp{0}, camera_at(3.0), {});
  rivals_.begin(from_seconds(0.1), camera_at(20.0));
  observe_along(20.0, 23.0, shown_);
  EXPECT_FALSE(rivals_.refute({}, false, of_path));
  EXPECT_EQ(calls, 2);
}

TEST_F(RivalPlaceTest, RefutesAPlaceFoundByAHintOnlyAlongAPath) {
  for (int i = 0; i < 50; ++i) observe(0.01 * i, shown_);
  EXPECT_FALSE(rivals_.refute(open_place(not_shown_), true)) << "from one spot";
  observe_along(0.5, 2.0, shown_);
  EXPECT_TRUE(rivals_.refute(open_place(not_shown_), true));
}

TEST_F(RivalPlaceTest, KeepsTheThresholdWhenAdopted) {
  RegistrationOptions strict;
  strict.accept_log_odds = 100.0;
  RivalPlaces rivals(strict);
  rivals.propose(camera_at(0.0), camera_at(5.0), 0.0);
  rivals.observe(camera_at(0.0), [&](const Pose& predicted) { return View{predicted, shown_, true}; });
  rivals.note_place(Timestamp{0}, camera_at(0.0), open_place());
  std::optional<PlaceHypothesis> place = rivals.begin(from_seconds(0.1), camera_at(5.0));
  ASSERT_TRUE(place);
  for (int i = 0; i < 10; ++i) place->observe(shown_, true);
  EXPECT_FALSE(place->is_accepted());
}

TEST_F(RivalPlaceTest, RefutesNoPlaceIfItHasChangedAsWell) {
  observe_along(0.0, 3.0, view_of_room(2, 4));
  EXPECT_FALSE(rivals_.refute(open_place(not_shown_), false));
}

TEST_F(RivalPlaceTest, IsRecognisedAtALaterFrame) {
  observe(0.0, shown_);
  rivals_.note_place(Timestamp{0}, camera_at(0.0), open_place());
  const Timestamp next = from_seconds(0.1);
  ASSERT_NE(rivals_.find_test(next, camera_at(5.1)), nullptr);
  EXPECT_EQ(rivals_.find_test(next, camera_at(5.1))->log_odds(), open_place(shown_).log_odds());
  ASSERT_NE(rivals_.find_test(next, camera_at(0.1)), nullptr);
  EXPECT_EQ(rivals_.find_test(next, camera_at(0.1))->log_odds(), open_place().log_odds());
  EXPECT_EQ(rivals_.find_test(next, camera_at(-5.0)), nullptr);
  EXPECT_EQ(rivals_.find_test(from_seconds(2.0), camera_at(5.1)), nullptr) << "too long ago";
}

TEST_F(RivalPlaceTest, IsSwappedWithTheAdoptedPlace) {
  observe(0.0, shown_);
  rivals_.note_place(Timestamp{0}, camera_at(0.0), open_place());
  rivals_.begin(from_seconds(0.1), camera_at(5.0));
  EXPECT_NEAR(rivals_.log_odds(), open_place().log_odds(), 1e-9);
}

TEST_F(RivalPlaceTest, IsForgottenAfterALongTime) {
  observe(0.0, shown_);
  rivals_.note_place(Timestamp{0}, camera_at(0.0), open_place());
  rivals_.begin(from_seconds(2.0), camera_at(5.0));
  EXPECT_EQ(rivals_.log_odds(), kNoRivals);
}

}  // namespace
}  // namespace byre
