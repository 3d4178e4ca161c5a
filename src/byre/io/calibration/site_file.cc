#include "byre/base/enum_names.h"
#include "byre/input_error.h"
#include "byre/io/calibration/yaml_mapping.h"
#include "byre/site.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr double kFarthest = 1e6;  // metres, coordinate
constexpr std::size_t kMostMaps = 64;
constexpr std::size_t kMostLinks = 1000;
constexpr std::size_t kMostCorners = 1000;

std::string scalar_of(const YAML::Node& node, const std::string& place) {
  const std::string text = node && node.IsScalar() ? node.Scalar() : "";
  if (text.empty()) throw InputError(place, node ? "is not a text" : "is missing");
  return text;
}

YAML::Node entries_of(const YAML::Node& node, const std::string& place, std::size_t fewest, std::size_t most) {
  if (node && node.IsSequence() && node.size() >= fewest && node.size() <= most) return node;
  throw InputError(place, node ? fmt::format("is not a list of {} to {} entries", fewest, most) : "is missing");
}

SiteMap map_of(const YAML::Node& fields, const std::string& place, const fs::path& folder) {
  constexpr std::array kMapFields = {"name", "map", "plan", "height", "building"};
  require_known_fields(fields, kMapFields, place, "maps of a site");
  SiteMap map;
  map.name = scalar_of(fields["name"], place + ": name");
  map.map = folder / scalar_of(fields["map"], place + ": map");
  if (is_site_file(map.map)) throw InputError(place + ": map", "is a YAML file", "give the file of a map");
  if (const auto plan = fields["plan"]) map.plan = folder / scalar_of(plan, place + ": plan");
  if (const auto height = fields["height"])
    map.height = checked_number(height, place + ": height", -kFarthest, kFarthest);
  if (const auto building = fields["building"]) map.building = scalar_of(building, place + ": building");
  return map;
}

LinkKind kind_of(const YAML::Node& node, const std::string& place) {
  const std::string name = scalar_of(node, place);
  for (const LinkKind kind : {LinkKind::gate, LinkKind::stairs, LinkKind::lift}) {
    if (name == to_string(kind)) return kind;
  }
  throw InputError(place, "is not a kind of link", "kinds: gate, stairs, lift");
}

std::size_t index_of(const std::vector<SiteMap>& maps, const YAML::Node& node, const std::string& place) {
  const auto map = std::ranges::find(maps, scalar_of(node, place), &SiteMap::name);
  if (map == maps.end()) throw InputError(place, "is not the name of a map of the site");
  return static_cast<std::size_t>(map - maps.begin());
}

Eigen::Vector2d corner_of(const YAML::Node& node, const std::string& place) {
  entries_of(node, place, 2, 2);
  return {checked_number(node[0], place, -kFarthest, kFarthest), checked_number(node[1], place, -kFarthest, kFarthest)};
}

// A circle on the plan becomes a polygon around it.
void read_circle(const YAML::Node& fields, const std::string& place, SiteLink& link) {
  constexpr int kCorners = 24;
  const std::string where = place + ": centre";
  const YAML::Node centre = entries_of(fields["centre"], where, 2, 3);
  link.radius = checked_number(fields["radius"], place + ": radius", 0.1, 1000.0);
  if (centre.size() == 3) {
    for (int i = 0; i < 3; ++i) {
      link.centre[i] = checked_number(centre[static_cast<std::size_t>(i)], where, -kFarthest, kFarthest);
    }
    return;
  }
  const Eigen::Vector2d middle = corner_of(centre, where);
  const double reach = link.radius / std::cos(std::numbers::pi / kCorners);
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    link.polygon.emplace_back(middle + reach * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
}

SiteLink link_of(const YAML::Node& fields, const std::string& place, const std::vector<SiteMap>& maps) {
  constexpr std::array kLinkFields = {"kind", "from", "to", "polygon", "centre", "radius"};
  require_known_fields(fields, kLinkFields, place, "links");
  SiteLink link;
  link.kind = kind_of(fields["kind"], place + ": kind");
  link.from = index_of(maps, fields["from"], place + ": from");
  link.to = index_of(maps, fields["to"], place + ": to");
  if (link.from == link.to) throw InputError(place + ": to", "is the map that the link begins on");
  if (fields["polygon"].IsDefined() == fields["centre"].IsDefined()) {
    throw InputError(place, "has no region, or two", "give polygon, or centre and radius");
  }
  if (fields["centre"]) {
    read_circle(fields, place, link);
    return link;
  }
  if (fields["radius"]) throw InputError(place + ": radius", "is given without centre");
  for (const YAML::Node& corner : entries_of(fields["polygon"], place + ": polygon", 3, kMostCorners)) {
    link.polygon.push_back(corner_of(corner, place + ": polygon"));
  }
  return link;
}

}  // namespace

std::string_view to_string(LinkKind kind) {
  return name_among<LinkKind::lift>({"gate", "stairs", "lift"}, kind);
}

Site read_site(const fs::path& path) {
  constexpr std::array kFields = {"name", "maps", "links"};
  const YAML::Node root = load_yaml_mapping(path);
  require_known_fields(root, kFields, path.string(), "sites");
  Site site;
  site.name = scalar_of(root["name"], path.string() + ": name");
  const YAML::Node maps = entries_of(root["maps"], path.string() + ": maps", 1, kMostMaps);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const std::string place = fmt::format("{}: maps: entry {}", path.string(), i + 1);
    SiteMap map = map_of(maps[i], place, path.parent_path());
    if (std::ranges::count(site.maps, map.name, &SiteMap::name) > 0) {
      throw InputError(place + ": name", "is given twice", "give each map its own name");
    }
    site.maps.push_back(std::move(map));
  }
  if (!root["links"]) return site;
  const YAML::Node links = entries_of(root["links"], path.string() + ": links", 0, kMostLinks);
  for (std::size_t i = 0; i < links.size(); ++i) {
    site.links.push_back(link_of(links[i], fmt::format("{}: links: entry {}", path.string(), i + 1), site.maps));
  }
  return site;
}

}  // namespace byre
