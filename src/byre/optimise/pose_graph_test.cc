#include "byre/optimise/pose_graph.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/optimise/pose_graph_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

using testing::Each;
using testing::Lt;

constexpr GraphSceneOptions kNoisy{
    .links = 2, .loops = 3, .position_noise = kPositionSigma, .rotation_noise = kRotationSigma};

constexpr PoseGraphOptions kLeastSquares{.is_robust = false};

void expect_poses(const PoseGraphResult& result, const PoseGraph& truth, double tolerance) {
  ASSERT_TRUE(result.usable);
  for (std::size_t i = 0; i < truth.nodes.size(); ++i) {
    EXPECT_THAT(result.camera_from_world[i], PoseNear(truth.nodes[i].camera_from_world, tolerance, tolerance))
        << "node " << i;
  }
}

bool same_to_the_bit(const Pose& first, const Pose& second) {
  return first.rotation.coeffs() == second.rotation.coeffs() && first.translation == second.translation;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

PoseGraph displaced(PoseGraph graph, unsigned seed, double metres, double radians) {
  Draw draw(seed);
  for (PoseGraphNode& node : graph.nodes) {
    const Vector6 delta = draw.motion(metres, radians);
    if (!node.fixed) node.camera_from_world = exp_pose(delta) * node.camera_from_world;
  }
  return graph;
}

class EveryLoss : public testing::TestWithParam<bool> {};

TEST_P(EveryLoss, ClosesCleanLoopsExactly) {
  const PoseGraph clean = measured_graph(1, {.loops = 1});
  const PoseGraphResult result = optimise_pose_graph(displaced(clean, 1, 0.3, 0.1), {.is_robust = GetParam()});
  expect_poses(result, clean, 1e-6);
  EXPECT_THAT(result.squared_errors, Each(Lt(1e-6)));
  EXPECT_LT(result.cost, 1e-6);
}

TEST_P(EveryLoss, KeepsAConsistentGraph) {
  const PoseGraph clean = measured_graph(2, {.links = 2, .loops = 1});
  const PoseGraphResult result = optimise_pose_graph(clean, {.is_robust = GetParam()});
  expect_poses(result, clean, 1e-9);
}

TEST_P(EveryLoss, CorrectsTheDriftOfOdometry) {
  const PoseGraph measured = measured_graph(3, kNoisy);
  const PoseGraph drifted = with_odometry(measured);
  const PoseGraphResult result = optimise_pose_graph(drifted, {.is_robust = GetParam()});
  ASSERT_TRUE(result.usable);
  EXPECT_LT(position_error(result.camera_from_world, measured), 0.35 * position_error(poses_of(drifted), measured));
}

INSTANTIATE_TEST_SUITE_P(OptimisePoseGraph, EveryLoss, testing::Bool());

// The remaining errors follow chi-square with six degrees of freedom per edge beyond a spanning tree; 99.9 %.
TEST(OptimisePoseGraph, LeavesErrorsExplainedByNoise) {
  const PoseGraph measured = measured_graph(4, kNoisy);
  const PoseGraphResult result = optimise_pose_graph(with_odometry(measured), kLeastSquares);
  const double degrees = 6.0 * static_cast<double>(measured.edges.size() - measured.nodes.size() + 1);
  EXPECT_NEAR(sum(result.squared_errors), degrees, 3.3 * std::sqrt(2.0 * degrees));
  EXPECT_NEAR(result.cost, 0.5 * sum(result.squared_errors), 1e-9 * degrees);
}

// Equal springs in a ring: each of n edges takes 1/n of the closing error.
TEST(OptimisePoseGraph, DistributesALoopErrorEvenly) {
  constexpr int kNodes = 10;
  constexpr double kGap = 0.5;  // metres
  PoseGraph ring;
  for (int i = 0; i < kNodes; ++i) {
    ring.nodes.push_back(
        {.camera_from_world = {Eigen::Quaterniond::Identity(), {0.0, 0.0, -1.0 * i}}, .fixed = i == 0});
  }
  for (int i = 0; i < kNodes; ++i) {
    ring.edges.push_back(true_edge(ring, i, (i + 1) % kNodes));
    ring.edges.back().information = information_of(0.1, 0.1);
  }
  ring.edges.back().second_from_first.translation.z() += kGap;
  const PoseGraphResult result = optimise_pose_graph(ring, kLeastSquares);
  const double each = kGap / kNodes / 0.1;  // sigmas
  EXPECT_THAT(result.squared_errors, Each(testing::DoubleNear(each * each, 1e-5)));
  EXPECT_NEAR(result.camera_from_world[5].translation.z(), -5.0 - 5.0 * kGap / kNodes, 1e-6);
}

TEST(OptimisePoseGraph, IsInvariantToTheWorldFrame) {
  const PoseGraph graph = with_odometry(measured_graph(5, kNoisy));
  const Pose world_from_other = exp_pose((Vector6() << 30.0, -20.0, 10.0, 0.5, -1.0, 2.0).finished());
  PoseGraph elsewhere = graph;
  for (PoseGraphNode& node : elsewhere.nodes) node.camera_from_world = node.camera_from_world * world_from_other;
  const PoseGraphResult here = optimise_pose_graph(graph, {});
  const PoseGraphResult there = optimise_pose_graph(elsewhere, {});
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    EXPECT_THAT(there.camera_from_world[i], PoseNear(here.camera_from_world[i] * world_from_other, 1e-5, 1e-5));
  }
}

