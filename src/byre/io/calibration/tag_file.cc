#include "byre/tag_file.h"

#include "byre/features/tag_detector.h"
#include "byre/geometry/degrees.h"
#include "byre/input_error.h"
#include "byre/io/calibration/yaml_mapping.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr std::array kFamilies = {TagFamily::tag36h11, TagFamily::tag25h9, TagFamily::tag_standard41h12};
constexpr double kLargest = 10.0;  // metres, side of a tag
constexpr double kFarthest = 1e6;  // metres, coordinate on a plan

TagFamily family_of(const YAML::Node& node, const std::string& place) {
  const std::string name = node.IsScalar() ? node.Scalar() : "";
  for (const TagFamily family : kFamilies) {
    if (name == to_string(family)) return family;
  }
  throw InputError(place, "is not a family of tags that byre detects", "families: tag36h11, tag25h9, tagStandard41h12");
}

std::optional<SurveyedTag> survey_of(const YAML::Node& fields, const std::string& place) {
  const YAML::Node position = fields["position"];
  if (!position) {
    for (const char* const field : {"heading_deg", "sigma_m"}) {
      if (fields[field]) throw InputError(place + ": " + field, "is given without position");
    }
    return std::nullopt;
  }
  if (!position.IsSequence() || position.size() != 3) {
    throw InputError(place + ": position", "is not a list of three numbers",
                     "give [x, y, z], metres on the floor plan");
  }
  SurveyedTag survey;
  for (int i = 0; i < 3; ++i) {
    survey.position[i] =
        checked_number(position[static_cast<std::size_t>(i)], place + ": position", -kFarthest, kFarthest);
  }
  if (const auto sigma = fields["sigma_m"]) survey.sigma = checked_number(sigma, place + ": sigma_m", 1e-4, 100.0);
  if (const auto heading = fields["heading_deg"]) {
    survey.heading = kDegree * checked_number(heading, place + ": heading_deg", -360.0, 360.0);
  }
  return survey;
}

}  // namespace

std::vector<Tag> read_tags(const fs::path& path) {
  constexpr std::array kFields = {"family", "size", "tags"};
  constexpr std::array kFieldsOfTag = {"id", "family", "size", "position", "heading_deg", "sigma_m"};
  if (!can_detect_tags()) {
    throw InputError(path.string(), "cannot be used: this byre was built without libapriltag",
                     "install libapriltag-dev and build byre again");
  }
  const YAML::Node root = load_yaml_mapping(path);
  require_known_fields(root, kFields, path.string(), "tags");
  const YAML::Node list = root["tags"];
  if (!list || !list.IsSequence() || list.size() == 0) {
    throw InputError(path.string() + ": tags", "is not a list of tags", "give one entry per tag, such as \"- id: 7\"");
  }
  std::vector<Tag> tags;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string place = fmt::format("{}: tags: entry {}", path.string(), i + 1);
    const YAML::Node fields = list[i];
    require_known_fields(fields, kFieldsOfTag, place, "tags");
    const auto given = [&](const char* field) { return fields[field] ? fields[field] : root[field]; };
    Tag tag;
    if (const auto family = given("family")) tag.id.family = family_of(family, place + ": family");
    const int count = count_of(tag.id.family);
    const double id = checked_number(fields["id"], place + ": id", 0.0, count - 1.0);
    tag.id.number = static_cast<int>(id);
    if (tag.id.number != id) throw InputError(place + ": id", "is not a whole number");
    tag.size = checked_number(given("size"), place + ": size", 0.005, kLargest);
    tag.survey = survey_of(fields, place);
    if (std::ranges::count(tags, tag.id, &Tag::id) > 0) throw InputError(place + ": id", "is given twice");
    tags.push_back(tag);
  }
  return tags;
}

}  // namespace byre
