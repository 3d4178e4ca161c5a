#include "byre/odometry/visual_motion.h"

#include <algorithm>

namespace byre {

double disagreement(const Pose& measured, const VisualMotion& seen, double metres_per_unit) {
  constexpr double kMetres = 0.03;
  constexpr double kRadians = 0.03;
  constexpr double kShare = 0.2;
  const double way = metres_per_unit * std::max(measured.translation.norm(), seen.body.translation.norm());
  const double turn = std::max(rotation_log(measured.rotation).norm(), rotation_log(seen.body.rotation).norm());
  const double translation_error = metres_per_unit * (measured.translation - seen.body.translation).norm();
  const double rotation_error = angle_between(measured.rotation, seen.body.rotation);
  return std::max(translation_error / (kMetres + kShare * (way + 0.2 * turn)),
                  rotation_error / (kRadians + kShare * turn));
}

}  // namespace byre
