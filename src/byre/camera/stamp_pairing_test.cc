#include "byre/camera/stamp_pairing.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using testing::Eq;
using testing::Optional;

class StampPairs : public testing::Test {
 protected:
  void left(Timestamp stamp, Timestamp now) { pairing_.add_left({stamp, {}}, now); }
  void right(Timestamp stamp) { pairing_.add_right({stamp, {}}); }

  StampPairing pairing_{{.tolerance = 5ms, .wait = 200ms}};
};

TEST_F(StampPairs, HaveTheNearestStamps) {
  left(100ms, 100ms);
  right(96ms);
  right(101ms);
  const auto pair = pairing_.next(110ms);
  ASSERT_TRUE(pair && pair->right);
  EXPECT_EQ(pair->right->stamp, 101ms);
  EXPECT_EQ(pairing_.counts().pairs, 1);
  EXPECT_EQ(pairing_.counts().unpaired_right, 1);
  EXPECT_THAT(pairing_.last_difference(), Optional(Eq(1ms)));
}

TEST_F(StampPairs, WaitForTheRightImage) {
  left(100ms, 100ms);
  EXPECT_FALSE(pairing_.next(150ms));
  right(102ms);
  const auto pair = pairing_.next(160ms);
  ASSERT_TRUE(pair && pair->right);
  EXPECT_EQ(pair->right->stamp, 102ms);
}

TEST_F(StampPairs, LackTheRightImageAfterATimeout) {
  left(100ms, 100ms);
  EXPECT_FALSE(pairing_.next(299ms));
  const auto pair = pairing_.next(300ms);
  ASSERT_TRUE(pair);
  EXPECT_FALSE(pair->right);
  EXPECT_EQ(pairing_.counts().unpaired_left, 1);
}

TEST_F(StampPairs, LackTheRightImageAtOnceIfALaterOneArrived) {
  left(100ms, 100ms);
  left(150ms, 150ms);
  right(151ms);
  const auto alone = pairing_.next(152ms);
  ASSERT_TRUE(alone);
  EXPECT_EQ(alone->left.stamp, 100ms);
  EXPECT_FALSE(alone->right);
  EXPECT_THAT(pairing_.last_difference(), Optional(Eq(51ms)));
  const auto pair = pairing_.next(152ms);
  ASSERT_TRUE(pair && pair->right);
  EXPECT_EQ(pair->left.stamp, 150ms);
}

TEST_F(StampPairs, AreRejectedIfStampsAreTooFarApart) {
  for (int i = 0; i < 5; ++i) {
    left(i * 50ms, i * 50ms);
    right(i * 50ms + 20ms);
    const auto alone = pairing_.next(i * 50ms + 30ms);
    ASSERT_TRUE(alone);
    EXPECT_FALSE(alone->right);
  }
  EXPECT_EQ(pairing_.counts().unpaired_left, 5);
  EXPECT_EQ(pairing_.counts().unpaired_right, 4) << "the last may still have a partner";
}

TEST_F(StampPairs, PreserveOrderAndAllMatches) {
  for (const int right_one : {0, 1, 3, 4}) right(right_one * 50ms);
  for (const int left_one : {0, 1, 2, 3}) left(left_one * 50ms, 1ms);
  std::vector<std::optional<Timestamp>> rights;
  while (const auto pair = pairing_.next(10ms))
    rights.push_back(pair->right ? std::optional(pair->right->stamp) : std::nullopt);
  EXPECT_THAT(rights, testing::ElementsAre(Optional(Eq(Timestamp(0ms))), Optional(Eq(Timestamp(50ms))),
                                           Eq(std::nullopt), Optional(Eq(Timestamp(150ms)))));
  EXPECT_EQ(pairing_.counts().unpaired_right, 0);
}

TEST_F(StampPairs, LimitStoredRightImages) {
  for (int i = 0; i < 1000; ++i) right(i * 50ms);
  EXPECT_EQ(pairing_.counts().unpaired_right, 1000 - 32);
}

}  // namespace
}  // namespace byre
