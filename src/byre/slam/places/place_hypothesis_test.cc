#include "byre/slam/places/place_hypothesis.h"

#include "byre/slam/places/place_view_scene.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

PlaceHypothesis observed(PlaceHypothesis place, const PlaceView& view, int frames) {
  for (int i = 0; i < frames; ++i) place.observe(view, true);
  return place;
}

// View of a gate's leaf: cells of one plane, 4 m wide and 4 m high.
PlaceView view_of_gate() {
  PlaceView view{.is_near_keyframe = true, .cells = {}};
  for (const int y : {0, 1}) {
    for (const int z : {0, 1}) view.cells.push_back(cell_in_view({0, y, z}, 20));
  }
  return view;
}

TEST(PlaceHypothesis, IsAcceptedByDefault) {
  EXPECT_TRUE(PlaceHypothesis().is_accepted());
  EXPECT_TRUE(PlaceHypothesis().is_confirmed());
}

TEST(PlaceHypothesis, CountsATagOnceAgainstLookAlikesAsWell) {
  PlaceView view{.is_near_keyframe = true, .cells = {}};
  const PlaceHypothesis without = observed(PlaceHypothesis(0.0, 0), view, 1);
  view.tags = {{{TagFamily::tag36h11, 3}, true}};
  const PlaceHypothesis once = observed(PlaceHypothesis(0.0, 0), view, 1);
  EXPECT_GT(once.log_odds(), without.log_odds() + 3.25);
  EXPECT_GT(once.log_odds_to_rivals(), without.log_odds_to_rivals() + 3.25);
  EXPECT_DOUBLE_EQ(observed(once, view, 20).log_odds(), once.log_odds());
}

TEST(PlaceHypothesis, IsNotRejectedByOneContradictingTag) {
  PlaceView view{.is_near_keyframe = true, .cells = {}};
  view.tags = {{{TagFamily::tag36h11, 3}, false}};
  const PlaceHypothesis place = observed(PlaceHypothesis(), view, 20);
  EXPECT_LT(place.log_odds(), -3.0);
  EXPECT_TRUE(place.is_accepted());
  view.tags.front().agrees = true;
  EXPECT_GT(observed(place, view, 1).log_odds(), 3.0) << "the last detection counts";
}

TEST(PlaceHypothesis, CountsContradictionsInARowAndForgetsATagOutOfView) {
  const TagId tag{TagFamily::tag36h11, 3};
  PlaceView view{.is_near_keyframe = true, .cells = {}};
  view.tags = {{tag, false}};
  PlaceHypothesis place = observed(PlaceHypothesis(), view, 3);
  EXPECT_EQ(place.contradictions(tag), 3);
  EXPECT_TRUE(place.is_contradicted_by_tag());
  view.tags.front().agrees = true;
  EXPECT_EQ(observed(place, view, 1).contradictions(tag), 0);
  view.tags.clear();
  place = observed(place, view, 60);
  EXPECT_EQ(place.contradictions(tag), 0);
  EXPECT_EQ(place.log_odds(), 0.0);
}

TEST(PlaceHypothesis, IsAcceptedAfterItsFramesAreTracked) {
  PlaceHypothesis place(0.0, 2);
  place.observe(view_of_room(10, 0), false);
  EXPECT_FALSE(observed(place, view_of_room(10, 0), 1).is_confirmed());
  EXPECT_TRUE(observed(place, view_of_room(10, 0), 2).is_confirmed());
}

TEST(PlaceHypothesis, IsAcceptedIfTheMapIsVisibleAllAround) {
  EXPECT_TRUE(observed(PlaceHypothesis(0.0, 0), view_of_room(10, 0), 1).is_accepted());
}

TEST(PlaceHypothesis, IsAcceptedIfAThirdOfTheCellsHasChanged) {
  EXPECT_TRUE(observed(PlaceHypothesis(0.0, 0), view_of_room(14, 7), 1).is_accepted());
}

TEST(PlaceHypothesis, StaysOpenIfFewExpectedPointsAreFound) {
  const PlaceHypothesis place = observed(PlaceHypothesis(0.0, 0), view_of_room(3, 17), 100);
  EXPECT_FALSE(place.is_accepted());
  EXPECT_LT(place.log_odds(), 0.0);
}

TEST(PlaceHypothesis, HasMoreEvidenceTheMorePointsOfACellAreSeen) {
  const auto log_odds = [](int seen) {
    PlaceView view = view_of_room(10, 0);
    for (CellInView& cell : view.cells) cell.seen = cell.seen_alone = seen;
    return observed(PlaceHypothesis(0.0, 0), view, 1).log_odds();
  };
  EXPECT_LT(log_odds(0), 0.0);
  EXPECT_DOUBLE_EQ(log_odds(1), 0.0) << "as frequent at wrong poses";
  EXPECT_GT(log_odds(3), log_odds(1));
  EXPECT_GT(log_odds(6), log_odds(3));
  EXPECT_GT(log_odds(30), log_odds(6));
}

TEST(PlaceHypothesis, StaysOpenIfOneMovedObjectExplainsAllMatches) {
  EXPECT_FALSE(observed(PlaceHypothesis(0.0, 0), view_of_gate(), 100).is_accepted());
  PlaceView with_surroundings = view_of_gate();
  with_surroundings.cells.push_back(cell_in_view({9, 0, 0}, 20));
  with_surroundings.cells.push_back(cell_in_view({9, 5, 0}, 20));
  EXPECT_TRUE(observed(PlaceHypothesis(0.0, 0), with_surroundings, 1).is_accepted());
}

