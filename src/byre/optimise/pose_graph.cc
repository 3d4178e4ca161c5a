#include "byre/optimise/pose_graph.h"

#include "byre/optimise/pose_graph_cost.h"
#include "byre/optimise/rotation_manifold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

namespace byre {
namespace {

// Eigen allocates by this alignment. Debian's Ceres has 16 bytes; with another alignment byre and Ceres would free each
// other's matrices wrongly wherever the linker shares Eigen's functions between them.
static_assert(EIGEN_DEFAULT_ALIGN_BYTES == 16, "compile with EIGEN_MAX_ALIGN_BYTES=16");

// Parts of a graph that take part in the solution.
struct GraphRoles {
  std::vector<bool> node_moves;
  std::vector<int> edges;  // indices of the edges with a moving end
};

std::vector<std::vector<int>> neighbours(const PoseGraph& graph) {
  std::vector<std::vector<int>> result(graph.nodes.size());
  for (const PoseGraphEdge& edge : graph.edges) {
    if (edge.first == edge.second) continue;
    result[edge.first].push_back(edge.second);
    result[edge.second].push_back(edge.first);
  }
  return result;
}

// The fixed nodes; without any, the first node with an edge.
std::vector<bool> fixed_nodes(const PoseGraph& graph, const std::vector<std::vector<int>>& neighbours_of) {
  std::vector<bool> held;
  for (const PoseGraphNode& node : graph.nodes) held.push_back(node.fixed);
  if (std::ranges::find(held, true) != held.end()) return held;
  const auto first = std::ranges::find(neighbours_of, false, &std::vector<int>::empty);
  if (first != neighbours_of.end()) held[first - neighbours_of.begin()] = true;
  return held;
}

// The given nodes and those connected to them by edges.
std::vector<bool> joined_to(std::vector<bool> reached, const std::vector<std::vector<int>>& neighbours_of) {
  std::vector<int> open;
  for (int node = 0; node < static_cast<int>(reached.size()); ++node) {
    if (reached[node]) open.push_back(node);
  }
  while (!open.empty()) {
    const int node = open.back();
    open.pop_back();
    for (const int neighbour : neighbours_of[node]) {
      if (reached[neighbour]) continue;
      reached[neighbour] = true;
      open.push_back(neighbour);
    }
  }
  return reached;
}

GraphRoles choose_roles(const PoseGraph& graph) {
  const auto neighbours_of = neighbours(graph);
  const std::vector<bool> held = fixed_nodes(graph, neighbours_of);
  GraphRoles roles{joined_to(held, neighbours_of), {}};
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i]) roles.node_moves[i] = false;
  }
  for (int i = 0; i < static_cast<int>(graph.edges.size()); ++i) {
    const PoseGraphEdge& edge = graph.edges[i];
    const bool moves = roles.node_moves[edge.first] || roles.node_moves[edge.second];
    if (moves && edge.first != edge.second) roles.edges.push_back(i);
  }
  return roles;
}

// The caller owns costs, losses and manifolds, and has validated them.
ceres::Problem::Options non_owning_problem_options() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  keep_manifolds(options);
  options.disable_all_safety_checks = true;
  return options;
}

// Parameter blocks of a node, as in PoseGraphCost.
struct NodeBlocks {
  explicit NodeBlocks(const PoseGraphNode& node)
      : rotation(node.camera_from_world.rotation),
        position_in_world(inverse(node.camera_from_world).translation),
        log_scale(std::log(node.scale)) {}

  std::array<double*, 3> addresses() { return {rotation.coeffs().data(), position_in_world.data(), &log_scale}; }
  Pose camera_from_world() const { return {rotation, -(rotation * position_in_world)}; }

  Eigen::Quaterniond rotation;
  Eigen::Vector3d position_in_world;
  double log_scale;
};

// The graph as a Ceres problem. Lives for one call.
class CeresGraph {
 public:
  CeresGraph(const PoseGraph& graph, const GraphRoles& roles, const PoseGraphOptions& options)
      : options_(options),
        is_metric_(std::ranges::any_of(graph.edges, &PoseGraphEdge::is_in_world_lengths)),
        nodes_(graph.nodes.begin(), graph.nodes.end()) {
    for (const int i : roles.edges) costs_.emplace_back(graph.edges[i], options.scale_is_free);
  }