// A graph with a false loop edge between two opposite nodes of the circle.
PoseGraph with_false_loop(PoseGraph graph) {
  graph.edges.push_back(
      {.first = 10, .second = 31, .second_from_first = Pose{}, .information = graph.edges.front().information});
  return graph;
}

TEST(OptimisePoseGraph, ReportsAFalseLoopByItsError) {
  const PoseGraph graph = with_false_loop(with_odometry(measured_graph(7, kNoisy)));
  std::vector<double> errors = optimise_pose_graph(graph, {}).squared_errors;
  EXPECT_GT(errors.back(), 1e4);
  errors.pop_back();
  EXPECT_THAT(errors, Each(Lt(50.0)));
}

TEST(OptimisePoseGraph, IsDistortedMoreByAFalseLoopWithoutARobustLoss) {
  const PoseGraph truth = measured_graph(8, kNoisy);
  const PoseGraph graph = with_false_loop(with_odometry(truth));
  const auto error_with = [&](const PoseGraphOptions& options) {
    return position_error(optimise_pose_graph(graph, options).camera_from_world, truth);
  };
  EXPECT_LT(error_with({}), 0.2 * error_with(kLeastSquares));
}

// The scale of the cameras drifts by 0.5 % per node. Only edges between rounds measure it.
PoseGraph with_scale_drift(const GraphSceneOptions& options) {
  PoseGraph graph = true_graph(options);
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) graph.nodes[i].scale = std::pow(1.005, i);
  return graph;
}

// The odometry of a monocular camera: all scales are assumed equal to the first one's.
PoseGraph as_odometry_thinks(PoseGraph truth) {
  for (int i = 0; i + 1 < static_cast<int>(truth.nodes.size()); ++i) {
    truth.edges.push_back(true_edge(truth, i, i + 1));
    truth.edges.back().scale = 1.0;
    truth.edges.back().information = information_of(0.01, 0.002);
  }
  for (PoseGraphNode& node : truth.nodes) node.scale = 1.0;
  return with_odometry(truth);
}

TEST(OptimisePoseGraph, RemovesScaleDriftIfScalesAreFree) {
  const PoseGraph truth = with_scale_drift({.nodes = 80, .rounds = 1});
  PoseGraph drifted = as_odometry_thinks(truth);
  drifted.edges.push_back(true_edge(truth, 79, 0));
  drifted.edges.back().information = information_of(0.01, 0.002);
  drifted.edges.back().scale_sigma = 0.001;
  PoseGraphOptions options = kLeastSquares;
  const double rigid_error = position_error(optimise_pose_graph(drifted, options).camera_from_world, truth);
  options.scale_is_free = true;
  const PoseGraphResult result = optimise_pose_graph(drifted, options);
  ASSERT_TRUE(result.usable);
  const double error = position_error(result.camera_from_world, truth);
  EXPECT_LT(error, 0.05 * position_error(poses_of(drifted), truth));
  EXPECT_LT(error, 0.1 * rigid_error);
  for (std::size_t i = 0; i < truth.nodes.size(); ++i) {
    EXPECT_NEAR(result.scales[i] / truth.nodes[i].scale, 1.0, 0.01) << "node " << i;
  }
}

