#include "byre/simulation/downscaled_camera.h"
#include "byre/simulation/rendered_room.h"

namespace byre {
namespace {

Pose to_pose(const Eigen::Matrix<double, 3, 4>& matrix) {
  return {Eigen::Quaterniond(matrix.leftCols<3>()).normalized(), matrix.col(3)};
}

}  // namespace

Calibration euroc_like_calibration(int divisor) {
  // sensor.yaml of cam0 and cam1 of the Machine Hall and Vicon Room recordings.
  const Camera left{.model = CameraModel::radial_tangential,
                    .width = 752,
                    .height = 480,
                    .fx = 458.654,
                    .fy = 457.296,
                    .cx = 367.215,
                    .cy = 248.375,
                    .distortion = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0}};
  const Camera right{.model = CameraModel::radial_tangential,
                     .width = 752,
                     .height = 480,
                     .fx = 457.587,
                     .fy = 456.134,
                     .cx = 379.999,
                     .cy = 255.238,
                     .distortion = {-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05, 0.0}};
  Eigen::Matrix<double, 3, 4> body_from_left;
  body_from_left << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,  //
      0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,                    //
      -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949;
  Eigen::Matrix<double, 3, 4> body_from_right;
  body_from_right << 0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556,  //
      0.999598781151, 0.0130119051815, 0.0251588363115, 0.0453689425024,                   //
      -0.0253898008918, 0.0179005838253, 0.999517347078, 0.00786212447038;
  return {.left = downscaled_camera(left, divisor),
          .right = StereoPartner{downscaled_camera(right, divisor),
                                 inverse(to_pose(body_from_right)) * to_pose(body_from_left)},
          .body_from_left = to_pose(body_from_left)};
}

}  // namespace byre
