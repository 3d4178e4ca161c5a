#include "byre/localisation/confirmation.h"

#include <string>

#include <gtest/gtest.h>

namespace byre {

void PrintTo(const Confirmation& confirmation, std::ostream* stream) {
  *stream << confirmation.frames_to_believe << " to believe, " << confirmation.frames_to_prove << " to prove";
}

namespace {

constexpr RegistrationOptions kOptions{.confirmations = 3, .proving_share = 0.06, .max_speed = 3.0};

TEST(ConfirmationOfAFind, FollowsTheTable) {
  struct Row {
    std::string find;
    FindEvidence evidence;
    Confirmation needed;
  };
  const std::vector<Row> table{
      {"the first", {}, {3, 3}},
      {"the first believed, however near an unbelieved one", {{}, {}, 0.0}, {3, 3}},
      {"where it was lost, never proven", {0.1, {}, 0.1}, {3, 3}},
      {"where it was lost, proven a moment ago", {0.1, 0.1, 0.1}, {3, 0}},
      {"where it was lost, proven too long ago", {0.1, 1.5, 0.1}, {3, 3}},
      {"as far as the robot can have come", {2.0, 0.5, 6.5}, {3, 0}},
      {"farther than the robot can have come", {2.0, 0.5, 6.6}, {10, 3}},
      {"farther, never proven", {0.1, {}, 5.0}, {10, 3}},
  };
  for (const Row& row : table) EXPECT_EQ(confirmation_of(row.evidence, kOptions), row.needed) << row.find;
}

// So many of 100 points in each region of the image.
ByImageRegion<PointsInView> seeing(int points) {
  ByImageRegion<PointsInView> regions;
  regions.fill({100, points});
  return regions;
}

TEST(ConfirmedFurther, CountsFramesDownToNone) {
  const Confirmation once = confirmed_further({2, 1}, seeing(50), kOptions);
  EXPECT_EQ(once, (Confirmation{1, 0}));
  EXPECT_FALSE(once.is_believed());
  EXPECT_TRUE(once.is_proven());
  const Confirmation twice = confirmed_further(once, seeing(50), kOptions);
  EXPECT_TRUE(twice.is_believed());
  EXPECT_EQ(confirmed_further(twice, seeing(50), kOptions), twice);
}

TEST(ConfirmedFurther, IsProvenByFramesAloneThatSeeMuchOfWhatShouldBeThere) {
  EXPECT_EQ(confirmed_further({3, 3}, seeing(5), kOptions), (Confirmation{2, 3}));
  EXPECT_EQ(confirmed_further({3, 3}, seeing(6), kOptions), (Confirmation{2, 2}));
  EXPECT_EQ(confirmed_further({3, 3}, {}, kOptions), (Confirmation{2, 3}));
}

TEST(ConfirmedFurther, IsProvenNoMoreByFramesThatSeeLittle) {
  EXPECT_EQ(confirmed_further({3, 1}, seeing(5), kOptions), (Confirmation{2, 2}));
  EXPECT_EQ(confirmed_further({3, 1}, {}, kOptions), (Confirmation{2, 2}));
  EXPECT_EQ(confirmed_further({3, 0}, seeing(5), kOptions), (Confirmation{2, 0}));
  Confirmation of_a_place_alike{0, 3};
  for (int i = 0; i < 20; ++i) {
    of_a_place_alike = confirmed_further(of_a_place_alike, seeing(i % 4 == 0 ? 8 : 4), kOptions);
    EXPECT_FALSE(of_a_place_alike.is_proven());
  }
}

TEST(ConfirmedFurther, IsNotProvenByWhatFillsAPartOfTheImage) {
  ByImageRegion<PointsInView> regions = seeing(0);
  constexpr std::size_t kMostRegions = 8;
  for (std::size_t i = 0; i + 1 < kMostRegions; ++i) regions[i].seen = 50;
  EXPECT_EQ(confirmed_further({3, 3}, regions, kOptions), (Confirmation{2, 3}));
  regions[kMostRegions - 1].seen = 3;
  EXPECT_EQ(confirmed_further({3, 3}, regions, kOptions), (Confirmation{2, 2}));
}

TEST(ConfirmedFurther, IsProvenWhereTheMapFillsAPartOfTheImage) {
  ByImageRegion<PointsInView> regions;
  regions.fill({10, 0});
  regions[0] = {100, 20};
  EXPECT_EQ(confirmed_further({3, 3}, regions, kOptions), (Confirmation{2, 2}));
}

TEST(ConfirmedFurther, AsksMoreOfWhatWasLookedForNearAHintAlone) {
  FindEvidence find;
  find.is_by_hint = true;
  const Confirmation hinted = confirmation_of(find, kOptions);
  EXPECT_EQ(hinted, (Confirmation{3, 3, true}));
  EXPECT_EQ(confirmed_further(hinted, seeing(11), kOptions), (Confirmation{2, 3, true}));
  EXPECT_EQ(confirmed_further(hinted, seeing(12), kOptions), (Confirmation{2, 2, true}));
}

TEST(Confirmation, IsNotAskedForByDefault) {
  EXPECT_TRUE(Confirmation{}.is_believed());
  EXPECT_TRUE(Confirmation{}.is_proven());
}

}  // namespace
}  // namespace byre
