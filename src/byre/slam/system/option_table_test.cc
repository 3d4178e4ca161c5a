#include "byre/slam/system/option_table.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <sstream>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

// Converts to any member of a struct.
struct Anything {
  template <typename Member>
  operator Member() const;  // NOLINT(google-explicit-constructor): initialises members
};

// Number of members of an aggregate.
template <typename Struct, typename... Members>
constexpr std::size_t member_count() {
  if constexpr (requires { Struct{Members{}..., Anything{}}; }) {
    return member_count<Struct, Members..., Anything>();
  } else {
    return sizeof...(Members);
  }
}

template <typename... Structs>
constexpr std::size_t members_of() {
  return (member_count<Structs>() + ...);
}

// Valid texts of an option, derived from its range.
std::vector<std::string> some_values(const MethodOption& option) {
  std::string words = option.range;
  std::ranges::replace(words, '|', ' ');
  std::istringstream stream(words);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::vector<std::string> values(const MethodOptions& options) {
  std::vector<std::string> all;
  for (const MethodOption& option : option_table()) all.push_back(option.get(options));
  return all;
}

// Hidden cells of tracking and of place search are estimated, and tags are those of the map, so they are no options.
constexpr std::size_t kHiddenCellsAndTags = 3;

TEST(OptionTable, ListsEveryLeaf) {
  const MethodOptions options;
  [[maybe_unused]] const auto& [pace, extract, session, self_calibrate, self_calibration, close_loops, keep_pictures,
                                use_saved_extrinsics, motion_limits, wheel_scale_sigma, frame_deadline_ms] = options;
  const std::size_t single = member_count<MethodOptions>() - 4;            // without the groups
  const std::size_t in_session = member_count<SessionOptions>() - 1 - 11;  // without the recording and the groups
  // Those of a monocular start are its unit of length and what the extrinsics determine.
  const std::size_t in_groups =
      members_of<TrackOptions, KeyframeOptions, WindowOptions, LocaliseOptions, LoopOptions, HealthOptions,
                 ImageConditionOptions, StateOptions, DeferredRefinementOptions>() -
      kHiddenCellsAndTags;
  const std::size_t in_mission = member_count<MissionOptions>() - 4 +
                                 members_of<OfflineViewOptions, MovedPointsOptions, RegistrationOptions>() +
                                 member_count<PlaceBoundsOptions>() - 1;  // without the flag for other cameras
  // Without the group and the picture, which map.pictures sets.
  const std::size_t in_extract = member_count<ExtractOptions>() - 2 + member_count<DepthOptions>();
  EXPECT_EQ(option_table().size(), single + in_session + in_groups + in_mission + in_extract +
                                       member_count<SelfCalibrationOptions>() + member_count<MotionLimits>());
}

TEST(OptionTable, IsShort) {
  EXPECT_LT(option_table().size(), 90u);
}

TEST(OptionTable, DescribesEachOptionOnceInItsGroup) {
  std::set<std::string> names;
  std::set<std::string> groups;
  std::string group;
  for (const MethodOption& option : option_table()) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name;
    EXPECT_THAT(option.name, testing::MatchesRegex("([a-z]+\\.)?[a-z_0-9]+"));
    EXPECT_FALSE(option.meaning.empty()) << option.name;
    EXPECT_EQ(option.meaning.find_first_of("()|#\n"), std::string::npos) << option.meaning;
    EXPECT_EQ(option.unit.find_first_of("(),|#\n"), std::string::npos) << option.unit;
    const std::string its_group = option.name.substr(0, option.name.find('.') + 1);
    if (its_group != group) {
      EXPECT_TRUE(groups.insert(its_group).second) << its_group;
    }
    group = its_group;
  }
}

TEST(OptionTable, SetsEachOptionOnly) {
  const std::vector<std::string> before = values({});
  for (std::size_t i = 0; i < option_table().size(); ++i) {
    const MethodOption& option = option_table()[i];
    MethodOptions options;
    for (const std::string& value : some_values(option)) {
      if (option.get(options) == before[i]) option.set(options, value);
    }
    std::vector<std::string> after = values(options);
    EXPECT_NE(after[i], before[i]) << option.name;
    after[i] = before[i];
    EXPECT_EQ(after, before) << option.name;
  }
}

TEST(OptionTable, ReadsItsPrintedValues) {
  for (const MethodOption& option : option_table()) {
    MethodOptions options;
    const std::string value = option.get(options);
    EXPECT_FALSE(set_option(options, option.name, value)) << option.name;
    EXPECT_EQ(option.get(options), value);
  }
}

TEST(OptionTable, RejectsInvalidValuesAndKeepsTheOption) {
  const std::vector<std::string> before = values({});
  for (const MethodOption& option : option_table()) {
    for (const char* const text : {"", "nan", "inf", "-inf", "1e400", "-1", "1e300", "many", "5 m", "yes", "0x10"}) {
      MethodOptions options;
      EXPECT_TRUE(set_option(options, option.name, text)) << option.name << " " << text;
      EXPECT_EQ(values(options), before);
    }
  }
}

TEST(OptionTable, SuggestsTheMostSimilarName) {
  MethodOptions options;
  const auto fault = set_option(options, "tracking.min_inlier", "20");
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->reason, "unknown option 'tracking.min_inlier'");
  EXPECT_EQ(fault->remedy, "did you mean 'tracking.min_inliers'?");
  EXPECT_EQ(set_option(options, "min_inliers", "20")->remedy, "did you mean 'tracking.min_inliers'?");
  EXPECT_EQ(set_option(options, "colour", "red")->remedy, "see docs/reference/options.md");
  EXPECT_THAT(set_option(options, "keyframes.min_frames", "2.5")->remedy, HasSubstr("from 0 to 10000, in frames"));
}

TEST(OptionTable, ListsChangedOptions) {
  MethodOptions options;
  EXPECT_THAT(changed_options(options), testing::IsEmpty());
  options.session.health.sigmas = 2.5;
  options.pace = Pace::live;
  EXPECT_THAT(changed_options(options),
              testing::ElementsAre(testing::Pair("pace", "live"), testing::Pair("health.sigmas", "2.5")));
}

TEST(OptionTable, MappingUsesSharedOptionsOfTheSession) {
  const MappingOptions by_default = mapper_options({}).mapping;
  EXPECT_EQ(by_default.offline_weight, MappingOptions{}.offline_weight);
  MethodOptions options;
  EXPECT_FALSE(set_option(options, "tracking.offline_weight", "7"));
  EXPECT_EQ(mapper_options(options.session).mapping.offline_weight, 7.0);
}

}  // namespace
}  // namespace byre
