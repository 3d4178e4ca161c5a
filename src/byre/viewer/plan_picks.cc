#include "byre/viewer/plan_picks.h"

#include "byre/input_error.h"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

constexpr const char* kPlace = "picks";

std::string without_separators(std::string name) {
  std::ranges::replace_if(
      name, [](char character) { return character == ',' || static_cast<unsigned char>(character) < ' '; }, ' ');
  return name;
}

KeyframeId parse_keyframe(const nlohmann::json& number, const MapGraph& map) {
  const KeyframeId id{map.origin(), number.get<std::uint32_t>()};
  if (map.keyframe_header(id) != nullptr) return id;
  throw InputError(kPlace, fmt::format("refer to picture {}, which is not in the map", id.number), "reload the page");
}

Eigen::Vector2d parse_pair(const nlohmann::json& pair, int first = 0) {
  return {pair.at(first).get<double>(), pair.at(first + 1).get<double>()};
}

std::vector<KeyframePixel> parse_pixels(const nlohmann::json& fields, const MapGraph& map) {
  std::vector<KeyframePixel> pixels;
  for (const nlohmann::json& pixel : fields) {
    const KeyframeId id = parse_keyframe(pixel.at(0), map);
    const Rig& rig = rig_of(map, *map.keyframe_header(id));
    const Eigen::Vector2d share = parse_pair(pixel, 1);
    pixels.push_back({id, share.cwiseProduct(Eigen::Vector2d(rig.width, rig.height)).array() - 0.5});
  }
  return pixels;
}

PlanPick parse_pick(const nlohmann::json& fields, const MapGraph& map) {
  PlanPick pick;
  pick.name = without_separators(fields.at("name").get<std::string>());
  pick.point_in_plan = parse_pair(fields.at("plan"));
  if (fields.contains("plan_end")) pick.end_in_plan = parse_pair(fields.at("plan_end"));
  if (fields.contains("station")) {
    pick.station = parse_keyframe(fields.at("station"), map);
  } else if (fields.contains("pixels")) {
    pick.pixels = parse_pixels(fields.at("pixels"), map);
    const bool is_of_one = pick.pixels.size() == 2 && pick.pixels[0].keyframe == pick.pixels[1].keyframe;
    if (pick.pixels.size() < 2 || is_of_one != pick.end_in_plan.has_value()) {
      throw InputError(kPlace, "of " + pick.name + " are neither pixels of two pictures nor a wall in one",
                       "reload the page");
    }
  } else {
    pick.point = PointId{map.origin(), fields.at("point").get<std::uint32_t>()};
    if (map.find_point(*pick.point) == nullptr) {
      throw InputError(kPlace, fmt::format("refer to point {}, which is not in the map", pick.point->number),
                       "reload the page");
    }
  }
  return pick;
}

// parse: callable with the JSON.
template <typename Parse>
auto parsed(const std::string& text, Parse parse) {
  try {
    return parse(nlohmann::json::parse(text));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(kPlace, std::string("have an invalid format: ") + error.what());
  }
}

MapPosition foot_of_wall(const PlanPick& pick, const KeyframePixel& pixel, const MapGraph& map,
                         const DrivingPlane& plane, double body_height) {
  const std::optional<MapPosition> foot = floor_at_pixel(map, pixel, plane, body_height);
  if (!foot) {
    throw InputError(pick.name, "is not on the floor", "click the foot of the wall, nearer to the camera");
  }
  return *foot;
}

// Columns of an image's time and pixel as recorded.
std::string pixel_columns(const KeyframePixel& pixel, const StoredMap& stored) {
  const Keyframe& keyframe = *stored.map.keyframe_header(pixel.keyframe);
  const std::optional<Eigen::Vector2d> recorded = recorded_pixel(stored, keyframe, pixel.pixel);
  if (!recorded) return ",,";
  return fmt::format("{},{:.2f},{:.2f}", keyframe.frame.time.count(), recorded->x(), recorded->y());
}

}  // namespace

std::vector<PlanPick> parse_plan_picks(const std::string& json, const MapGraph& map) {
  return parsed(json, [&map](const nlohmann::json& fields) {
    std::vector<PlanPick> picks;
    for (const nlohmann::json& pick : fields.at("picks")) picks.push_back(parse_pick(pick, map));
    return picks;
  });
}

