#include "byre/viewer/plan_picks.h"

#include "byre/input_error.h"
#include "byre/map/plan/plan_places.h"

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

PlanPick parse_pick(const nlohmann::json& fields, const MapGraph& map) {
  PlanPick pick;
  pick.name = without_separators(fields.at("name").get<std::string>());
  pick.point = fields.at("point").get<std::uint32_t>();
  pick.point_in_plan = {fields.at("plan").at(0).get<double>(), fields.at("plan").at(1).get<double>()};
  if (map.find_point({map.origin(), pick.point}) == nullptr) {
    throw InputError(kPlace, "refer to point " + std::to_string(pick.point) + ", which is not in the map",
                     "reload the page");
  }
  return pick;
}

}  // namespace

std::vector<PlanPick> parse_plan_picks(const std::string& json, const MapGraph& map) {
  try {
    const nlohmann::json fields = nlohmann::json::parse(json);
    std::vector<PlanPick> picks;
    for (const nlohmann::json& pick : fields.at("picks")) picks.push_back(parse_pick(pick, map));
    return picks;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(kPlace, std::string("have an invalid format: ") + error.what());
  }
}

double accepted_residual(const std::string& json) {
  const nlohmann::json fields = nlohmann::json::parse(json, nullptr, false);
  const auto found = fields.is_object() ? fields.find("accepted_residual_m") : fields.end();
  return found != fields.end() && found->is_number() ? found->get<double>() : kLargePlanResidual;
}

std::vector<PlanCorrespondence> correspondences_of(const std::vector<PlanPick>& picks, const StoredMap& stored,
                                                   double pick_sigma) {
  std::vector<PlanCorrespondence> correspondences;
  for (const PlanPick& pick : picks) {
    const MapPosition place = *position_of_point(stored, {stored.map.origin(), pick.point});
    correspondences.push_back(correspondence(pick.name, place, pick.point_in_plan, pick_sigma));
  }
  return correspondences;
}

std::string picks_csv(const std::vector<PlanPick>& picks) {
  std::string text = "name,point,plan_x_m,plan_y_m\n";
  for (const PlanPick& pick : picks) {
    text += pick.name;
    text += fmt::format(",{},{:.4f},{:.4f}\n", pick.point, pick.point_in_plan.x(), pick.point_in_plan.y());
  }
  return text;
}

}  // namespace byre
