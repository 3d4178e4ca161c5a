#pragma once

#include "byre/trajectory_error.h"

#include <vector>

namespace byre {

// Error of the estimated motion along segments of one length of true path, a metre of it.
struct SegmentError {
  double length = 0.0;       // metres; 0: segments of all lengths together
  double translation = 0.0;  // mean share of the length: 0.01 is one per cent
  double rotation = 0.0;     // mean, degrees a metre
  int count = 0;             // segments
};

struct SegmentErrors {
  SegmentError all;                     // mean over all segments of all lengths, what KITTI's table ranks by
  std::vector<SegmentError> by_length;  // 100, 200, ... 800 m, those that the path is long enough for
};

// As the development kit of KITTI odometry has it (Geiger 2012): a segment begins at every tenth pose, and ends at the
// first pose farther than its length along the true path. The estimate's translations are multiplied by scale first.
// No alignment has a part in it.
SegmentErrors segment_errors(const std::vector<PosePair>& pairs, double scale);

// How far the true positions spread about their mean along their three principal axes: standard deviations in metres,
// the largest first. They are the singular values of the centred positions by the root of their number.
Eigen::Vector3d principal_spread(const std::vector<PosePair>& pairs);

}  // namespace byre
