#include "byre/ros2/node/node_services.h"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ros::ParameterValue;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;
using testing::SizeIs;

std::vector<std::string> every_name() {
  return parameter_names({}).names;
}

TEST(Parameters, AreAllSettingsWithTheirGroups) {
  const auto listed = parameter_names({});
  EXPECT_THAT(listed.names, SizeIs(node_settings().size()));
  EXPECT_THAT(listed.names, IsSupersetOf({"slam.map", "images.left", "http.port"}));
  EXPECT_THAT(listed.prefixes, AllOf(Contains("slam"), Contains("process"), Not(Contains("slam.map"))));
}

TEST(Parameters, AreListedByPrefixAndDepth) {
  const auto names = [](std::vector<std::string> prefixes, std::uint64_t depth) {
    return parameter_names({std::move(prefixes), depth}).names;
  };
  EXPECT_THAT(names({"grid"}, ros::ListParameters::kRecursive), AllOf(Contains("grid.footprint"), SizeIs(4)));
  EXPECT_THAT(names({"grid"}, 1), SizeIs(4));
  EXPECT_THAT(names({"slam.map", "http.port"}, 1), ElementsAre("slam.map", "http.port"));
  EXPECT_THAT(names({"gri", "", "grid."}, 0), IsEmpty()) << "whole parts only";
  EXPECT_THAT(names({}, 1), IsEmpty()) << "no setting without a group";
  EXPECT_THAT(names({}, 2), SizeIs(node_settings().size()));
}

TEST(Parameters, HaveTypedValuesInTheOrderOfTheRequest) {
  NodeConfig config;
  config.map = "/maps/barn.byre";
  config.http_port = 8080;
  const auto values =
      parameter_values(config, {"grid.resolution", "slam.map", "no.such", "http.port", "images.rectified"});
  ASSERT_THAT(values, SizeIs(5));
  EXPECT_EQ(values[0].type, ParameterValue::kDouble);
  EXPECT_EQ(values[0].double_value, config.grid_resolution);
  EXPECT_EQ(values[1].type, ParameterValue::kString);
  EXPECT_EQ(values[1].string_value, "/maps/barn.byre");
  EXPECT_EQ(values[2].type, ParameterValue::kNotSet);
  EXPECT_EQ(values[3].type, ParameterValue::kInteger);
  EXPECT_EQ(values[3].integer_value, 8080);
  EXPECT_EQ(values[4].type, ParameterValue::kBool);
  EXPECT_FALSE(values[4].bool_value);
}

TEST(Parameters, OfEmptyNumbersAndChoicesAreText) {
  const auto values = parameter_values({}, {"http.port", "grid.body_height", "node.services"});
  for (const ParameterValue& value : values) EXPECT_EQ(value.type, ParameterValue::kString);
  EXPECT_EQ(values[0].string_value, "");
  EXPECT_EQ(values[2].string_value, "auto");
}

// `ros2 param dump` writes values, which a parameter file then sets.
TEST(Parameters, SetTheSameSettingsAgain) {
  NodeConfig config;
  config.http_port = 8080;
  config.body_height = 0.25;
  config.is_rectified = true;
  config.task = NodeTask::extend;
  const auto names = every_name();
  const auto values = parameter_values(config, names);
  NodeConfig again;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const ParameterValue& value = values[i];
    std::string text = value.string_value;
    if (value.type == ParameterValue::kBool) text = value.bool_value ? "true" : "false";
    if (value.type == ParameterValue::kInteger) text = std::to_string(value.integer_value);
    if (value.type == ParameterValue::kDouble) text = std::to_string(value.double_value);
    EXPECT_TRUE(node_settings()[i].set(again, text)) << names[i] << " of " << text;
  }
  EXPECT_EQ(node_config_file(again), node_config_file(config));
}

TEST(Parameters, HaveTypesAndDescriptions) {
  const auto names = every_name();
  const auto types = parameter_types({}, names);
  const auto descriptors = parameter_descriptions({}, names);
  ASSERT_EQ(types.size(), names.size());
  ASSERT_EQ(descriptors.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(descriptors[i].name, names[i]);
    EXPECT_EQ(descriptors[i].type, types[i]);
    EXPECT_TRUE(descriptors[i].read_only);
    EXPECT_NE(descriptors[i].description, "");
    EXPECT_EQ(descriptors[i].additional_constraints, node_settings()[i].range);
  }
  const auto unknown = parameter_descriptions({}, {"no.such"});
  ASSERT_THAT(unknown, SizeIs(1));
  EXPECT_EQ(unknown[0].type, ParameterValue::kNotSet);
}

TEST(Parameters, AreReadOnly) {
  const std::vector<ros::Parameter> request{{"slam.map", {}}, {"no.such", {}}};
  const auto results = refused_parameters(request);
  ASSERT_THAT(results, SizeIs(2));
  EXPECT_FALSE(results[0].successful);
  EXPECT_THAT(results[0].reason, HasSubstr("slam.map is read-only"));
  EXPECT_FALSE(results[1].successful);
  EXPECT_THAT(results[1].reason, HasSubstr("unknown parameter no.such"));
  const auto together = refused_atomically(request);
  EXPECT_FALSE(together.successful);
  EXPECT_THAT(together.reason, HasSubstr("slam.map is read-only"));
}

}  // namespace
}  // namespace byre
