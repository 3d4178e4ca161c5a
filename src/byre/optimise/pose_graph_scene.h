#pragma once

// Synthetic pose graphs with ground truth, for the tests and benchmarks of this room.

#include "byre/optimise/optimise_scene.h"
#include "byre/optimise/pose_graph.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace byre {

struct GraphSceneOptions {
  int nodes = 80;
  int rounds = 2;               // on the same circle
  double radius = 5.0;          // metres
  int links = 1;                // edges from each node to that many successors
  int loops = 0;                // edges from each node to that many neighbouring nodes of the next round
  double position_noise = 0.0;  // metres, of an edge
  double rotation_noise = 0.0;  // radians
};

inline constexpr double kPositionSigma = 0.02;   // metres, for edges without noise
inline constexpr double kRotationSigma = 0.005;  // radians, for edges without noise

// A camera on a circle that looks ahead and moves a little up and down.
inline PoseGraph true_graph(const GraphSceneOptions& options) {
  PoseGraph graph;
  for (int i = 0; i < options.nodes; ++i) {
    const double angle = 2.0 * std::numbers::pi * options.rounds * i / options.nodes;
    const Pose world_from_turned{rotation_exp({0.0, -angle, 0.0}), Eigen::Vector3d::Zero()};
    const Pose turned_from_camera{Eigen::Quaterniond::Identity(), {options.radius, 0.2 * std::sin(3.0 * angle), 0.0}};
    graph.nodes.push_back({.camera_from_world = inverse(world_from_turned * turned_from_camera), .fixed = i == 0});
  }
  return graph;
}

// Measurement of an edge between two nodes without noise.
inline PoseGraphEdge true_edge(const PoseGraph& graph, int first, int second) {
  const PoseGraphNode& from = graph.nodes[first];
  const PoseGraphNode& to = graph.nodes[second];
  PoseGraphEdge edge{.first = first,
                     .second = second,
                     .second_from_first = to.camera_from_world * inverse(from.camera_from_world),
                     .scale = to.scale / from.scale};
  edge.second_from_first.translation *= to.scale;
  return edge;
}

inline Matrix6 information_of(double position_sigma, double rotation_sigma) {
  Vector6 sigmas;
  sigmas << Eigen::Vector3d::Constant(position_sigma), Eigen::Vector3d::Constant(rotation_sigma);
  return sigmas.cwiseAbs2().cwiseInverse().asDiagonal();
}

inline void add_edge(PoseGraph& graph, int first, int second, const GraphSceneOptions& options, Draw& draw) {
  PoseGraphEdge edge = true_edge(graph, first, second);
  edge.second_from_first =
      exp_pose(draw.motion(options.position_noise, options.rotation_noise)) * edge.second_from_first;
  edge.information = information_of(options.position_noise > 0.0 ? options.position_noise : kPositionSigma,
                                    options.rotation_noise > 0.0 ? options.rotation_noise : kRotationSigma);
  graph.edges.push_back(edge);
}

inline PoseGraph measured_graph(unsigned seed, const GraphSceneOptions& options) {
  Draw draw(seed);
  PoseGraph graph = true_graph(options);
  for (int step = 1; step <= options.links; ++step) {
    for (int i = 0; i + step < options.nodes; ++i) add_edge(graph, i, i + step, options, draw);
  }
  for (int loop = 0; loop < options.loops; ++loop) {
    const int step = options.nodes / options.rounds + loop - options.loops / 2;
    for (int i = 0; i + step < options.nodes; ++i) add_edge(graph, i, i + step, options, draw);
  }
  return graph;
}

// Chains the edges between successive nodes, which gives the drift of odometry.
inline PoseGraph with_odometry(PoseGraph graph) {
  for (const PoseGraphEdge& edge : graph.edges) {
    if (edge.second != edge.first + 1) continue;
    graph.nodes[edge.second].camera_from_world = edge.second_from_first * graph.nodes[edge.first].camera_from_world;
  }
  return graph;
}

inline std::vector<Pose> poses_of(const PoseGraph& graph) {
  std::vector<Pose> poses;
  for (const PoseGraphNode& node : graph.nodes) poses.push_back(node.camera_from_world);
  return poses;
}

// Root-mean-square distance between cameras, metres.
inline double position_error(const std::vector<Pose>& camera_from_world, const PoseGraph& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.nodes.size(); ++i) {
    sum += (inverse(camera_from_world[i]).translation - inverse(truth.nodes[i].camera_from_world).translation)
               .squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth.nodes.size()));
}

}  // namespace byre
