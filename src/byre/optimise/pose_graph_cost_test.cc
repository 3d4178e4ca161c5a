#include "byre/optimise/pose_graph_cost.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/optimise/optimise_scene.h"
#include "byre/optimise/rotation_manifold.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace byre {
namespace {

using Vector14 = Eigen::Matrix<double, 14, 1>;
using Jacobian14 =
    Eigen::Matrix<double, 7, 14>;  // columns: rotation, position and log scale of the first node, then of the second

// A node's parameter blocks.
struct Node {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d position_in_world;
  double log_scale;
};

struct Nodes {
  Node first;
  Node second;

  std::array<const double*, 6> blocks() const {
    return {first.rotation.coeffs().data(),  first.position_in_world.data(),  &first.log_scale,
            second.rotation.coeffs().data(), second.position_in_world.data(), &second.log_scale};
  }
};

Node random_node(Draw& draw) {
  return {rotation_exp(draw.normal3(1.0)), draw.normal3(3.0), draw.normal(0.3)};
}

Node moved(const Node& node, const Vector7& delta) {
  Node result = node;
  RotationManifold().Plus(node.rotation.coeffs().data(), delta.data(), result.rotation.coeffs().data());
  result.position_in_world += delta.segment<3>(3);
  result.log_scale += delta[6];
  return result;
}

Nodes moved(const Nodes& nodes, const Vector14& delta) {
  return {moved(nodes.first, delta.head<7>()), moved(nodes.second, delta.tail<7>())};
}

Vector7 error_at(const PoseGraphCost& cost, const Nodes& nodes) {
  Vector7 error;
  EXPECT_TRUE(cost.Evaluate(nodes.blocks().data(), error.data(), nullptr));
  return error;
}

// Central differences.
Jacobian14 numeric_jacobian(const PoseGraphCost& cost, const Nodes& at) {
  constexpr double kStep = 1e-6;
  Jacobian14 jacobian;
  for (int i = 0; i < 14; ++i) {
    const Vector14 step = kStep * Vector14::Unit(i);
    jacobian.col(i) = (error_at(cost, moved(at, step)) - error_at(cost, moved(at, -step))) / (2.0 * kStep);
  }
  return jacobian;
}

Jacobian14 analytic_jacobian(const PoseGraphCost& cost, const Nodes& at) {
  std::array<Eigen::Matrix<double, 7, 4, Eigen::RowMajor>, 2> by_rotation;
  std::array<Eigen::Matrix<double, 7, 3, Eigen::RowMajor>, 2> by_position;
  std::array<Vector7, 2> by_scale;
  std::array<double*, 6> blocks{by_rotation[0].data(), by_position[0].data(), by_scale[0].data(),
                                by_rotation[1].data(), by_position[1].data(), by_scale[1].data()};
  Vector7 error;
  EXPECT_TRUE(cost.Evaluate(at.blocks().data(), error.data(), blocks.data()));
  Jacobian14 jacobian;
  jacobian << by_rotation[0].leftCols<3>(), by_position[0], by_scale[0], by_rotation[1].leftCols<3>(), by_position[1],
      by_scale[1];
  EXPECT_EQ(by_rotation[0].col(3).norm() + by_rotation[1].col(3).norm(), 0.0);
  return jacobian;
}

Matrix6 random_information(Draw& draw) {
  Matrix6 root;
  for (int i = 0; i < 6; ++i) root.col(i) = draw.motion(1.0, 2.0);
  return root * root.transpose();
}

// The measurement that an edge without error has.
PoseGraphEdge predicted_edge(const Nodes& nodes) {
  const auto camera_from_world = [](const Node& node) {
    return Pose{node.rotation, -(node.rotation * node.position_in_world)};
  };
  PoseGraphEdge edge{.first = 0,
                     .second = 1,
                     .second_from_first = camera_from_world(nodes.second) * inverse(camera_from_world(nodes.first)),
                     .scale = std::exp(nodes.second.log_scale - nodes.first.log_scale)};
  edge.second_from_first.translation *= std::exp(nodes.second.log_scale);
  return edge;
}

// An edge with the given rotation error, and random values elsewhere.
class PoseGraphCostTest : public testing::TestWithParam<double> {
 protected:
  PoseGraphCostTest() {
    edge_ = predicted_edge(nodes_);
    Vector6 delta = draw_.motion(0.5, 0.0);
    delta.tail<3>() = GetParam() * Eigen::Vector3d(2.0, -1.0, 2.0) / 3.0;
    edge_.second_from_first = exp_pose(delta) * edge_.second_from_first;
    edge_.scale *= 1.1;
    edge_.scale_sigma = 0.2;
    edge_.information = random_information(draw_);
  }

