// AprilTags from images to a map and to missions on it.

#include "byre/cli/shared/program_fixture.h"
#include "byre/features/tag_detector.h"
#include "byre/map/map_file.h"
#include "byre/map/mapped_tag.h"
#include "byre/tag_file.h"

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

// Two visits to a barn with tags. In the second one, other tags hang at their places.
class TagsProgram : public ProgramTest {
 protected:
  void SetUp() override {
    if (!can_detect_tags()) GTEST_SKIP() << "built without libapriltag";
  }

  void simulate(const std::string& options, const std::string& folder) const {
    const Outcome outcome = run("simulate cowshed --duration 40 --rate 1.5 --divide 2 --time day --tags 12 " + options +
                                " --quiet -o " + folder);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  }

  // Maps the first visit with this file of tags.
  std::vector<MappedTag> map_with(const std::string& tags) {
    mapped_ = run("map first --tags " + tags + " --quiet -o barn.byre");
    EXPECT_EQ(mapped_.exit_code, 0) << mapped_.errors;
    return stored_tags(load_map(folder_ / "barn.byre").notes);
  }

  Outcome mapped_;
};

TEST_F(TagsProgram, MapsTagsAndReportsWrongSizesAndMovedTags) {
  simulate("", "first");
  const std::vector<Tag> hung = read_tags(folder_ / "first" / "plan" / "tags.yaml");
  EXPECT_THAT(hung, SizeIs(12));
  const std::vector<MappedTag> tags = map_with("first/plan/tags.yaml");
  EXPECT_THAT(mapped_.output, AllOf(HasSubstr("AprilTags in the map"), Not(HasSubstr("instead of"))));
  ASSERT_GE(tags.size(), 2U);
  // Distances, as the map of these small images is turned by a degree.
  const auto true_position = [&hung](const MappedTag& tag) {
    return std::ranges::find(hung, tag.id, &Tag::id)->survey->position;
  };
  for (const MappedTag& tag : tags) {
    const double distance = (tag.map_from_tag.translation - tags[0].map_from_tag.translation).norm();
    EXPECT_NEAR(distance, (true_position(tag) - true_position(tags[0])).norm(), 0.05) << to_string(tag.id);
  }

  simulate("--mission 2 --gate closed --start 0 --first-tag 2", "second");
  const Outcome moved =
      run("run second --map barn.byre --quiet --events events.jsonl --truth second --map-truth first");
  ASSERT_EQ(moved.exit_code, 0) << moved.errors;
  EXPECT_THAT(moved.output,
              AllOf(HasSubstr("wrong trust  0 trusted frames"), HasSubstr("m from its place in the map")));
  EXPECT_THAT(read("events.jsonl"), AllOf(HasSubstr("\"localised\""), HasSubstr("\"tag moved\"")));

  const std::string all = read("first/plan/tags.yaml");
  const std::string number = std::to_string(tags.back().id.number);
  const auto line = all.find("id: " + number + ",");
  ASSERT_NE(line, std::string::npos);
  std::string wrong = all;
  wrong.replace(wrong.find("0.450000", line), 8, "0.200000");
  write("wrong.yaml", wrong);
  EXPECT_THAT(map_with("wrong.yaml"), SizeIs(tags.size() - 1));
  EXPECT_THAT(mapped_.output, AllOf(HasSubstr("tag36h11 " + number + " measures 0.4"), HasSubstr("instead of 0.2 m")));
}

}  // namespace
}  // namespace byre::cli
