#include "byre/ros2/dds/ros_network.h"

#include "byre/input_error.h"

#include <map>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

Environment environment_of(const std::map<std::string, std::string>& variables) {
  return [variables](const char* name) -> std::optional<std::string> {
    const auto found = variables.find(name);
    return found == variables.end() ? std::nullopt : std::optional(found->second);
  };
}

TEST(RosNetwork, DefaultsToTheSubnetInDomainZero) {
  const RosNetwork network = read_ros_network(environment_of({}));
  EXPECT_EQ(network.domain, 0);
  EXPECT_EQ(network.range, DiscoveryRange::subnet);
  EXPECT_THAT(network.peers, IsEmpty());
  EXPECT_EQ(network.distribution, RosDistribution::jazzy);
  EXPECT_FALSE(network.uses_cyclone);
  EXPECT_THAT(cyclone_settings(network, ""), AllOf(Not(HasSubstr("Discovery")), Not(HasSubstr("Multicast"))));
}

TEST(RosNetwork, IsReadFromRosVariables) {
  const RosNetwork network = read_ros_network(environment_of({{"ROS_DOMAIN_ID", "42"},
                                                              {"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"},
                                                              {"ROS_STATIC_PEERS", "10.0.0.7;barn.local"},
                                                              {"ROS_DISTRO", "humble"},
                                                              {"RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp"}}));
  EXPECT_EQ(network.domain, 42);
  EXPECT_EQ(network.range, DiscoveryRange::localhost);
  EXPECT_THAT(network.peers, ElementsAre("10.0.0.7", "barn.local"));
  EXPECT_EQ(network.distribution, RosDistribution::humble);
  EXPECT_TRUE(network.uses_cyclone);
  EXPECT_THAT(cyclone_settings(network, ""),
              AllOf(HasSubstr("<AllowMulticast>false</AllowMulticast>"), HasSubstr("address=\"localhost\""),
                    HasSubstr("address=\"10.0.0.7\""), HasSubstr("address=\"127.0.0.1\"")));
}

TEST(RosNetwork, ReadsTheOlderVariableForLocalhost) {
  const auto range = [](const char* value) {
    return read_ros_network(environment_of({{"ROS_LOCALHOST_ONLY", value}})).range;
  };
  EXPECT_EQ(range("1"), DiscoveryRange::localhost);
  EXPECT_EQ(range("0"), DiscoveryRange::subnet);
}

TEST(RosNetwork, DisablesDiscovery) {
  const RosNetwork network =
      read_ros_network(environment_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}, {"ROS_STATIC_PEERS", "10.0.0.7"}}));
  EXPECT_THAT(network.peers, IsEmpty());
  EXPECT_THAT(cyclone_settings(network, ""), HasSubstr("<AllowMulticast>false</AllowMulticast>"));
}

TEST(RosNetwork, LetsCycloneSettingsOverride) {
  const std::string settings =
      cyclone_settings({.range = DiscoveryRange::localhost, .peers = {"<evil&\">"}}, "file:///etc/cyclone.xml");
  EXPECT_LT(settings.find("localhost"), settings.find("file:///etc/cyclone.xml"));
  EXPECT_THAT(settings, Not(HasSubstr("<evil")));
}

TEST(RosNetwork, RejectsInvalidValues) {
  for (const auto& [name, value] : std::map<std::string, std::string>{
           {"ROS_DOMAIN_ID", "barn"}, {"ROS_AUTOMATIC_DISCOVERY_RANGE", "nearby"}, {"ROS_DISTRO", "Humble 2"}}) {
    try {
      read_ros_network(environment_of({{name, value}}));
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_EQ(error.place(), name);
      EXPECT_THAT(error.remedy(), Not(IsEmpty()));
    }
  }
  EXPECT_THROW(read_ros_network(environment_of({{"ROS_DOMAIN_ID", "233"}})), InputError);
  EXPECT_THROW(read_ros_network(environment_of({{"ROS_DOMAIN_ID", "-1"}})), InputError);
}

TEST(RosDistribution, IsOrderedByItsFirstLetter) {
  EXPECT_EQ(distribution_of("foxy"), RosDistribution::humble);
  EXPECT_EQ(distribution_of("humble"), RosDistribution::humble);
  EXPECT_EQ(distribution_of("iron"), RosDistribution::jazzy);
  EXPECT_EQ(distribution_of("rolling"), RosDistribution::jazzy);
  EXPECT_EQ(distribution_of(""), std::nullopt);
}

}  // namespace
}  // namespace byre