  ceres::Solver::Summary solve(const PoseGraph& graph, const GraphRoles& roles) {
    ceres::HuberLoss huber(options_.loss_width);
    ceres::LossFunction* const loss = options_.is_robust ? &huber : nullptr;
    ceres::Problem problem(non_owning_problem_options());
    auto cost = costs_.begin();
    for (const int i : roles.edges) {
      const auto first = nodes_[graph.edges[i].first].addresses();
      const auto second = nodes_[graph.edges[i].second].addresses();
      problem.AddResidualBlock(&*cost++, loss, first[0], first[1], first[2], second[0], second[1], second[2]);
    }
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (problem.HasParameterBlock(nodes_[i].addresses()[0]))
        set_freedom(problem, i, graph.nodes[i], roles.node_moves[i]);
    }
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options(), &problem, &summary);
    return summary;
  }

  const NodeBlocks& node(std::size_t i) const { return nodes_[i]; }

 private:
  ceres::Solver::Options solver_options() const {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // one thread; independent of the BLAS library
    options.max_num_iterations = options_.max_iterations;
    options.num_threads = options_.threads;
    options.function_tolerance = 1e-9;  // relative; long loops converge slowly
    options.logging_type = ceres::SILENT;
    return options;
  }

  void set_freedom(ceres::Problem& problem, std::size_t index, const PoseGraphNode& node, bool moves) {
    const auto [rotation, position, log_scale] = nodes_[index].addresses();
    set_manifold(problem, rotation, manifold_);
    if (!moves) problem.SetParameterBlockConstant(rotation);
    if (!moves) problem.SetParameterBlockConstant(position);
    const bool has_free_scale = options_.scale_is_free && !node.scale_is_known && (moves || is_metric_);
    if (!has_free_scale) problem.SetParameterBlockConstant(log_scale);
  }

  const PoseGraphOptions& options_;  // owned by the caller, constant
  bool is_metric_;                   // some edge is in world lengths; constant after construction
  std::vector<NodeBlocks> nodes_;    // written by Ceres
  std::deque<PoseGraphCost> costs_;  // one per edge used; a deque, because Ceres holds the addresses
  RotationManifold manifold_;
};

PoseGraphResult unchanged_result(const PoseGraph& graph) {
  PoseGraphResult result;
  for (const PoseGraphNode& node : graph.nodes) {
    result.camera_from_world.push_back(node.camera_from_world);
    result.scales.push_back(node.scale);
  }
  result.usable = true;
  return result;
}

PoseGraphResult solve(const PoseGraph& graph, const GraphRoles& roles, const PoseGraphOptions& options) {
  PoseGraphResult result = unchanged_result(graph);
  if (roles.edges.empty()) return result;
  CeresGraph ceres_graph(graph, roles, options);
  const ceres::Solver::Summary summary = ceres_graph.solve(graph, roles);
  result.iterations = std::max(0, static_cast<int>(summary.iterations.size()) - 1);  // the first entry is the start
  result.usable = summary.IsSolutionUsable();
  if (!result.usable) return result;
  result.cost = summary.final_cost;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (options.scale_is_free) result.scales[i] = std::exp(ceres_graph.node(i).log_scale);
    if (roles.node_moves[i]) result.camera_from_world[i] = ceres_graph.node(i).camera_from_world();
  }
  return result;
}

double squared_error(const PoseGraphEdge& edge, const PoseGraphResult& result, bool scale_is_free) {
  NodeBlocks first({result.camera_from_world[edge.first], result.scales[edge.first]});
  NodeBlocks second({result.camera_from_world[edge.second], result.scales[edge.second]});
  const auto [r1, p1, s1] = first.addresses();
  const auto [r2, p2, s2] = second.addresses();
  const std::array<const double*, 6> parameters{r1, p1, s1, r2, p2, s2};
  Vector7 error;
  PoseGraphCost(edge, scale_is_free).Evaluate(parameters.data(), error.data(), nullptr);
  return error.squaredNorm();
}

}  // namespace

PoseGraphResult optimise_pose_graph(const PoseGraph& graph, const PoseGraphOptions& options) {
  PoseGraphResult result = solve(graph, choose_roles(graph), options);
  for (const PoseGraphEdge& edge : graph.edges) {
    result.squared_errors.push_back(squared_error(edge, result, options.scale_is_free));
  }
  return result;
}

}  // namespace byre
