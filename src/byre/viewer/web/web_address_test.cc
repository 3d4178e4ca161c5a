#include "byre/viewer/web/web_access.h"

#include <boost/asio/ip/address.hpp>
#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::ElementsAre;

TEST(ReachableAddresses, OfOneAddressIsTheAddress) {
  EXPECT_THAT(reachable_addresses("192.0.2.7"), ElementsAre("192.0.2.7"));
  EXPECT_THAT(reachable_addresses("::1"), ElementsAre("::1"));
}

TEST(ReachableAddresses, OfAllAreTheInterfacesThenLoopback) {
  for (const char* const all : {"0.0.0.0", "::"}) {
    const std::vector<std::string> addresses = reachable_addresses(all);
    ASSERT_FALSE(addresses.empty());
    EXPECT_EQ(addresses.back(), "127.0.0.1");
    for (std::size_t i = 0; i + 1 < addresses.size(); ++i) {
      const auto address = boost::asio::ip::make_address(addresses[i]);
      EXPECT_FALSE(address.is_unspecified() || address.is_loopback()) << addresses[i];
      EXPECT_TRUE(address.is_v4() || std::string(all) == "::") << addresses[i];
    }
  }
}

}  // namespace
}  // namespace byre
