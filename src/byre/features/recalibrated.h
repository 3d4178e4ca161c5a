#pragma once

#include "byre/features.h"
#include "byre/geometry/rectified_change.h"

namespace byre {

// Features as they would be, had their images been rectified by another calibration; in the same order.
Features recalibrated(const Features& features, const RectifiedChange& change);
// The same; refills `result`.
void recalibrate_into(const Features& features, const RectifiedChange& change, Features& result);

// Where a refined left pixel lies after the change.
Eigen::Vector2f recalibrated(const Eigen::Vector2f& pixel, const RectifiedChange& change);

}  // namespace byre
