#include "byre/slam/health.h"

namespace byre {

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::trusted:
      return "trusted";
    case Verdict::degraded:
      return "degraded";
    case Verdict::untrusted:
      return "untrusted";
  }
  return "";
}

std::string_view to_string(Doubt doubt) {
  switch (doubt) {
    case Doubt::none:
      return "none";
    case Doubt::no_pose:
      return "no pose";
    case Doubt::blinded:
      return "blinded";
    case Doubt::not_registered:
      return "not registered in the map";
    case Doubt::unconfirmed:
      return "not confirmed yet";
    case Doubt::off_the_map:
      return "far outside the mapped area";
    case Doubt::few_points:
      return "too few points";
    case Doubt::few_offline_points:
      return "too few offline points";
    case Doubt::clustered:
      return "points are clustered";
    case Doubt::uncertain:
      return "pose is uncertain";
    case Doubt::maps_disagree:
      return "offline and online points disagree";
  }
  return "";
}

}  // namespace byre
