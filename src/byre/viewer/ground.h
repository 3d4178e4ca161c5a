#pragma once

#include "byre/floor_plan.h"
#include "byre/image.h"
#include "byre/map/map_file.h"

#include <memory>
#include <optional>

namespace byre {

// Ground frame of plan pictures: x and y on the floor, z up, height zero on the plane driven on. Metres, or map units
// for a map without metric scale.
struct Ground {
  Similarity ground_from_map;
  bool is_metric = true;
  bool is_level = false;               // a driving plane was fitted, so heights are meaningful
  std::optional<FloorPlan> plan;       // plan whose frame is the ground frame
  std::shared_ptr<const Image> image;  // image of the plan; null without a plan
};

// Ground of a registered map's floor plan, else the driving plane, with x along the path. Reads the plan's image.
// Throws InputError if that fails. Preconditions: the map has a keyframe, and is registered if a plan is given.
Ground ground_of(const StoredMap& stored, const std::optional<FloorPlan>& plan = {});

}  // namespace byre
