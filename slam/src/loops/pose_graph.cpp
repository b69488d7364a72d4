#include "loops/pose_graph.h"

#include <ceres/ceres.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "alignment/ceres_solver.h"

namespace hqslam::slam {

namespace {

/// In sigmas; loops with larger residuals lose weight.
constexpr double kCauchyScale = 3.0;
constexpr int kMaxSteps = 30;

struct NodeParameters {
  Eigen::Vector3d translation_m;
  Eigen::Quaterniond rotation;
};

/// r of an edge (pose_graph.h). Parameters: translation and quaternion (x, y, z, w) of both ends.
class EdgeResidual {
 public:
  explicit EdgeResidual(const PoseGraphEdge& edge)
      : rotation_inverse_(Eigen::Quaterniond(edge.T_from_to.linear()).conjugate()),
        translation_m_(edge.T_from_to.translation()),
        per_translation_(1.0 / edge.translation_sigma_m),
        per_rotation_(1.0 / edge.rotation_sigma_rad) {}

  template <typename T>
  bool operator()(const T* from_translation, const T* from_rotation, const T* to_translation,
                  const T* to_rotation, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    using Quaternion = Eigen::Quaternion<T>;
    const Eigen::Map<const Vector> from_m(from_translation);
    const Eigen::Map<const Vector> to_m(to_translation);
    const Eigen::Map<const Quaternion> from_q(from_rotation);
    const Eigen::Map<const Quaternion> to_q(to_rotation);
    const Quaternion inverse_q = rotation_inverse_.template cast<T>();
    const Quaternion turn = inverse_q * (from_q.conjugate() * to_q);
    const Vector motion = from_q.conjugate() * Vector(to_m - from_m);
    const Vector shift = inverse_q * Vector(motion - translation_m_.template cast<T>());
    Eigen::Map<Eigen::Matrix<T, 6, 1>> r(residual);
    r.template head<3>() = T(per_translation_) * shift;
    // q and -q are the same turn.
    r.template tail<3>() =
        T(turn.w() < T(0) ? -2.0 * per_rotation_ : 2.0 * per_rotation_) * turn.vec();
    return true;
  }

 private:
  Eigen::Quaterniond rotation_inverse_;
  Eigen::Vector3d translation_m_;
  double per_translation_;
  double per_rotation_;
};

void add_edge(const PoseGraphEdge& edge, ceres::LossFunction* loss,
              std::vector<NodeParameters>& nodes, ceres::Problem& problem) {
  NodeParameters& from = nodes[edge.from];
  NodeParameters& to = nodes[edge.to];
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<EdgeResidual, 6, 3, 4, 3, 4>(new EdgeResidual(edge)), loss,
      from.translation_m.data(), from.rotation.coeffs().data(), to.translation_m.data(),
      to.rotation.coeffs().data());
}

/// The first node of each connected component of the graph.
std::vector<std::size_t> first_of_components(const PoseGraph& graph) {
  std::vector<std::size_t> first(graph.T_map_node.size());  // known so far of each node's component
  std::iota(first.begin(), first.end(), std::size_t{0});
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto* edges : {&graph.odometry, &graph.loops}) {
      for (const PoseGraphEdge& edge : *edges) {
        const std::size_t earlier = std::min(first[edge.from], first[edge.to]);
        changed = changed || first[edge.from] != earlier || first[edge.to] != earlier;
        first[edge.from] = first[edge.to] = earlier;
      }
    }
  }
  std::vector<std::size_t> result;
  for (std::size_t node = 0; node < first.size(); ++node) {
    if (first[node] == node) result.push_back(node);
  }
  return result;
}

/// Moves the nodes to the minimum. False if Ceres found none.
bool solve(const PoseGraph& graph, ceres::LossFunction* loop_loss,
           std::vector<NodeParameters>& nodes) {
  ceres::EigenQuaternionManifold unit_quaternion;
  ceres::Problem::Options ownership;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  for (NodeParameters& node : nodes) {
    problem.AddParameterBlock(node.translation_m.data(), 3);
    problem.AddParameterBlock(node.rotation.coeffs().data(), 4, &unit_quaternion);
  }
  for (const std::size_t node : first_of_components(graph)) {
    problem.SetParameterBlockConstant(nodes[node].translation_m.data());
    problem.SetParameterBlockConstant(nodes[node].rotation.coeffs().data());
  }
  for (const PoseGraphEdge& edge : graph.odometry) add_edge(edge, nullptr, nodes, problem);
  for (const PoseGraphEdge& edge : graph.loops) add_edge(edge, loop_loss, nodes, problem);
  return slam::solve(problem, NormalEquations::kSparse, kMaxSteps);
}

std::vector<Pose> poses_of(const std::vector<NodeParameters>& nodes) {
  std::vector<Pose> result;
  result.reserve(nodes.size());
  for (const NodeParameters& node : nodes) {
    Pose pose = Pose::Identity();
    pose.linear() = node.rotation.normalized().toRotationMatrix();
    pose.translation() = node.translation_m;
    result.push_back(pose);
  }
  return result;
}

}  // namespace

Pose disagreement(const PoseGraphEdge& edge, const std::vector<Pose>& T_map_node) {
  return edge.T_from_to.inverse() * (T_map_node[edge.from].inverse() * T_map_node[edge.to]);
}

bool is_within(const Pose& motion, double max_m, double max_rad) {
  return motion.translation().norm() <= max_m && rotation_angle_rad(motion) <= max_rad;
}

std::vector<Pose> optimized(const PoseGraph& graph) {
  std::vector<NodeParameters> nodes;
  nodes.reserve(graph.T_map_node.size());
  for (const Pose& pose : graph.T_map_node) {
    nodes.push_back({pose.translation(), Eigen::Quaterniond(pose.linear())});
  }
  if (nodes.empty() || !solve(graph, nullptr, nodes)) return {};
  std::vector<Pose> T_map_node = poses_of(nodes);
  const auto agrees = [&](const PoseGraphEdge& loop) {
    const Pose strain = disagreement(loop, T_map_node);
    return std::hypot(strain.translation().norm() / loop.translation_sigma_m,
                      rotation_angle_rad(strain) / loop.rotation_sigma_rad) <= kCauchyScale;
  };
  if (std::ranges::all_of(graph.loops, agrees)) return T_map_node;
  ceres::CauchyLoss robust(kCauchyScale);
  if (!solve(graph, &robust, nodes)) return {};
  return poses_of(nodes);
}

}  // namespace hqslam::slam
