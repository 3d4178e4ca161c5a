// Registration on a floor plan.

#include "byre/map/map_numbers.h"
#include "byre/map/map_sections.h"
#include "byre/map/map_values.h"

namespace byre {

void write_plan(const PlanRegistration& registration, ByteWriter& writer) {
  writer.write_text(registration.plan);
  writer.write(registration.plan_from_map.scale);
  write_pose(registration.plan_from_map.target_from_source, writer);
  write_symmetric(registration.covariance, writer);
}

PlanRegistration read_plan(ByteReader reader) {
  PlanRegistration registration;
  registration.plan = reader.read_text();
  registration.plan_from_map.scale = reader.read<double>();
  registration.plan_from_map.target_from_source = read_pose(reader);
  registration.covariance = read_symmetric<7>(reader);
  if (const auto fault = fault_in(registration); !fault.empty()) reader.fail("the plan " + std::string(fault));
  reader.require_end();
  return registration;
}

}  // namespace byre
