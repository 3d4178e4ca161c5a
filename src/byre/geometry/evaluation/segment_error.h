#pragma once

#include "byre/trajectory_error.h"

#include <vector>

namespace byre {

// Mean error of estimated motion over segments of one path length.
struct SegmentError {
  double length = 0.0;       // metres; 0: all lengths together
  double translation = 0.0;  // relative to the length: 0.01 is one per cent
  double rotation = 0.0;     // degrees per metre
  int count = 0;
};

struct SegmentErrors {
  SegmentError all;                     // mean over segments of all lengths, by which KITTI ranks
  std::vector<SegmentError> by_length;  // 100, 200, ... 800 m, as far as the path reaches
};

// Segment errors of the KITTI odometry development kit (Geiger 2012): a segment begins at every tenth pose and ends at
// the first pose beyond its length along the true path. The estimate's translations are multiplied by scale first. No
// alignment is applied.
SegmentErrors segment_errors(const std::vector<PosePair>& pairs, double scale);

// Standard deviations of the true positions along their three principal axes, metres, largest first: singular values of
// the centred positions, divided by the square root of their number.
Eigen::Vector3d principal_spread(const std::vector<PosePair>& pairs);

}  // namespace byre
