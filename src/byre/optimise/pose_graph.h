#pragma once

#include "byre/pose.h"

#include <vector>

namespace byre {

struct PoseGraphNode {
  Pose camera_from_world;
  // Lengths measured at this camera for each metre of the world; other than 1 only where the scale drifts, as it does
  // in monocular maps. What the camera takes for point_in_camera is scale * (camera_from_world * point_in_world).
  double scale = 1.0;
  bool fixed = false;           // an anchor: neither pose nor scale move
  bool scale_is_known = false;  // the scale alone is held: the camera measures lengths itself, as a stereo pair does
};

// A measured motion: point_in_second = rotation * (scale * point_in_first) + translation, in lengths as measured there.
struct PoseGraphEdge {
  int first = 0;   // index into PoseGraph::nodes
  int second = 0;  // index into PoseGraph::nodes, another one
  Pose second_from_first;
  // Inverse covariance of delta in exp_pose(delta) * second_from_first; may be singular.
  Matrix6 information = Matrix6::Identity();
  double scale = 1.0;         // 1 unless the two cameras' lengths were compared
  double scale_sigma = 0.01;  // standard error of the scale's logarithm; has a say only while scales are free
  // Told in the world's lengths by what else than the cameras tells it, such as wheels: scales have no part in it.
  bool is_in_world_lengths = false;
};

struct PoseGraph {
  std::vector<PoseGraphNode> nodes;
  std::vector<PoseGraphEdge> edges;
};

// What an edge's error counts for. Huber's loss grows with the plain error and still finds the way from a start that
// is far off. Cauchy's with its logarithm, so that wrong edges lose nearly all influence; it starts where Huber's ends.
enum class RobustLoss { none, huber, cauchy };

struct PoseGraphOptions {
  int max_iterations = 50;  // for each loss
  RobustLoss loss = RobustLoss::huber;
  double loss_width = 4.0;     // sigmas of an edge's whole error; 4 is the 99 % quantile of one that is right
  bool scale_is_free = false;  // moving nodes are similarities unless their scale is known (Strasdat 2010)
  int threads = 1;             // one keeps the order of sums, hence the result, reproducible
};

struct PoseGraphResult {
  std::vector<Pose> camera_from_world;  // one per node
  std::vector<double> scales;           // one per node
  // One per edge: squared sigmas before the robust loss, chi-square with six degrees of freedom, with free scales
  // seven.
  std::vector<double> squared_errors;
  double cost = 0.0;  // half the sum of the losses of the edges that have a say
  int iterations = 0;
  bool usable = false;  // false when the solver failed: then poses and scales are as given
};

// Minimises the robust errors of the edges over poses, and scales if they are free. Nodes that no path of edges joins
// to a fixed one stay where they are; with nothing fixed the first node that has an edge is held. Edges from a node to
// itself have no say. Where edges tell the world's lengths, fixed nodes keep their poses alone, and not their scales.
PoseGraphResult optimise_pose_graph(const PoseGraph& graph, const PoseGraphOptions& options);

}  // namespace byre
