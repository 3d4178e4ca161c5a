#include "byre/viewer/web/web_access.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

namespace byre {
namespace {

using std::chrono::milliseconds;
using ::testing::Eq;
using ::testing::Optional;

WebLimits small() {
  WebLimits limits;
  limits.accepted = 2;
  limits.pending = 3;
  return limits;
}

TEST(ConnectionTable, ReplacesUnidentifiedGuests) {
  ConnectionTable table(small());
  const ConnectionTable::Id first = table.open("a").id;
  table.open("a");
  EXPECT_EQ(table.open("a").to_close, std::nullopt);
  EXPECT_THAT(table.open("a").to_close, Optional(Eq(first)));
  table.close(first);
  EXPECT_EQ(table.pending(), 3);
}

TEST(ConnectionTable, ClosesGuestsOfTheAddressWithMostConnections) {
  ConnectionTable table(small());
  table.open("calm");
  const ConnectionTable::Id oldest_of_many = table.open("many").id;
  table.open("many");
  EXPECT_THAT(table.open("late").to_close, Optional(Eq(oldest_of_many)));
}

TEST(ConnectionTable, KeepsIdentifiedGuests) {
  ConnectionTable table(small());
  const ConnectionTable::Id one = table.open("a").id;
  const ConnectionTable::Id two = table.open("a").id;
  const ConnectionTable::Id three = table.open("a").id;
  EXPECT_TRUE(table.accept(one));
  EXPECT_TRUE(table.accept(two));
  EXPECT_FALSE(table.accept(three)) << "the limit is reached";
  EXPECT_EQ(table.pending(), 1);
  table.close(one);
  EXPECT_EQ(table.accepted(), 1);
  EXPECT_TRUE(table.accept(three));
  EXPECT_FALSE(table.accept(three)) << "leaving twice is harmless";
  EXPECT_EQ(table.pending(), 0);
}

TEST(AcceptLimiter, AllowsABurstThenAFixedRate) {
  WebLimits limits;
  limits.accepts_per_second = 10.0;
  limits.accept_burst = 2;
  const AcceptLimiter::Time start{};
  AcceptLimiter rate(limits, start);
  EXPECT_EQ(rate.wait(start), milliseconds(0));
  rate.count(start);
  rate.count(start);
  EXPECT_EQ(rate.wait(start), milliseconds(100));
  EXPECT_EQ(rate.wait(start + milliseconds(60)), milliseconds(40));
  EXPECT_EQ(rate.wait(start + milliseconds(100)), milliseconds(0));
  rate.count(start + std::chrono::hours(1));
  rate.count(start + std::chrono::hours(1));
  EXPECT_EQ(rate.wait(start + std::chrono::hours(1)), milliseconds(100)) << "the burst stays at two after an hour";
}

TEST(EndOfDescriptors, ReservesDescriptorsAtAnyLimit) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const auto end_at = [&before](rlim_t most) {
    const rlimit changed{most, before.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &changed), 0);
    return end_of_descriptors({});
  };
  EXPECT_EQ(end_at(1024), 1024 - WebLimits{}.reserved_descriptors);
  EXPECT_EQ(end_at(40), 20);
  EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
}

}  // namespace
}  // namespace byre
