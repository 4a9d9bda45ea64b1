// See chain.h.
#include "robot/chain/chain.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "linear/solve.h"

namespace gonio::robot {
namespace {

using Change6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

ChangeMatrix listed(const Matrix6& m) {
  ChangeMatrix result;
  std::copy_n(m.data(), result.size(), result.begin());
  return result;
}

template <class To, class From>
Rigid<To, From> moved(const Rigid<To, From>& pose, const std::array<double, 6>& change) {
  return {normalized(quaternion_of_rotation_vector({change[0], change[1], change[2]}) * pose.rotation),
          pose.translation_m + Vec3{change[3], change[4], change[5]}};
}

template <class To, class From, class Any>
Rigid<To, From> named(const Any& pose) {
  return {pose.rotation, pose.translation_m};
}

Eigen::Matrix3d matrix(const Quaternion& q) {
  const Mat3 m = matrix_of(q);
  Eigen::Matrix3d result;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) result(i, j) = m(i, j);
  return result;
}

Eigen::Matrix3d crossing(Vec3 v) {
  Eigen::Matrix3d m;
  m << 0, -v.z, v.y, v.z, 0, -v.x, -v.y, v.x, 0;
  return m;
}

bool is_nominal(const ChainState& s) {
  const std::array<double, 6> zero{};
  return s.joint_rad == zero && s.a_m == zero && s.d_m == zero && s.sag_rad_per_m == std::array<double, 2>{} &&
         s.backlash_rad == zero;
}

// The stated pose with the state's kinematics in place of the nominal ones.
Rigid<frame::Base, frame::Tool> corrected_pose(const ChainInput& input, const ChainInput::View& view,
                                               const ChainState& state) {
  if (input.links.empty() || view.joints_rad.empty() || is_nominal(state)) return view.base_from_tool;
  const auto nominal = flange(input.links, view.joints_rad);
  return corrected_flange(input.links, view.joints_rad, view.approach, state) *
         (inverse(nominal) * view.base_from_tool);
}

}  // namespace

Rigid<frame::Base, frame::Tool> corrected_flange(std::vector<Link> links, std::vector<double> joints_rad,
                                                 std::span<const double> approach, const ChainState& state) {
  const std::vector<double> levers = weight_levers(links, joints_rad);
  for (std::size_t i = 0; i < links.size() && i < 6; ++i) {
    links[i].a_m += state.a_m[i];
    links[i].d_m += state.d_m[i];
    joints_rad[i] += state.joint_rad[i] + (approach.empty() ? 0 : 0.5 * approach[i] * state.backlash_rad[i]);
  }
  for (std::size_t k = 0; k < 2 && k + 1 < joints_rad.size(); ++k)
    joints_rad[k + 1] += state.sag_rad_per_m[k] * levers[k + 1];
  return flange(links, joints_rad);
}

Change change_between(const camera::BoardPose& from, const camera::BoardPose& to) {
  const Vec3 turn = rotation_vector_of(to.rotation * conjugate(from.rotation));
  const Vec3 shift = to.translation_m - from.translation_m;
  return {turn.x, turn.y, turn.z, shift.x, shift.y, shift.z};
}

Rigid<frame::Base, frame::Tool> tool_pose(const ChainInput& input, const ChainInput::View& view,
                                          const ChainState& state) {
  Rigid<frame::Base, frame::Tool> tool = corrected_pose(input, view, state);
  if (state.lag_s != 0 && view.passes) {
    std::array<double, 6> xi{};
    for (std::size_t i = 0; i < 6; ++i)
      xi[i] = state.lag_s * (view.velocity[i] + 0.5 * state.lag_s * view.acceleration[i]);
    tool = tool *
           Rigid<frame::Tool, frame::Tool>{quaternion_of_rotation_vector({xi[0], xi[1], xi[2]}), {xi[3], xi[4], xi[5]}};
  }
  const double growth = state.growth_per_K * view.warmer_K + state.growth_per_s * view.later_s;
  if (growth != 0) tool.translation_m = tool.translation_m * (1 + growth);
  return tool;
}

camera::BoardPose chain_pose(const ChainInput& input, const ChainInput::View& view, const ChainState& state) {
  const auto hand = moved(input.tool_from_hand, state.hand);
  const auto fixed = moved(input.base_from_fixed, state.fixed);
  const auto tool = tool_pose(input, view, state);
  if (input.eye_to_hand) return named<frame::Camera, frame::Board>(inverse(fixed) * (tool * hand));
  return named<frame::Camera, frame::Board>(inverse(tool * hand) * fixed);
}

// Eye-in-hand: the chain is X^-1 T^-1 B, and T exp(xi) makes it X^-1 exp(-xi) X chain. Eye-to-hand: C^-1 T exp(xi) Z.
ChangeMatrix by_tool(const ChainInput& input, const ChainInput::View& view, const ChainState& state) {
  const auto hand = moved(input.tool_from_hand, state.hand);
  const camera::BoardPose chain = chain_pose(input, view, state);
  Matrix6 result = Matrix6::Zero();
  if (input.eye_to_hand) {
    const Eigen::Matrix3d camera_from_tool = matrix(chain.rotation * conjugate(hand.rotation));
    result.topLeftCorner<3, 3>() = camera_from_tool;
    result.bottomLeftCorner<3, 3>() = -camera_from_tool * crossing(hand.translation_m);
    result.bottomRightCorner<3, 3>() = camera_from_tool;
    return listed(result);
  }
  const Eigen::Matrix3d camera_from_tool = matrix(conjugate(hand.rotation));
  const Vec3 board_in_tool = hand.rotate(chain.translation_m) + hand.translation_m;
  result.topLeftCorner<3, 3>() = -camera_from_tool;
  result.bottomLeftCorner<3, 3>() = camera_from_tool * crossing(board_in_tool);
  result.bottomRightCorner<3, 3>() = -camera_from_tool;
  return listed(result);
}

