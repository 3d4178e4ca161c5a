#include "byre/slam/frame/health.h"

#include <ostream>

#include <gmock/gmock.h>

namespace byre {

void PrintTo(Verdict verdict, std::ostream* out) {
  *out << to_string(verdict);
}
void PrintTo(DistrustReason doubt, std::ostream* out) {
  *out << to_string(doubt);
}

namespace {

// A frame without any problem in a mapped place.
Health good() {
  Health health;
  health.offline_expected = 400;
  health.offline_matches = 220;
  health.offline_inliers = 200;
  health.online_inliers = 100;
  health.inlier_share = 0.9;
  health.spread = 0.2;
  health.agreement = Agreement{0.003, 0.001};
  health.position_sigma = 0.005;
  health.rotation_sigma = 0.001;
  return health;
}

constexpr HealthEvidence kPose{.pose_found = true};

struct Judgement {
  const char* name;
  Health health;
  HealthEvidence evidence;
  Verdict verdict;
  DistrustReason doubt;
};

void PrintTo(const Judgement& judgement, std::ostream* out) {
  *out << judgement.name;
}

Health with(void (*change)(Health&)) {
  Health health = good();
  change(health);
  return health;
}

class JudgedHealth : public ::testing::TestWithParam<Judgement> {};

TEST_P(JudgedHealth, FollowsTheTable) {
  const Health health = assess(GetParam().health, GetParam().evidence, {});
  EXPECT_EQ(health.verdict, GetParam().verdict);
  EXPECT_EQ(health.doubt, GetParam().doubt);
}

INSTANTIATE_TEST_SUITE_P(
    Table, JudgedHealth,
    ::testing::Values(
        Judgement{"mapped place", good(), kPose, Verdict::trusted, DistrustReason::none},
        Judgement{"no pose", {}, {}, Verdict::untrusted, DistrustReason::no_pose},
        Judgement{
            "no pose in the dark", {}, {.image_fault = ImageFault::dark}, Verdict::untrusted, DistrustReason::blinded},
        Judgement{"unregistered online map",
                  good(),
                  {.pose_found = true, .registered = false},
                  Verdict::untrusted,
                  DistrustReason::not_registered},
        Judgement{"just relocalised",
                  good(),
                  {.pose_found = true, .confirmed = false},
                  Verdict::untrusted,
                  DistrustReason::unconfirmed},
        Judgement{"near the map", with([](Health& h) {
                    h.offline_expected = h.offline_inliers = 0;
                    h.online_inliers = 300;
                    h.distance_since_offline = 20.0;
                  }),
                  kPose, Verdict::trusted, DistrustReason::none},
        Judgement{"far off the map", with([](Health& h) {
                    h.offline_expected = h.offline_inliers = 0;
                    h.online_inliers = 300;
                    h.distance_since_offline = 60.0;
                  }),
                  kPose, Verdict::untrusted, DistrustReason::off_the_map},
        Judgement{"uncertain position", with([](Health& h) { h.position_sigma = 0.1; }), kPose, Verdict::untrusted,
                  DistrustReason::uncertain},
        Judgement{"uncertain rotation", with([](Health& h) { h.rotation_sigma = 0.05; }), kPose, Verdict::degraded,
                  DistrustReason::uncertain},
        Judgement{"moved objects",
                  with([](Health& h) {
                    h.agreement = Agreement{0.3, 0.01};
                  }),
                  {.pose_found = true, .maps_disagree = true},
                  Verdict::degraded,
                  DistrustReason::maps_disagree},
        Judgement{"few distant online points without position information", with([](Health& h) {
                    h.agreement = Agreement{0.3, 0.01};
                  }),
                  kPose, Verdict::trusted, DistrustReason::none},
        Judgement{"few points", with([](Health& h) {
                    h.offline_inliers = 15;
                    h.online_inliers = 10;
                  }),
                  kPose, Verdict::degraded, DistrustReason::few_points},
        Judgement{"few points due to blur",
                  with([](Health& h) {
                    h.offline_inliers = 15;
                    h.online_inliers = 10;
                  }),
                  {.pose_found = true, .image_fault = ImageFault::blurred},
                  Verdict::degraded,
                  DistrustReason::blinded},
        Judgement{"points in a corner", with([](Health& h) { h.spread = 0.01; }), kPose, Verdict::degraded,
                  DistrustReason::clustered},
        Judgement{"a third of the image hidden by dirt", with([](Health& h) { h.hidden_share = 0.33; }), kPose,
                  Verdict::trusted, DistrustReason::none},
        Judgement{"most of the image hidden by dirt", with([](Health& h) { h.hidden_share = 0.7; }), kPose,
                  Verdict::degraded, DistrustReason::dirty},
        Judgement{"a lookalike place", with([](Health& h) {
                    h.offline_expected = 1800;
                    h.offline_inliers = 30;
                    h.online_inliers = 300;
                  }),
                  kPose, Verdict::degraded, DistrustReason::few_offline_points},
        Judgement{"a changed place, short", with([](Health& h) {
                    h.offline_inliers = 5;
                    h.online_inliers = 200;
                    h.distance_since_offline = 2.0;
                  }),
                  kPose, Verdict::trusted, DistrustReason::none},
        Judgement{"a changed place, long", with([](Health& h) {
                    h.offline_inliers = 5;
                    h.online_inliers = 200;
                    h.distance_since_offline = 8.0;
                  }),
                  kPose, Verdict::degraded, DistrustReason::few_offline_points},
        Judgement{"a repeated image",
                  good(),
                  {.pose_found = true, .input = {.is_repeated = true, .frozen_seconds = 0.05}},
                  Verdict::degraded,
                  DistrustReason::frozen},
        Judgement{"a frozen camera",
                  good(),
                  {.pose_found = true, .input = {.is_repeated = true, .frozen_seconds = 0.3}},
                  Verdict::untrusted,
                  DistrustReason::frozen},
        Judgement{"a dark right camera",
                  good(),
                  {.pose_found = true, .input = {.right_fault = ImageFault::dark}},
                  Verdict::degraded,
                  DistrustReason::right_camera},
        Judgement{"unsynchronised cameras",
                  good(),
                  {.pose_found = true, .input = {.cameras_disagree = true}},
                  Verdict::degraded,
                  DistrustReason::cameras_disagree},
        Judgement{"no pose with unsynchronised cameras",
                  {},
                  {.input = {.cameras_disagree = true}},
                  Verdict::untrusted,
                  DistrustReason::cameras_disagree},
        Judgement{"another focal length",
                  good(),
                  {.pose_found = true, .is_miscalibrated = true},
                  Verdict::untrusted,
                  DistrustReason::calibration},
        Judgement{"an implausible calibration error",
                  good(),
                  {.pose_found = true, .is_calibration_doubtful = true},
                  Verdict::degraded,
                  DistrustReason::calibration},
        Judgement{"a short path in the dark",
                  with([](Health& h) { h.position_sigma = 0.03; }),
                  {.image_fault = ImageFault::dark, .bridged_from = Verdict::trusted},
                  Verdict::degraded,
                  DistrustReason::bridged},
        Judgement{"a long path in the dark",
                  with([](Health& h) { h.position_sigma = 0.1; }),
                  {.image_fault = ImageFault::dark, .bridged_from = Verdict::trusted},
                  Verdict::untrusted,
                  DistrustReason::bridged},
        Judgement{"a long turn in the dark",
                  with([](Health& h) { h.rotation_sigma = 0.05; }),
                  {.image_fault = ImageFault::dark, .bridged_from = Verdict::trusted},
                  Verdict::untrusted,
                  DistrustReason::bridged},
        Judgement{"a path in the dark from an untrusted pose",
                  good(),
                  {.image_fault = ImageFault::dark, .bridged_from = Verdict::untrusted},
                  Verdict::untrusted,
                  DistrustReason::bridged},
        Judgement{"an unchecked calibration",
                  good(),
                  {.pose_found = true, .is_calibration_open = true},
                  Verdict::degraded,
                  DistrustReason::unconfirmed}));

TEST(NoteOnDirt, ReportsTheLensesToClean) {
  Health health;
  EXPECT_EQ(note_on_dirt(health), "");
  health.hidden_share = 0.1187;
  EXPECT_EQ(note_on_dirt(health), "dirt hides 12 % of the left image: clean the lens");
  health.hidden_share_right = 0.003;
  EXPECT_EQ(note_on_dirt(health), "dirt hides 12 % of the left image and 1 % of the right image: clean the lenses");
  health.hidden_share = 0.0;
  EXPECT_EQ(note_on_dirt(health), "dirt hides 1 % of the right image: clean the lens");
}

// Notes a number of frames, 20 per second, with the same evidence. Returns the number of frames with a doubt.
template <typename IsRaised>
int raised_frames(FaultLatches& doubts, int first, int count, const HealthEvidence& evidence, IsRaised is_raised) {
  int raised = 0;
  for (int i = first; i < first + count; ++i) {
    if (is_raised(doubts.latch(from_seconds(0.05 * i), evidence))) ++raised;
  }
  return raised;
}

bool are_cameras_at_odds(const HealthEvidence& evidence) {
  return evidence.input.cameras_disagree;
}

bool is_frozen(const HealthEvidence& evidence) {
  return evidence.input.is_frozen;
}

constexpr HealthEvidence kInStep{.pose_found = true, .input = {.out_of_sync = Sign::absent}};

TEST(FaultLatches, OfAPairDetectedInMotionEndOnlyInMotion) {
  FaultLatches doubts;
  constexpr HealthEvidence kAtOdds{.pose_found = true, .input = {.cameras_disagree = true}};
  EXPECT_EQ(raised_frames(doubts, 0, 1, kAtOdds, are_cameras_at_odds), 1);
  EXPECT_EQ(raised_frames(doubts, 1, 200, kPose, are_cameras_at_odds), 200);
  const int raised = raised_frames(doubts, 201, 100, kInStep, are_cameras_at_odds);
  EXPECT_GE(raised, 10);
  EXPECT_LE(raised, 25);
}

TEST(FaultLatches, OfAPairDetectedAtAStandstillEndThere) {
  FaultLatches doubts;
  constexpr HealthEvidence kAtOdds{.pose_found = true, .input = {.is_still = true, .cameras_disagree = true}};
  EXPECT_EQ(raised_frames(doubts, 0, 1, kAtOdds, are_cameras_at_odds), 1);
  EXPECT_LE(raised_frames(doubts, 1, 200, {.pose_found = true, .input = {.is_still = true}}, are_cameras_at_odds), 25);
}

TEST(FaultLatches, OfAPairAreRaisedByItsTimingAlone) {
  FaultLatches doubts;
  EXPECT_EQ(
      raised_frames(doubts, 0, 1, {.pose_found = true, .input = {.out_of_sync = Sign::present}}, are_cameras_at_odds),
      1);
}

TEST(FaultLatches, OfAFrozenImageDoNotEndAtAStandstill) {
  FaultLatches doubts;
  EXPECT_EQ(raised_frames(doubts, 0, 1, {.input = {.is_still = true, .is_frozen = true}}, is_frozen), 1);
  EXPECT_EQ(raised_frames(doubts, 1, 200, {.pose_found = true, .input = {.is_still = true}}, is_frozen), 200);
  EXPECT_LE(raised_frames(doubts, 201, 200, kPose, is_frozen), 25);
}

TEST(FaultLatches, OfTheCalibrationNeedFramesWithAPose) {
  FaultLatches doubts;
  const auto is_off = [](const HealthEvidence& evidence) { return evidence.is_miscalibrated; };
  EXPECT_EQ(raised_frames(doubts, 0, 1, {.pose_found = true, .is_miscalibrated = true}, is_off), 1);
  EXPECT_EQ(raised_frames(doubts, 1, 200, {}, is_off), 200);
  EXPECT_LE(raised_frames(doubts, 201, 200, kPose, is_off), 25);
}

TEST(FaultLatches, KeepTheFaultOfTheRightCamera) {
  FaultLatches doubts;
  const auto fault = [](const HealthEvidence& evidence) { return evidence.input.right_fault == ImageFault::dark; };
  EXPECT_EQ(raised_frames(doubts, 0, 1, {.input = {.right_fault = ImageFault::dark}}, fault), 1);
  EXPECT_GE(raised_frames(doubts, 1, 100, kPose, fault), 10);
}

TEST(FaultLatches, AreEmptyForSoundFrames) {
  FaultLatches doubts;
  const HealthEvidence held = doubts.latch(from_seconds(1.0), kInStep);
  EXPECT_EQ(assess(good(), held, {}).verdict, Verdict::trusted);
}

}  // namespace
}  // namespace byre