// Wheel odometry between successive nodes, in world lengths that differ from the first node's scale.
TEST(OptimisePoseGraph, HoldsScalesToMetricEdges) {
  PoseGraph truth = with_scale_drift({.nodes = 40, .rounds = 1});
  for (PoseGraphNode& node : truth.nodes) node.scale *= 1.1;
  PoseGraph drifted = as_odometry_thinks(truth);
  for (int i = 0; i < 39; ++i) {
    PoseGraphEdge measured = true_edge(truth, i, i + 1);
    measured.second_from_first.translation /= truth.nodes[static_cast<std::size_t>(i) + 1].scale;
    measured.scale = 1.0;
    measured.information = information_of(0.01, 0.01);
    measured.is_in_world_lengths = true;
    drifted.edges.push_back(measured);
  }
  const PoseGraphResult result = optimise_pose_graph(drifted, {.is_robust = false, .scale_is_free = true});
  ASSERT_TRUE(result.usable);
  EXPECT_LT(position_error(result.camera_from_world, truth), 0.1 * position_error(poses_of(drifted), truth));
  for (std::size_t i = 0; i < truth.nodes.size(); ++i) {
    EXPECT_NEAR(result.scales[i] / truth.nodes[i].scale, 1.0, 0.02) << "node " << i;
  }
}

TEST(OptimisePoseGraph, EstimatesMeasuredScalesExactly) {
  const PoseGraph truth = [] {
    PoseGraph graph = with_scale_drift({.nodes = 40});
    for (int i = 0; i < 39; ++i) graph.edges.push_back(true_edge(graph, i, i + 1));
    for (int i = 0; i < 20; ++i) graph.edges.push_back(true_edge(graph, i, i + 20));
    return graph;
  }();
  PoseGraph start = displaced(truth, 9, 0.1, 0.05);
  for (PoseGraphNode& node : start.nodes) node.scale = 1.0;
  const PoseGraphResult result = optimise_pose_graph(start, {.is_robust = false, .scale_is_free = true});
  expect_poses(result, truth, 1e-5);
  for (std::size_t i = 0; i < truth.nodes.size(); ++i) {
    EXPECT_NEAR(result.scales[i] / truth.nodes[i].scale, 1.0, 1e-5) << "node " << i;
  }
}

TEST(OptimisePoseGraph, HoldsScalesUnlessTheyAreFree) {
  const PoseGraph truth = with_scale_drift({.nodes = 20, .rounds = 1});
  PoseGraph start = displaced(truth, 10, 0.1, 0.05);
  for (int i = 0; i < 19; ++i) start.edges.push_back(true_edge(truth, i, i + 1));
  const PoseGraphResult result = optimise_pose_graph(start, {});
  expect_poses(result, truth, 1e-6);
  for (std::size_t i = 0; i < truth.nodes.size(); ++i) EXPECT_EQ(result.scales[i], truth.nodes[i].scale);
}

TEST(OptimisePoseGraph, HoldsTheScaleOfNodesWithKnownScale) {
  PoseGraph graph = displaced(measured_graph(17, {.nodes = 20, .rounds = 1}), 17, 0.1, 0.05);
  for (PoseGraphEdge& edge : graph.edges) edge.scale = 1.01;
  graph.nodes[10].scale_is_known = true;
  const PoseGraphResult result = optimise_pose_graph(graph, {.scale_is_free = true});
  ASSERT_TRUE(result.usable);
  EXPECT_EQ(result.scales[10], 1.0);
  EXPECT_GT(result.scales[15], 1.02) << "the others follow their edges";
}