std::vector<KeyframePixel> parse_picture_pixels(const std::string& json, const MapGraph& map) {
  return parsed(json, [&map](const nlohmann::json& fields) { return parse_pixels(fields.at("pixels"), map); });
}

bool is_about_proposal(const std::string& json) {
  const nlohmann::json fields = nlohmann::json::parse(json, nullptr, false);
  return fields.is_object() && fields.value("proposal", false);
}

double accepted_residual(const std::string& json) {
  const nlohmann::json fields = nlohmann::json::parse(json, nullptr, false);
  const auto found = fields.is_object() ? fields.find("accepted_residual_m") : fields.end();
  return found != fields.end() && found->is_number() ? found->get<double>() : kLargePlanResidual;
}

MapPosition place_of_pixels(const std::string& name, const std::vector<KeyframePixel>& pixels,
                            const StoredMap& stored) {
  const std::optional<TriangulatedPoint> point = triangulate_pixels(stored.map, pixels);
  if (!point) {
    throw InputError(name, "is seen from too similar directions",
                     "click it in a picture that was taken from another side");
  }
  if (!point->is_same_place) {
    throw InputError(name,
                     fmt::format("is not the same place in each picture: the rays miss by {:.1f} sigmas", point->error),
                     "click the same place in each picture");
  }
  return point->position;
}

std::vector<PlanCorrespondence> correspondences_of(const std::vector<PlanPick>& picks, const StoredMap& stored,
                                                   const DrivingPlane& plane, double pick_sigma, double body_height) {
  std::vector<PlanCorrespondence> correspondences;
  for (const PlanPick& pick : picks) {
    if (pick.end_in_plan) {
      const auto foot = [&](int i) { return foot_of_wall(pick, pick.pixels[i], stored.map, plane, body_height); };
      correspondences.push_back(
          wall_correspondence(pick.name, foot(0), foot(1), pick.point_in_plan, *pick.end_in_plan, pick_sigma));
      continue;
    }
    MapPosition place;
    if (pick.point) place = *position_of_point(stored, *pick.point);
    if (pick.station) place.point_in_map = body_at(stored.map, *stored.map.find_keyframe(*pick.station));
    if (!pick.pixels.empty()) place = place_of_pixels(pick.name, pick.pixels, stored);
    correspondences.push_back(correspondence(pick.name, place, pick.point_in_plan, pick_sigma));
  }
  return correspondences;
}

std::string picks_csv(const std::vector<PlanPick>& picks, const StoredMap& stored) {
  std::string text =
      "name,point,time_s,time_ns,u_px,v_px,u_end_px,v_end_px,plan_x_m,plan_y_m,plan_end_x_m,plan_end_y_m\n";
  for (const PlanPick& pick : picks) {
    const auto seconds = [&] {
      const std::int64_t time = stored.map.keyframe_header(*pick.station)->frame.time.count();
      return fmt::format("{}.{:09}", time / 1'000'000'000, time % 1'000'000'000);
    };
    const std::string pixel = pick.pixels.empty() ? ",," : pixel_columns(pick.pixels[0], stored);
    std::string end = ",";
    if (pick.end_in_plan) {
      const std::string columns = pixel_columns(pick.pixels[1], stored);
      end = columns.substr(columns.find(',') + 1);
    }
    text += fmt::format(
        "{},{},{},{},{},{:.4f},{:.4f},{}\n", pick.name, pick.point ? std::to_string(pick.point->number) : "",
        pick.station ? seconds() : "", pixel, end, pick.point_in_plan.x(), pick.point_in_plan.y(),
        pick.end_in_plan ? fmt::format("{:.4f},{:.4f}", pick.end_in_plan->x(), pick.end_in_plan->y()) : ",");
    for (std::size_t i = 1; i < pick.pixels.size() && !pick.end_in_plan; ++i) {
      text += fmt::format(",,,{},,,,,,\n", pixel_columns(pick.pixels[i], stored));
    }
  }
  return text;
}

}  // namespace byre
