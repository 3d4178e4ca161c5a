#include "byre/tag_file.h"

#include "byre/geometry/degrees.h"
#include "byre/io/calibration/yaml_file_fixture.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

using TagFile = YamlFileTest<&read_tags>;

TEST_F(TagFile, ReadsCommonAndOwnFields) {
  const auto tags = read(
      "size: 0.16\n"
      "tags:\n"
      "  - id: 3\n"
      "  - {id: 4, family: tag25h9, size: 0.3, position: [1, 2.5, 1.4], heading_deg: 90, sigma_m: 0.1}\n");
  ASSERT_EQ(tags.size(), 2U);
  EXPECT_EQ(tags[0].id, (TagId{TagFamily::tag36h11, 3}));
  EXPECT_DOUBLE_EQ(tags[0].size, 0.16);
  EXPECT_FALSE(tags[0].survey);
  EXPECT_EQ(tags[1].id, (TagId{TagFamily::tag25h9, 4}));
  EXPECT_DOUBLE_EQ(tags[1].size, 0.3);
  ASSERT_TRUE(tags[1].survey);
  EXPECT_EQ(tags[1].survey->position, Eigen::Vector3d(1.0, 2.5, 1.4));
  EXPECT_DOUBLE_EQ(tags[1].survey->heading.value(), 90.0 * kDegree);
  EXPECT_DOUBLE_EQ(tags[1].survey->sigma, 0.1);
}

TEST_F(TagFile, NamesTheFaultyField) {
  const std::string sound = "size: 0.16\ntags:\n  - id: 3\n";
  EXPECT_EQ(fault_of(sound), "");
  EXPECT_THAT(fault_of("tags:\n  - id: 3\n"), HasSubstr("entry 1: size: is missing"));
  EXPECT_THAT(fault_of("size: 0.16\n"), HasSubstr("tags: is not a list of tags"));
  EXPECT_THAT(fault_of(sound + "  - id: 3\n"), HasSubstr("entry 2: id: is given twice"));
  EXPECT_THAT(fault_of(sound + "  - id: 1.5\n"), HasSubstr("is not a whole number"));
  EXPECT_THAT(fault_of(sound + "  - id: 587\n"), HasSubstr("outside 0 to"));
  EXPECT_THAT(fault_of(sound + "  - {id: 4, size: -1}\n"), HasSubstr("size: is -1, outside"));
  EXPECT_THAT(fault_of(sound + "  - {id: 4, family: tag16h5}\n"), HasSubstr("is not a family of tags"));
  EXPECT_THAT(fault_of(sound + "  - {id: 4, position: [1, 2]}\n"), HasSubstr("is not a list of three numbers"));
  EXPECT_THAT(fault_of(sound + "  - {id: 4, heading_deg: 3}\n"), HasSubstr("is given without position"));
  EXPECT_THAT(fault_of(sound + "  - {id: 4, colour: red}\n"), HasSubstr("colour: is not a field of tags"));
  EXPECT_THAT(fault_of("- 1\n"), HasSubstr("is not a YAML mapping"));
}

}  // namespace
}  // namespace byre
