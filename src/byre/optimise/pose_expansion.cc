#include "byre/optimise/pose_expansion.h"

#include "byre/optimise/robust_error.h"

// The vectorised part of this file is compiled once per instruction set, except for those without arrays of vectors.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "byre/optimise/pose_expansion.cc"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

#ifndef BYRE_OPTIMISE_POSE_EXPANSION_CC_
#define BYRE_OPTIMISE_POSE_EXPANSION_CC_

namespace byre {
namespace {

// Camera parameters and constants of the loss.
struct View {
  std::array<double, 9> rotation;  // camera_from_world, row by row
  std::array<double, 3> translation;
  double focal, cx, cy, baseline;
  double huber_width;
  double cost_behind;  // cost of a point at or behind the camera
};

// Sums per lane, in an order independent of the vector width. Symmetric matrices as xx, xy, xz, yy, yz, zz.
struct Sums {
  using Lanes = WeightedPoints::Lanes;

  Lanes cost{};
  std::array<Lanes, 6> translation{};  // normal matrix
  std::array<Lanes, 9> mixed{};        // row by row: rows of the rotation, columns of the translation
  std::array<Lanes, 6> rotation{};
  std::array<Lanes, 6> descent{};
};

}  // namespace
}  // namespace byre

#endif  // BYRE_OPTIMISE_POSE_EXPANSION_CC_

HWY_BEFORE_NAMESPACE();
namespace byre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, WeightedPoints::kLanes>;
using V = hn::Vec<D>;

// Expansion of the cost in the position of the points in the camera.
struct ByPoint {
  V x, y, z;  // in the camera
  V xx, xy, xz, yy, yz, zz;
  V down_x, down_y, down_z;
};

HWY_INLINE void add_to(WeightedPoints::Lanes& sum, std::size_t lane, V term) {
  const D d;
  hn::StoreU(hn::LoadU(d, sum.data() + lane) + term, d, sum.data() + lane);
}

// Adds the expansion in the pose: the points move by translation + rotation x point.
HWY_INLINE void add_by_pose(const ByPoint& p, std::size_t lane, Sums& sums) {
  const V m00 = p.y * p.xz - p.z * p.xy, m01 = p.y * p.yz - p.z * p.yy, m02 = p.y * p.zz - p.z * p.yz;
  const V m10 = p.z * p.xx - p.x * p.xz, m11 = p.z * p.xy - p.x * p.yz, m12 = p.z * p.xz - p.x * p.zz;
  const V m20 = p.x * p.xy - p.y * p.xx, m21 = p.x * p.yy - p.y * p.xy, m22 = p.x * p.yz - p.y * p.xz;
  const V translation[] = {p.xx, p.xy, p.xz, p.yy, p.yz, p.zz};
  const V mixed[] = {m00, m01, m02, m10, m11, m12, m20, m21, m22};
  const V rotation[] = {p.y * m02 - p.z * m01, p.z * m00 - p.x * m02, p.x * m01 - p.y * m00,
                        p.z * m10 - p.x * m12, p.x * m11 - p.y * m10, p.x * m21 - p.y * m20};
  const V descent[] = {p.down_x,
                       p.down_y,
                       p.down_z,
                       p.y * p.down_z - p.z * p.down_y,
                       p.z * p.down_x - p.x * p.down_z,
                       p.x * p.down_y - p.y * p.down_x};
  for (std::size_t i = 0; i < 6; ++i) add_to(sums.translation[i], lane, translation[i]);
  for (std::size_t i = 0; i < 9; ++i) add_to(sums.mixed[i], lane, mixed[i]);
  for (std::size_t i = 0; i < 6; ++i) add_to(sums.rotation[i], lane, rotation[i]);
  for (std::size_t i = 0; i < 6; ++i) add_to(sums.descent[i], lane, descent[i]);
}

