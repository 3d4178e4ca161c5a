#pragma once

#include "byre/pose.h"

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

namespace byre {

// Families of AprilTags (Olson 2011; Krogius 2019).
enum class TagFamily : std::uint8_t { tag36h11, tag25h9, tag_standard41h12 };

std::string_view to_string(TagFamily family);

struct TagId {
  TagFamily family = TagFamily::tag36h11;
  int number = 0;
  auto operator<=>(const TagId&) const = default;
};

std::string to_string(const TagId& id);  // such as "tag36h11 7"

// Surveyed place of a tag on the floor plan. heading: direction that an upright tag on a wall faces, radians to the
// left of the plan's x.
struct SurveyedTag {
  Eigen::Vector3d position;  // centre, metres; z above the floor
  double sigma = 0.02;       // standard deviation of each coordinate, metres
  std::optional<double> heading{};
};

// A printed tag. Its frame: origin in the centre, x right and y down as seen from the front, z into the wall.
struct Tag {
  TagId id;
  double size = 0.0;                    // side of the square between the detected corners, metres
  std::optional<SurveyedTag> survey{};  // empty: not surveyed
};

// Pose of a tag in a map.
struct MappedTag {
  TagId id;
  double size = 0.0;  // see Tag, lengths of the map
  Pose map_from_tag{};
  double sigma = 0.0;  // standard deviation of each coordinate of its position, lengths of the map
};

// Corners of a tag in the left rectified image, pixels: (-,-), (+,-), (+,+), (-,+) of the tag's x and y.
struct TagSighting {
  TagId id;
  std::array<Eigen::Vector2d, 4> corners;
};

}  // namespace byre
