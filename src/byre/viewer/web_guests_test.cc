#include "byre/viewer/web_guests.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

namespace byre {
namespace {

using std::chrono::milliseconds;
using ::testing::Eq;
using ::testing::Optional;

WebLimits small() {
  WebLimits limits;
  limits.known = 2;
  limits.strangers = 3;
  return limits;
}

TEST(WebGuests, ReplacesUnidentifiedGuests) {
  WebGuests guests(small());
  const WebGuests::Id first = guests.arrive("a").id;
  guests.arrive("a");
  EXPECT_EQ(guests.arrive("a").to_close, std::nullopt);
  EXPECT_THAT(guests.arrive("a").to_close, Optional(Eq(first)));
  guests.leave(first);
  EXPECT_EQ(guests.strangers(), 3);
}

TEST(WebGuests, ClosesGuestsOfTheAddressWithMostConnections) {
  WebGuests guests(small());
  guests.arrive("calm");
  const WebGuests::Id oldest_of_many = guests.arrive("many").id;
  guests.arrive("many");
  EXPECT_THAT(guests.arrive("late").to_close, Optional(Eq(oldest_of_many)));
}

TEST(WebGuests, KeepsIdentifiedGuests) {
  WebGuests guests(small());
  const WebGuests::Id one = guests.arrive("a").id;
  const WebGuests::Id two = guests.arrive("a").id;
  const WebGuests::Id three = guests.arrive("a").id;
  EXPECT_TRUE(guests.introduce(one));
  EXPECT_TRUE(guests.introduce(two));
  EXPECT_FALSE(guests.introduce(three)) << "the limit is reached";
  EXPECT_EQ(guests.strangers(), 1);
  guests.leave(one);
  EXPECT_EQ(guests.known(), 1);
  EXPECT_TRUE(guests.introduce(three));
  EXPECT_FALSE(guests.introduce(three)) << "leaving twice is harmless";
  EXPECT_EQ(guests.strangers(), 0);
}

TEST(ArrivalRate, AllowsABurstThenAFixedRate) {
  WebLimits limits;
  limits.arrivals_per_second = 10.0;
  limits.arrivals_at_once = 2;
  const ArrivalRate::Time start{};
  ArrivalRate rate(limits, start);
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
  EXPECT_EQ(end_at(1024), 1024 - WebLimits{}.free_descriptors);
  EXPECT_EQ(end_at(40), 20);
  EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
}

}  // namespace
}  // namespace byre