TEST(PlaceHypothesis, StaysOpenIfSurroundingsContradictAnObject) {
  PlaceView view = view_of_gate();
  for (int x = 5; x < 9; ++x) view.cells.push_back(cell_in_view({x, 0, 0}, 0));
  EXPECT_LT(observed(PlaceHypothesis(0.0, 0), view, 1).log_odds(), 1.0);
}

TEST(PlaceHypothesis, CountsACellOncePerMission) {
  const PlaceHypothesis once = observed(PlaceHypothesis(0.0, 0), view_of_room(4, 6), 1);
  EXPECT_DOUBLE_EQ(observed(once, view_of_room(4, 6), 100).log_odds(), once.log_odds());
}

TEST(PlaceHypothesis, RequiresMoreEvidenceForAnUnreachablePlace) {
  const double against = -10.0;
  EXPECT_FALSE(observed(PlaceHypothesis(against, 0), view_of_room(8, 0), 1).is_accepted());
  EXPECT_TRUE(observed(PlaceHypothesis(against, 0), view_of_room(16, 0), 1).is_accepted());
}

TEST(PlaceHypothesis, RequiresTrackedFrames) {
  PlaceHypothesis place(0.0, 2);
  place.observe(view_of_room(10, 0), false);
  EXPECT_FALSE(observed(place, view_of_room(10, 0), 1).is_accepted());
  EXPECT_TRUE(observed(place, view_of_room(10, 0), 2).is_accepted());
}

TEST(PlaceHypothesis, MustOutweighItsRivals) {
  PlaceHypothesis place(0.0, 0);
  place.observe(view_of_room(10, 0), true, 13.5);
  EXPECT_GT(place.log_odds(), RegistrationOptions{}.accept_log_odds);
  EXPECT_FALSE(place.is_accepted());
  place.observe(view_of_room(10, 0), true, 2.0);
  EXPECT_TRUE(place.is_accepted());
}

TEST(PlaceHypothesis, IgnoresPointsSharedWithARival) {
  PlaceView view = view_of_room(10, 0);
  for (CellInView& cell : view.cells) cell.expected_alone = cell.seen_alone = 0;
  PlaceHypothesis with_rival(0.0, 0), without(0.0, 0);
  with_rival.observe(view, true, 0.0);
  without.observe(view, true);
  EXPECT_FALSE(with_rival.is_accepted());
  EXPECT_TRUE(without.is_accepted());
}

// Points that a look-alike has as well, but that are not seen, are evidence against the place and not for it.
TEST(PlaceHypothesis, MustOutweighItsRivalsByAllPointsToo) {
  PlaceView view = view_of_room(10, 0);
  for (std::size_t i = 0; i < view.cells.size() / 2; ++i) {
    view.cells[i].seen = view.cells[i].expected_alone = view.cells[i].seen_alone = 0;
  }
  const double accept = RegistrationOptions{}.accept_log_odds;
  PlaceHypothesis place(0.0, 0);
  place.observe(view, true, 100.0);
  ASSERT_GT(place.log_odds_to_rivals(), place.log_odds());
  const double between = 0.5 * (place.log_odds_to_rivals() + place.log_odds());
  place.observe(view, true, between - accept);
  EXPECT_FALSE(place.is_accepted());
}

TEST(PlaceHypothesis, StaysAcceptedAfterCellsAreForgotten) {
  PlaceHypothesis place = observed(PlaceHypothesis(-10.0, 0), view_of_room(16, 0), 1);
  ASSERT_TRUE(place.is_accepted());
  EXPECT_TRUE(observed(place, view_of_room(2, 0), 200).is_accepted());
}

TEST(PlaceHypothesis, IsRejectedOnceTheMapIsNoLongerVisible) {
  PlaceHypothesis place = observed(PlaceHypothesis(0.0, 0), view_of_room(10, 0), 5);
  ASSERT_TRUE(place.is_accepted());
  place = observed(place, view_of_room(0, 20), 5);
  EXPECT_TRUE(place.is_accepted()) << "a few frames may be covered";
  EXPECT_FALSE(observed(place, view_of_room(0, 20), 100).is_accepted());
}

TEST(PlaceHypothesis, StaysAcceptedIfWallsMayHideTheMap) {
  PlaceHypothesis place = observed(PlaceHypothesis(0.0, 0), view_of_room(10, 0), 5);
  PlaceView off_the_map = view_of_room(0, 40);
  off_the_map.is_near_keyframe = false;
  EXPECT_TRUE(observed(place, off_the_map, 1000).is_accepted());
}

TEST(PlaceHypothesis, IgnoresCellsWithFewPoints) {
  PlaceView view{.is_near_keyframe = true, .cells = {}};
  for (int x = 0; x < 20; ++x) view.cells.push_back({{x, 0, 0}, 3, 3});
  EXPECT_DOUBLE_EQ(observed(PlaceHypothesis(0.0, 0), view, 1).log_odds(), 0.0);
}

TEST(PlaceHypothesis, IsKeptIfThePoseIsFoundAgain) {
  PlaceHypothesis place = observed(PlaceHypothesis(0.0, 0), view_of_room(10, 0), 5);
  place.require_confirmations(3);
  EXPECT_FALSE(place.is_confirmed());
  EXPECT_TRUE(place.is_accepted());
}

}  // namespace
}  // namespace byre
