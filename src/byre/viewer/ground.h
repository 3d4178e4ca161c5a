#pragma once

#include "byre/floor_plan.h"
#include "byre/image.h"
#include "byre/map/map_file.h"

#include <memory>
#include <optional>

namespace byre {

// What a map is seen against from above. The ground's frame has x and y on the floor and z up, the height above the
// plane that was driven on; metres, or the map's own unit where that is not known in metres.
struct Ground {
  Similarity ground_from_map;
  bool is_metric = true;
  bool is_level = false;               // a plane was driven on, so that heights above it mean something
  std::optional<FloorPlan> plan;       // plan whose frame is the ground's
  std::shared_ptr<const Image> image;  // plan's image; null without a plan
};

// On the floor plan that the map was registered on, else on the plane fitted to its path, along which x then lies. The
// plan's image is read unless the plan is empty. Throws InputError when that cannot be read. Preconditions: the map
// holds a keyframe, and is registered where a plan is given.
Ground ground_of(const StoredMap& stored, const std::optional<FloorPlan>& plan = {});

}  // namespace byre
