// See robot_findings.h: parts of the scatter, what is entangled with the mounting, and words.
#include "explain/robot/robot_findings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "explain/sentence.h"

namespace gonio::explain {
namespace {

using Part = RobotRole::Part;
constexpr double entangled_beyond = 0.95;  // correlation with the mounting

Eigen::MatrixXd stacked(const RobotWork& work, const std::vector<PoseMatrix>& whitener,
                        const std::vector<std::size_t>& columns) {
  Eigen::MatrixXd all(6 * static_cast<Eigen::Index>(work.noisy.size()), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t v = 0; v < work.noisy.size(); ++v)
    for (std::size_t c = 0; c < columns.size(); ++c)
      all.block<6, 1>(6 * static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(c)) =
          whitener[v] * work.noisy[v].jacobian.col(static_cast<Eigen::Index>(columns[c]));
  return all;
}

// What is left of the columns when the mounting has taken what it can.
Eigen::MatrixXd beyond_mounting(const RobotWork& work, const std::vector<PoseMatrix>& whitener,
                                const Eigen::MatrixXd& columns) {
  const std::vector<std::size_t> mounting(work.parameters.base.begin(), work.parameters.base.begin() + 12);
  Eigen::MatrixXd m = stacked(work, whitener, mounting);
  m.colwise().normalize();
  return columns - m * m.completeOrthogonalDecomposition().solve(columns);
}

enum class Family { robot, camera, board, mounting };
Family family_of(Part part) {
  switch (part) {
    case Part::hand:
    case Part::fixed: return Family::mounting;
    case Part::pinhole:
    case Part::distortion: return Family::camera;
    case Part::warp:
    case Part::scale: return Family::board;
    default: return Family::robot;
  }
}

// Mean square shift of the board, beyond the mounting, by a family's effects as estimated with all hypotheses free,
// less what their uncertainty feigns.
double systematic_m2(const RobotWork& work, const std::vector<PoseMatrix>& whitener, Family family) {
  std::vector<std::size_t> columns;
  std::vector<Eigen::Index> places;
  for (std::size_t p = 0; p < work.parameters.roles.size(); ++p)
    if (family_of(work.parameters.roles[p].part) == family)
      columns.push_back(p), places.push_back(static_cast<Eigen::Index>(p));
  if (columns.empty()) return 0;
  const Eigen::MatrixXd rest = beyond_mounting(work, whitener, stacked(work, whitener, columns));
  const Eigen::VectorXd x = work.noise.estimate(places);
  const Eigen::MatrixXd c = work.noise.covariance(places, places);
  double sum = 0;
  for (std::size_t v = 0; v < work.noisy.size(); ++v) {
    const Eigen::MatrixXd raw =
        (whitener[v].inverse() * rest.middleRows<6>(6 * static_cast<Eigen::Index>(v))).bottomRows<3>();
    sum += (raw * x).squaredNorm() - (raw * c * raw.transpose()).trace();
  }
  return std::max(0.0, sum / static_cast<double>(work.noisy.size()));
}

// The same for what was named, from the final fit.
double named_m2(const RobotWork& work, const std::vector<PoseMatrix>& whitener, const Explanation& e, Family family) {
  std::vector<std::size_t> columns;
  Eigen::VectorXd x(static_cast<Eigen::Index>(e.estimates.size()));
  for (const Estimate& estimate : e.estimates) {
    if (family_of(work.parameters.roles[estimate.parameter].part) != family) continue;
    x[static_cast<Eigen::Index>(columns.size())] =
        estimate.value - work.parameters.parameters[estimate.parameter].neutral;
    columns.push_back(estimate.parameter);
  }
  if (columns.empty()) return 0;
  const Eigen::VectorXd effect = beyond_mounting(work, whitener, stacked(work, whitener, columns)) *
                                 x.head(static_cast<Eigen::Index>(columns.size()));
  double sum = 0;
  for (std::size_t v = 0; v < work.noisy.size(); ++v)
    sum +=
        PoseChange(whitener[v].inverse() * effect.segment<6>(6 * static_cast<Eigen::Index>(v))).tail<3>().squaredNorm();
  return sum / static_cast<double>(work.noisy.size());
}

// Mean square of the shift in whitened residuals of the views.
double shift_m2(const std::vector<PoseMatrix>& whitener, const std::vector<double>& residual) {
  double sum = 0;
  for (std::size_t v = 0; v < whitener.size(); ++v) {
    const Eigen::Map<const PoseChange> z(residual.data() + 6 * v);
    sum += PoseChange(whitener[v].inverse() * z).tail<3>().squaredNorm();
  }
  return sum / static_cast<double>(whitener.size());
}

// Noise by its covariances. What is systematic: the named physics; where nothing is named, the families share what the
// noise leaves, each up to what it is estimated to make.
manifest::ScatterParts parts_of(const RobotWork& work, const std::vector<PoseMatrix>& whitener, const Explanation& e,
                                double scatter_m2) {
  const double n = static_cast<double>(work.noisy.size());
  std::array<double, 3> part{};  // robot, camera, board: the order of Family
  for (const NoisyView& view : work.noisy) {
    const PoseMatrix robot = view.covariance(work.noise.rotation_rad, work.noise.shift_m) - view.measured;
    part[0] += robot.bottomRightCorner<3, 3>().trace() / n;
    part[1] += view.measured.bottomRightCorner<3, 3>().trace() / n;
  }
  double left = std::max(0.0, scatter_m2 - part[0] - part[1]), wanted = 0;
  std::array<double, 3> systematic{};
  for (std::size_t f = 0; f < 3; ++f) {
    const auto family = static_cast<Family>(f);
    systematic[f] = e.named.empty() ? systematic_m2(work, whitener, family) : named_m2(work, whitener, e, family);
    wanted += systematic[f];
  }
  const double granted = wanted > left ? left / wanted : 1;
  for (std::size_t f = 0; f < 3; ++f) {
    part[f] += granted * systematic[f];
    left -= granted * systematic[f];
  }
  return {std::sqrt(part[0]), std::sqrt(part[1]), std::sqrt(part[2]), std::sqrt(std::max(0.0, left))};
}

std::string joint_words(const Part part, std::size_t index) {
  const std::string number = std::to_string(index + 1);
  if (part == Part::joint) return "the zero of joint " + number;
  if (part == Part::a) return "the length of link " + number;
  if (part == Part::d) return "the offset of link " + number;
  return "the yielding of joint " + std::to_string(index + 2);
}

void find_entangled(const RobotWork& work, const std::vector<PoseMatrix>& whitener, RobotFindings& findings) {
  std::vector<std::size_t> sweeps;
  for (std::size_t p = 0; p < work.parameters.roles.size(); ++p) {
    const RobotRole& role = work.parameters.roles[p];
    if (family_of(role.part) != Family::robot) continue;
    const Eigen::MatrixXd column = stacked(work, whitener, {p});
    const double length = column.norm();
    const double share = length > 0 ? beyond_mounting(work, whitener, column).norm() / length : 0;
    const double correlation = std::sqrt(std::max(0.0, 1 - share * share));
    if (correlation <= entangled_beyond) continue;
    const bool same = share < 1e-6;
    findings.entangled.push_back(
        joint_words(role.part, role.index) +
        (same ? " is the same as a change of the mounting: no poses tell them apart"
              : " is not told apart from the mounting (correlation " + printed(correlation, 3) + ")"));
    if (!same) sweeps.push_back(role.part == Part::sag ? role.index + 1 : role.index);
  }
  std::sort(sweeps.begin(), sweeps.end());
  sweeps.erase(std::unique(sweeps.begin(), sweeps.end()), sweeps.end());
  for (const std::size_t joint : sweeps)
    findings.next.push_back("sweep joint " + std::to_string(joint + 1) +
                            " alone through the range in which the camera sees the board, the other joints at rest");
}

std::string millimetres(double m) {
  return printed(1e3 * m, 2) + " mm";
}

std::string words_of(const RobotWork& work, const RobotFindings& f) {
  std::string text = "The board's position scatters by " + millimetres(f.scatter_m) +
                     ": the robot's poses account for " + millimetres(*f.parts.robot_m) + ", corners and camera for " +
                     millimetres(*f.parts.camera_m) + ", the board's shape for " + millimetres(*f.parts.board_m) +
                     ", and " + millimetres(*f.parts.unexplained_m) +
                     " remains unexplained (root mean squares; their squares add).";
  text += " The robot's noise is " + millimetres(f.robot_m) + " a coordinate and " +
          printed(f.robot_rad * 180 / pi, 2) + " degrees an axis.";
  if (work.input.links.empty() || work.input.views[0].joints_rad.empty())
    text += " Without joint angles and a known arm its kinematics cannot be examined.";
  return text;
}

}  // namespace

RobotFindings findings_of(const RobotWork& work, const Observations& o, const std::vector<PoseMatrix>& whitener,
                          const Explanation& e) {
  RobotFindings f;
  const double rows = static_cast<double>(o.rows());
  const double freedom = rows / std::max(1.0, rows - static_cast<double>(work.parameters.base.size()));
  const double scatter = shift_m2(whitener, e.residual_before);
  f.scatter_m = std::sqrt(scatter);
  f.robot_m = work.noise.shift_m;
  f.robot_rad = work.noise.rotation_rad;
  f.parts = parts_of(work, whitener, e, scatter * freedom);
  find_entangled(work, whitener, f);
  f.sentence = words_of(work, f);
  return f;
}

// A bar for each part, lengths as variances: those add.
Illustration illustrate_robot(const RobotFindings& f) {
  const std::array<std::pair<const char*, double>, 4> bars = {{{"robot", *f.parts.robot_m},
                                                               {"corners and camera", *f.parts.camera_m},
                                                               {"board", *f.parts.board_m},
                                                               {"unexplained", *f.parts.unexplained_m}}};
  double total = 0;
  for (const auto& [name, m] : bars) total += m * m;
  std::string svg = "<svg viewBox=\"0 0 640 150\" role=\"img\" style=\"background:#fff;min-width:min(27rem,85vw)\">";
  int y = 10;
  for (const auto& [name, m] : bars) {
    char text[400];
    const double share = total > 0 ? m * m / total : 0;
    std::snprintf(text, sizeof text,
                  "<rect x=\"170\" y=\"%d\" width=\"%.1f\" height=\"22\" fill=\"#2b5f8a\"/><text x=\"160\" y=\"%d\" "
                  "font-size=\"15\" "
                  "text-anchor=\"end\">%s</text><text x=\"%.1f\" y=\"%d\" font-size=\"15\">%s, %.0f %%</text>",
                  y, 320 * share, y + 17, name, 178 + 320 * share, y + 17, millimetres(m).c_str(), 100 * share);
    svg += text;
    y += 34;
  }
  Illustration result;
  result.pictures.push_back(
      {"Where the scatter of the board's position comes from. " + f.sentence, "", svg + "</svg>"});
  return result;
}

}  // namespace gonio::explain
