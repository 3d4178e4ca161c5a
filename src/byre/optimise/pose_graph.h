#pragma once

#include "byre/pose.h"

#include <vector>

namespace byre {

struct PoseGraphNode {
  Pose camera_from_world;
  // Measured length at this camera per metre of the world; differs from 1 only with scale drift, as in monocular maps.
  // The camera measures a point at scale * (camera_from_world * point_in_world).
  double scale = 1.0;
  bool fixed = false;           // an anchor: pose and scale do not move
  bool scale_is_known = false;  // holds the scale alone, for cameras that measure lengths such as a stereo pair
};

// Measured motion: point_in_second = rotation * (scale * point_in_first) + translation, in the second camera's lengths.
struct PoseGraphEdge {
  int first = 0;   // index into PoseGraph::nodes
  int second = 0;  // index into PoseGraph::nodes, another one
  Pose second_from_first;
  // Inverse covariance of delta in exp_pose(delta) * second_from_first; may be singular.
  Matrix6 information = Matrix6::Identity();
  double scale = 1.0;         // ratio of the two cameras' measured lengths
  double scale_sigma = 0.01;  // standard error of the scale's logarithm; used only if scales are free
  // Motion in the world's lengths, from another sensor such as wheels; independent of the nodes' scales.
  bool is_in_world_lengths = false;
};

struct PoseGraph {
  std::vector<PoseGraphNode> nodes;
  std::vector<PoseGraphEdge> edges;
};

struct PoseGraphOptions {
  int max_iterations = 50;
  bool is_robust = true;       // Huber's loss of an edge's error: linear for large errors
  double loss_width = 4.0;     // sigmas of an edge's total error; 4 is the 99 % quantile of a correct edge
  bool scale_is_free = false;  // optimises similarities, except for nodes with scale_is_known (Strasdat 2010)
  int threads = 1;             // one thread keeps the order of sums and hence the result reproducible
};

struct PoseGraphResult {
  std::vector<Pose> camera_from_world;  // one per node
  std::vector<double> scales;           // one per node
  // One per edge: squared sigmas before the robust loss; chi-square with six, with free scales seven degrees of
  // freedom.
  std::vector<double> squared_errors;
  double cost = 0.0;  // half the sum of the losses of the edges used
  int iterations = 0;
  bool usable = false;  // false if the solver failed; poses and scales are then unchanged
};

// Minimises the robust errors of the edges over poses and, if free, scales. Nodes without a path of edges to a fixed
// node do not move; without a fixed node the first node with an edge is held. Edges from a node to itself are ignored.
// With edges in world lengths, fixed nodes keep their poses but not their scales.
PoseGraphResult optimise_pose_graph(const PoseGraph& graph, const PoseGraphOptions& options);

}  // namespace byre