  Draw draw_{3};
  Nodes nodes_{random_node(draw_), random_node(draw_)};
  PoseGraphEdge edge_;
};

TEST_P(PoseGraphCostTest, HasTheNumericJacobian) {
  for (const bool is_in_world_lengths : {false, true}) {
    edge_.is_in_world_lengths = is_in_world_lengths;
    for (const bool constrains_scale : {false, true}) {
      const PoseGraphCost cost(edge_, constrains_scale);
      const Jacobian14 analytic = analytic_jacobian(cost, nodes_);
      const Jacobian14 numeric = numeric_jacobian(cost, nodes_);
      EXPECT_LT((analytic - numeric).norm(), 1e-7 * (1.0 + numeric.norm())) << "analytic:\n"
                                                                            << analytic << "\nnumeric:\n"
                                                                            << numeric;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Turn, PoseGraphCostTest, testing::Values(0.0, 1e-5, 5e-4, 2e-3, 0.1, 1.0, 2.0, 3.0));

TEST(PoseGraphCost, IsZeroIfPredictionAndMeasurementAgree) {
  Draw draw(4);
  for (int i = 0; i < 20; ++i) {
    const Nodes nodes{random_node(draw), random_node(draw)};
    EXPECT_LT(error_at({predicted_edge(nodes), true}, nodes).norm(), 1e-11);
  }
}

TEST(PoseGraphCost, IsTheMotionFromMeasuredToPredicted) {
  Draw draw(5);
  Nodes nodes{random_node(draw), random_node(draw)};
  nodes.first.log_scale = nodes.second.log_scale = 0.0;
  PoseGraphEdge edge = predicted_edge(nodes);
  const Vector6 delta = draw.motion(0.5, 0.3);
  edge.second_from_first = inverse(exp_pose(delta)) * edge.second_from_first;
  const Vector7 error = error_at({edge, false}, nodes);
  EXPECT_LT((error.head<6>() - delta).norm(), 1e-12);
  EXPECT_EQ(error[6], 0.0);
}

TEST(PoseGraphCost, IsWeightedByTheInformation) {
  Draw draw(6);
  const Nodes nodes{random_node(draw), random_node(draw)};
  PoseGraphEdge edge = predicted_edge(nodes);
  const Vector6 delta = draw.motion(0.5, 0.3);
  edge.second_from_first = inverse(exp_pose(delta)) * edge.second_from_first;
  edge.information = random_information(draw);
  const double expected = delta.dot(edge.information * delta);
  EXPECT_NEAR(error_at({edge, false}, nodes).squaredNorm(), expected, 1e-10 * expected);
}

TEST(PoseGraphCost, IgnoresScalesForEdgesInWorldUnits) {
  Draw draw(8);
  Nodes nodes{random_node(draw), random_node(draw)};
  PoseGraphEdge edge = predicted_edge(nodes);
  edge.second_from_first.translation *= std::exp(-nodes.second.log_scale);
  edge.is_in_world_lengths = true;
  EXPECT_LT(error_at({edge, true}, nodes).norm(), 1e-11);
}

TEST(PoseGraphCost, WeightsTheScaleBySigmasOfItsLogarithm) {
  Draw draw(7);
  const Nodes nodes{random_node(draw), random_node(draw)};
  PoseGraphEdge edge = predicted_edge(nodes);
  edge.second_from_first.translation *= 0.0;
  edge.information.setZero();
  edge.scale *= std::exp(-0.06);
  edge.scale_sigma = 0.02;
  EXPECT_NEAR(error_at({edge, true}, nodes)[6], 3.0, 1e-12);
}

}  // namespace
}  // namespace byre
