#include "byre/io/calibration/yaml_file_fixture.h"
#include "byre/site.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

using SiteFile = YamlFileTest<&read_site>;

const std::string kMaps =
    "name: farm\n"
    "maps:\n"
    "  - {name: barn, map: barn.byre, plan: barn.yaml, height: 0.5, building: old barn}\n"
    "  - {name: loft, map: loft.byre}\n";

TEST_F(SiteFile, ReadsMapsAndLinks) {
  const Site site = read(kMaps +
                         "links:\n"
                         "  - {kind: lift, from: barn, to: loft, centre: [1, 2, 3], radius: 1.5}\n"
                         "  - {kind: gate, from: loft, to: barn, polygon: [[0, 0], [4, 0], [4, 2]]}\n"
                         "  - {kind: stairs, from: loft, to: barn, centre: [1, 2], radius: 2}\n");
  EXPECT_EQ(site.name, "farm");
  ASSERT_EQ(site.maps.size(), 2U);
  EXPECT_EQ(site.maps[0].map, path_.parent_path() / "barn.byre");
  EXPECT_EQ(site.maps[0].plan, path_.parent_path() / "barn.yaml");
  EXPECT_EQ(site.maps[0].height, 0.5);
  EXPECT_EQ(site.maps[0].building, "old barn");
  EXPECT_FALSE(site.maps[1].plan);
  ASSERT_EQ(site.links.size(), 3U);
  EXPECT_EQ(site.links[0].kind, LinkKind::lift);
  EXPECT_EQ(site.links[0].from, 0U);
  EXPECT_EQ(site.links[0].to, 1U);
  EXPECT_TRUE(site.links[0].polygon.empty());
  EXPECT_EQ(site.links[0].centre, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(site.links[1].polygon.size(), 3U);
  for (const Eigen::Vector2d& corner : site.links[2].polygon) {
    EXPECT_NEAR((corner - Eigen::Vector2d(1.0, 2.0)).norm(), 2.0, 0.02);
  }
}

TEST_F(SiteFile, NamesTheFaultyField) {
  EXPECT_EQ(fault_of(kMaps), "");
  EXPECT_THAT(fault_of("maps: []\n"), HasSubstr("name: is missing"));
  EXPECT_THAT(fault_of("name: farm\nmaps: []\n"), HasSubstr("maps: is not a list of 1 to 64 entries"));
  EXPECT_THAT(fault_of("name: farm\nmaps: [7]\n"), HasSubstr("entry 1: is not a YAML mapping"));
  EXPECT_THAT(fault_of("name: farm\nmaps: [{name: a}]\n"), HasSubstr("entry 1: map: is missing"));
  EXPECT_THAT(fault_of("name: farm\nmaps: [{name: a, map: b.yaml}]\n"), HasSubstr("map: is a YAML file"));
  EXPECT_THAT(fault_of(kMaps + "  - {name: loft, map: x.byre}\n"), HasSubstr("entry 3: name: is given twice"));
  EXPECT_THAT(fault_of(kMaps + "floors: 2\n"), HasSubstr("floors: is not a field of sites"));
  const auto fault_of_link = [this](const std::string& link) {
    return fault_of(kMaps + "links:\n  - {kind: gate, from: barn, to: loft" + link + "}\n");
  };
  EXPECT_EQ(fault_of_link(", centre: [0, 0], radius: 1"), "");
  EXPECT_THAT(fault_of_link(""), HasSubstr("entry 1: has no region, or two"));
  EXPECT_THAT(fault_of_link(", centre: [0, 0]"), HasSubstr("radius: is missing"));
  EXPECT_THAT(fault_of_link(", centre: [0], radius: 1"), HasSubstr("is not a list of 2 to 3"));
  EXPECT_THAT(fault_of_link(", centre: [0, .nan], radius: 1"), HasSubstr("centre: is not a number"));
  EXPECT_THAT(fault_of_link(", polygon: [[0, 0], [1, 0]]"), HasSubstr("is not a list of 3 to 1000"));
  EXPECT_THAT(fault_of_link(", polygon: [[0, 0], [1, 0], [1, 1]], radius: 1"), HasSubstr("is given without centre"));
  EXPECT_THAT(fault_of_link(", colour: red"), HasSubstr("colour: is not a field of links"));
  const auto fault_of_ends = [this](const std::string& ends) {
    return fault_of(kMaps + "links:\n  - {" + ends + ", centre: [0, 0], radius: 1}\n");
  };
  EXPECT_THAT(fault_of_ends("kind: gate, from: barn, to: barn"), HasSubstr("is the map that the link begins on"));
  EXPECT_THAT(fault_of_ends("kind: gate, from: barn, to: cellar"), HasSubstr("to: is not the name of a map"));
  EXPECT_THAT(fault_of_ends("kind: rope, from: barn, to: loft"), HasSubstr("kind: is not a kind of link"));
}

}  // namespace
}  // namespace byre
