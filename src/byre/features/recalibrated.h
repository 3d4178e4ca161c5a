#pragma once

#include "byre/features.h"
#include "byre/geometry/rectified_change.h"

namespace byre {

// Features moved as if their images had been rectified with another calibration; in the same order.
Features recalibrated(const Features& features, const RectifiedChange& change);
// Same, refills `result`.
void recalibrate_into(const Features& features, const RectifiedChange& change, Features& result);

// Corners of tags, moved likewise.
void recalibrate_tags(std::vector<TagSighting>& tags, const RectifiedChange& change);

// Position of a refined left pixel after the change.
Eigen::Vector2f recalibrated(const Eigen::Vector2f& pixel, const RectifiedChange& change);

}  // namespace byre