// Adds one vector of points of a block, from the given lane on.
HWY_INLINE void add_points(const WeightedPoints::Block& block, std::size_t lane, const View& view, Sums& sums) {
  const D d;
  const auto of = [&](const WeightedPoints::Lanes& lanes) { return hn::LoadU(d, lanes.data() + lane); };
  const auto all = [&](double value) { return hn::Set(d, value); };
  const V world_x = of(block.x), world_y = of(block.y), world_z = of(block.z);
  const auto in_camera = [&](std::size_t row) {
    const double* const r = view.rotation.data() + 3 * row;
    return all(r[0]) * world_x + all(r[1]) * world_y + all(r[2]) * world_z + all(view.translation[row]);
  };
  ByPoint p{in_camera(0), in_camera(1), in_camera(2), {}, {}, {}, {}, {}, {}, {}, {}, {}};
  const auto is_before = hn::Gt(p.z, hn::Zero(d));
  const V weight = hn::IfThenElseZero(is_before, of(block.weight));
  add_to(sums.cost, lane, hn::IfThenZeroElse(is_before, of(block.weight) * all(view.cost_behind)));
  p.z = hn::IfThenElse(is_before, p.z, all(1.0));
  // Projection, its error, and its derivatives: by x and y (equal), and by z.
  const V inverse = all(1.0) / p.z;
  const V by_side = all(view.focal) * inverse;
  const V u = by_side * p.x, v = by_side * p.y, disparity = by_side * all(view.baseline);
  const V error_u = of(block.u) - (u + all(view.cx)), error_v = of(block.v) - (v + all(view.cy));
  const V error_d = of(block.disparity) - disparity;
  const V u_by_z = hn::Neg(u * inverse), v_by_z = hn::Neg(v * inverse), d_by_z = hn::Neg(disparity * inverse);
  // Information times the error, and times the derivative by z.
  const V uu = of(block.uu), uv = of(block.uv), ud = of(block.ud), vv = of(block.vv), vd = of(block.vd),
          dd = of(block.dd);
  const V pull_u = uu * error_u + uv * error_v + ud * error_d, u_of_z = uu * u_by_z + uv * v_by_z + ud * d_by_z;
  const V pull_v = uv * error_u + vv * error_v + vd * error_d, v_of_z = uv * u_by_z + vv * v_by_z + vd * d_by_z;
  const V pull_d = ud * error_u + vd * error_v + dd * error_d, d_of_z = ud * u_by_z + vd * v_by_z + dd * d_by_z;
  // Huber loss.
  const V squared_error = error_u * pull_u + error_v * pull_v + error_d * pull_d;
  const V length = hn::Sqrt(hn::Max(squared_error, hn::Zero(d)));
  const V width = all(view.huber_width);
  const V within = hn::Min(length, width);
  add_to(sums.cost, lane, weight * within * (length + length - within));
  const V gain = weight * width / hn::Max(length, width);
  const V side = gain * by_side;
  p.xx = side * by_side * uu;
  p.xy = side * by_side * uv;
  p.yy = side * by_side * vv;
  p.xz = side * u_of_z;
  p.yz = side * v_of_z;
  p.zz = gain * (u_by_z * u_of_z + v_by_z * v_of_z + d_by_z * d_of_z);
  p.down_x = side * pull_u;
  p.down_y = side * pull_v;
  p.down_z = gain * (u_by_z * pull_u + v_by_z * pull_v + d_by_z * pull_d);
  add_by_pose(p, lane, sums);
}

void add_blocks(const WeightedPoints::Block* blocks, std::size_t count, const View& view, Sums& sums) {
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t lane = 0; lane < WeightedPoints::kLanes; lane += hn::Lanes(D())) {
      add_points(blocks[i], lane, view, sums);
    }
  }
}

}  // namespace
}  // namespace byre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace byre {
namespace {

HWY_EXPORT(add_blocks);

double sum_of(const WeightedPoints::Lanes& lanes) {
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

Eigen::Matrix3d sum_of(const std::array<WeightedPoints::Lanes, 6>& upper) {
  Eigen::Matrix3d sum;
  sum << sum_of(upper[0]), sum_of(upper[1]), sum_of(upper[2]),  //
      sum_of(upper[1]), sum_of(upper[3]), sum_of(upper[4]),     //
      sum_of(upper[2]), sum_of(upper[4]), sum_of(upper[5]);
  return sum;
}

PoseExpansion expansion_of(const Sums& sums) {
  PoseExpansion expansion;
  expansion.cost = sum_of(sums.cost);
  Eigen::Matrix3d mixed;
  for (int i = 0; i < 9; ++i) mixed(i / 3, i % 3) = sum_of(sums.mixed[static_cast<std::size_t>(i)]);
  expansion.normal_matrix << sum_of(sums.translation), mixed.transpose(), mixed, sum_of(sums.rotation);
  for (int i = 0; i < 6; ++i) expansion.descent[i] = sum_of(sums.descent[static_cast<std::size_t>(i)]);
  return expansion;
}

}  // namespace

PoseExpansion& PoseExpansion::operator+=(const PoseExpansion& other) {
  cost += other.cost;
  normal_matrix += other.normal_matrix;
  descent += other.descent;
  return *this;
}

void WeightedPoints::clear() {
  blocks_.clear();
  size_ = 0;
}

void WeightedPoints::add(const WeightedPoint& point) {
  const std::size_t lane = size_++ % kLanes;
  if (lane == 0) blocks_.emplace_back();
  Block& block = blocks_.back();
  block.x[lane] = point.point_in_world.x();
  block.y[lane] = point.point_in_world.y();
  block.z[lane] = point.point_in_world.z();
  block.u[lane] = point.measured.x();
  block.v[lane] = point.measured.y();
  block.disparity[lane] = point.measured.z();
  block.uu[lane] = point.information(0, 0);
  block.uv[lane] = point.information(0, 1);
  block.ud[lane] = point.information(0, 2);
  block.vv[lane] = point.information(1, 1);
  block.vd[lane] = point.information(1, 2);
  block.dd[lane] = point.information(2, 2);
  block.weight[lane] = point.weight;
}

void WeightedPoints::square_weights() {
  for (Block& block : blocks_) {
    for (double& weight : block.weight) weight *= weight;
  }
}

PoseExpansion WeightedPoints::expand(const Rig& rig, const Pose& camera_from_world, double huber_width) const {
  constexpr double kSquaredErrorBehind = 1e4;  // cost of a point that a step moves behind the camera
  View view{{}, {}, rig.focal, rig.cx, rig.cy, rig.baseline, huber_width, huber_cost(kSquaredErrorBehind, huber_width)};
  const Eigen::Matrix3d rotation = camera_from_world.rotation.toRotationMatrix();
  for (int i = 0; i < 9; ++i) view.rotation[static_cast<std::size_t>(i)] = rotation(i / 3, i % 3);
  for (int i = 0; i < 3; ++i) view.translation[static_cast<std::size_t>(i)] = camera_from_world.translation[i];
  Sums sums;
  HWY_DYNAMIC_DISPATCH(add_blocks)(blocks_.data(), blocks_.size(), view, sums);
  return expansion_of(sums);
}

}  // namespace byre

#endif