TEST(OptimisePoseGraph, HoldsTheFirstConnectedNodeIfNothingIsFixed) {
  PoseGraph graph = with_odometry(measured_graph(11, kNoisy));
  graph.nodes.front().fixed = false;
  std::erase_if(graph.edges, [](const PoseGraphEdge& edge) { return edge.first == 0; });
  const PoseGraphResult result = optimise_pose_graph(graph, {});
  EXPECT_TRUE(same_to_the_bit(result.camera_from_world[0], graph.nodes[0].camera_from_world));
  EXPECT_TRUE(same_to_the_bit(result.camera_from_world[1], graph.nodes[1].camera_from_world));
  EXPECT_FALSE(same_to_the_bit(result.camera_from_world[2], graph.nodes[2].camera_from_world));
}

TEST(OptimisePoseGraph, LeavesFixedAndDisconnectedNodesBitIdentical) {
  constexpr int kCut = 60;
  PoseGraph graph = with_odometry(measured_graph(12, kNoisy));
  graph.nodes[40].fixed = true;
  std::erase_if(graph.edges, [](const PoseGraphEdge& edge) { return (edge.first < kCut) != (edge.second < kCut); });
  const PoseGraphResult result = optimise_pose_graph(graph, {});
  ASSERT_TRUE(result.usable);
  for (int i = 0; i < static_cast<int>(graph.nodes.size()); ++i) {
    const bool stays = i == 0 || i == 40 || i >= kCut;
    EXPECT_EQ(same_to_the_bit(result.camera_from_world[i], graph.nodes[i].camera_from_world), stays) << "node " << i;
  }
  EXPECT_EQ(result.squared_errors.size(), graph.edges.size());
}

TEST(OptimisePoseGraph, IsDeterministic) {
  const PoseGraph graph = with_odometry(measured_graph(13, kNoisy));
  const PoseGraphOptions options{.scale_is_free = true};
  const PoseGraphResult first = optimise_pose_graph(graph, options);
  const PoseGraphResult second = optimise_pose_graph(graph, options);
  EXPECT_TRUE(std::ranges::equal(first.camera_from_world, second.camera_from_world, same_to_the_bit));
  EXPECT_EQ(first.scales, second.scales);
  EXPECT_EQ(first.squared_errors, second.squared_errors);
}

TEST(OptimisePoseGraph, AcceptsAnEmptyGraphAndOneWithoutEdges) {
  EXPECT_TRUE(optimise_pose_graph({}, {}).usable);
  const PoseGraph lonely = true_graph({.nodes = 3});
  const PoseGraphResult result = optimise_pose_graph(lonely, {});
  EXPECT_TRUE(result.usable);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_TRUE(std::ranges::equal(result.camera_from_world, poses_of(lonely), same_to_the_bit));
}

TEST(OptimisePoseGraph, IgnoresAnEdgeFromANodeToItself) {
  const PoseGraph graph = with_odometry(measured_graph(14, kNoisy));
  PoseGraph with_self = graph;
  with_self.edges.push_back({.first = 5, .second = 5, .second_from_first = exp_pose(Vector6::Constant(0.1))});
  const PoseGraphResult result = optimise_pose_graph(with_self, {});
  EXPECT_TRUE(
      std::ranges::equal(result.camera_from_world, optimise_pose_graph(graph, {}).camera_from_world, same_to_the_bit));
  EXPECT_NEAR(result.squared_errors.back(), 0.06, 1e-6);
}

TEST(OptimisePoseGraph, AcceptsEdgesOfRotationOnly) {
  PoseGraph clean = measured_graph(15, {.loops = 1});
  for (PoseGraphEdge& edge : clean.edges) {
    if (edge.second == edge.first + 1) continue;
    edge.information.topLeftCorner<3, 3>().setZero();
    edge.second_from_first.translation.setConstant(100.0);
  }
  expect_poses(optimise_pose_graph(displaced(clean, 15, 0.1, 0.05), {}), clean, 1e-6);
}

TEST(OptimisePoseGraph, ReturnsTheInputWhenTheSolverFails) {
  PoseGraph graph = with_odometry(measured_graph(16, kNoisy));
  graph.edges[7].second_from_first.translation.x() = std::numeric_limits<double>::quiet_NaN();
  const PoseGraphResult result = optimise_pose_graph(graph, {});
  EXPECT_FALSE(result.usable);
  EXPECT_TRUE(std::ranges::equal(result.camera_from_world, poses_of(graph), same_to_the_bit));
}

}  // namespace
}  // namespace byre