MeasuredPose measured_pose(const ChainInput::View& view, const ChainInput& input, const ChainState& state,
                           const camera::BoardPose& start, int iterations) {
  MeasuredPose result{start};
  if (view.corners.empty()) {
    for (std::size_t k = 0; k < 6; ++k) {
      const double sigma = k < 3 ? view.rotation_sigma_rad : view.shift_sigma_m;
      result.covariance[7 * k] = sigma * sigma;
    }
    return result;
  }
  for (int i = 0; i <= iterations; ++i) {
    Matrix6 normal = Matrix6::Zero();
    Change6 gradient = Change6::Zero();
    double squares = 0, rows = 0;
    for (const ChainInput::Corner& c : view.corners) {
      Vec2 pixel;
      std::array<std::array<double, camera::BoardColumn::count>, 2> jacobian{};
      const Vec2 at{c.board_m.x * (1 + state.scale[0]), c.board_m.y * (1 + state.scale[1])};
      if (!camera::predict(state.intrinsics, result.camera_from_board, input.extent, state.warp, at, pixel, jacobian))
        continue;
      const std::array<double, 2> error = {c.pixel.x - pixel.x, c.pixel.y - pixel.y};
      for (std::size_t r = 0; r < 2; ++r) {
        const Eigen::Map<const Change6> row(jacobian[r].data() + camera::BoardColumn::rotation);
        normal += row * row.transpose() / (c.sigma_px * c.sigma_px);
        gradient += row * (error[r] / (c.sigma_px * c.sigma_px));
        squares += error[r] * error[r] / (c.sigma_px * c.sigma_px);
        rows += 1;
      }
    }
    const linear::Ldlt factor(normal);
    if (i < iterations) {
      const Change6 step = factor.solve(gradient);
      Change change{};
      for (std::size_t k = 0; k < 6; ++k) change[k] = step[static_cast<Eigen::Index>(k)];
      result.camera_from_board = camera::moved(result.camera_from_board, change);
      if (step.norm() < 1e-10) iterations = i + 1;
      continue;
    }
    result.covariance = listed(factor.solve(Matrix6::Identity()));
    result.squares = squares;
    result.freedom = rows - 6;
  }
  return result;
}

std::vector<double> measured_slopes(const ChainInput::View& view, const ChainInput& input, const ChainState& state,
                                    const camera::BoardPose& pose) {
  using camera::BoardColumn;
  constexpr auto count = static_cast<Eigen::Index>(slope_scale + 2);
  Matrix6 normal = Matrix6::Zero();
  Eigen::Matrix<double, 6, count> mixed = Eigen::Matrix<double, 6, count>::Zero();
  for (const ChainInput::Corner& c : view.corners) {
    constexpr double step = 1e-6;  // of the scale, for the only derivatives that the camera's model does not give
    std::array<std::array<double, BoardColumn::count>, 2> jacobian{};
    std::array<Vec2, 2> stretched;
    Vec2 pixel;
    const Vec2 at{c.board_m.x * (1 + state.scale[0]), c.board_m.y * (1 + state.scale[1])};
    if (!camera::predict(state.intrinsics, pose, input.extent, state.warp, at, pixel, jacobian)) continue;
    camera::predict(state.intrinsics, pose, input.extent, state.warp, {at.x + step * c.board_m.x, at.y}, stretched[0]);
    camera::predict(state.intrinsics, pose, input.extent, state.warp, {at.x, at.y + step * c.board_m.y}, stretched[1]);
    for (std::size_t r = 0; r < 2; ++r) {
      const Eigen::Map<const Change6> row(jacobian[r].data() + BoardColumn::rotation);
      Eigen::Matrix<double, 1, count> own;
      for (std::size_t k = 0; k < slope_warp; ++k)
        own[static_cast<Eigen::Index>(k)] = jacobian[r][BoardColumn::intrinsics + k];
      for (std::size_t k = 0; k < 2; ++k) {
        own[static_cast<Eigen::Index>(slope_warp + k)] = jacobian[r][BoardColumn::warp + k];
        const Vec2 change = (stretched[k] - pixel) * (1 / step);
        own[static_cast<Eigen::Index>(slope_scale + k)] = r == 0 ? change.x : change.y;
      }
      const double weight = 1 / (c.sigma_px * c.sigma_px);
      normal += weight * row * row.transpose();
      mixed += weight * row * own;
    }
  }
  const Eigen::MatrixXd slopes = -linear::solve_ldlt(normal, mixed);
  return {slopes.data(), slopes.data() + slopes.size()};
}

}  // namespace gonio::robot
