// See robot_findings.h: parts of the scatter, what is entangled with the mounting, and words.
#include "explain/robot/robot_findings.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "inference/sentence.h"
#include "linear/qr.h"
#include "manifest/sections/mounting.h"

namespace gonio::explain {
namespace {

using Part = RobotRole::Part;
constexpr double entangled_beyond = 0.95;     // correlation with the mounting
constexpr std::size_t mounting_numbers = 12;  // the first of the base model's

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
  const std::vector<std::size_t> mounting(work.parameters.base.begin(),
                                          work.parameters.base.begin() + mounting_numbers);
  Eigen::MatrixXd m = stacked(work, whitener, mounting);
  m.colwise().normalize();
  return columns - m * linear::LeastNorm(m).solve(columns);
}

// From a change of the board's pose in a view to the shift of the board's middle, in the camera's axes.
using ShiftMatrix = Eigen::Matrix<double, 3, 6>;
ShiftMatrix of_middle(const RobotWork& work, std::size_t view) {
  const Vec3 arm = work.reference[view].rotate({work.input.extent.middle_m.x, work.input.extent.middle_m.y, 0});
  ShiftMatrix m;
  m << 0, arm.z, -arm.y, 1, 0, 0, -arm.z, 0, arm.x, 0, 1, 0, arm.y, -arm.x, 0, 0, 0, 1;
  return m;
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

// Mean square shift of the board, beyond the mounting, by a family's named effects in the final fit.
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
    sum += (of_middle(work, v) * whitener[v].inverse() * effect.segment<6>(6 * static_cast<Eigen::Index>(v)))
               .squaredNorm();
  return sum / static_cast<double>(work.noisy.size());
}

// Mean square of the shift in whitened residuals of the views.
double shift_m2(const RobotWork& work, const std::vector<PoseMatrix>& whitener, const std::vector<double>& residual) {
  double sum = 0;
  for (std::size_t v = 0; v < whitener.size(); ++v) {
    const Eigen::Map<const PoseChange> z(residual.data() + 6 * v);
    sum += (of_middle(work, v) * whitener[v].inverse() * z).squaredNorm();
  }
  return sum / static_cast<double>(whitener.size());
}

// The noise under the model that stands, the mountings and what is named: what was not named is the robot's. Where
// nothing is named it is the noise that handeye states; lenses that may move within their sigma are none of its
// business.
struct FinalNoise {
  std::vector<NoisyView> views;  // with the columns of that model alone
  Eigen::VectorXd prior;
  robot::handeye::Noise noise;
};
FinalNoise final_noise(const RobotWork& work, const Explanation& e) {
  std::vector<Eigen::Index> columns;
  for (std::size_t k = 0; k < mounting_numbers; ++k)
    columns.push_back(static_cast<Eigen::Index>(work.parameters.base[k]));
  for (const Estimate& estimate : e.estimates) columns.push_back(static_cast<Eigen::Index>(estimate.parameter));
  FinalNoise result{work.noisy, prior_precision(work.parameters)(columns), {}};
  for (NoisyView& view : result.views) view.jacobian = Eigen::MatrixXd(view.jacobian(Eigen::all, columns));
  result.noise = noise_of(result.views, result.prior);
  return result;
}

// Mean squares of the shift that noise of robot and corners leaves in the residuals of that model, (I - H) V (I - H)'
// part by part.
std::array<double, 2> noise_m2(const RobotWork& work, const FinalNoise& f) {
  const Eigen::Index n = f.prior.size();
  robot::handeye::Noise of_camera;
  of_camera.board_rad = f.noise.board_rad;  // lens and board turn it
  Eigen::MatrixXd normal = f.prior.asDiagonal();
  std::vector<PoseMatrix> weight;
  for (const NoisyView& view : f.views) {
    weight.push_back(view.covariance(f.noise).inverse());
    normal += view.jacobian.transpose() * weight.back() * view.jacobian;
  }
  const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Eigen::MatrixXd inverse =
      scale.asDiagonal() * linear::LeastNorm(scaled).solve(Eigen::MatrixXd::Identity(n, n)) * scale.asDiagonal();
  std::array<double, 2> sums{};
  for (std::size_t i = 0; i < f.views.size(); ++i)
    for (std::size_t j = 0; j < f.views.size(); ++j) {
      PoseMatrix m = -f.views[i].jacobian * inverse * f.views[j].jacobian.transpose() * weight[j];
      if (i == j) m += PoseMatrix::Identity();
      const ShiftMatrix rows = of_middle(work, i) * m;
      const PoseMatrix robot = f.views[j].covariance(f.noise) - f.views[j].covariance(of_camera);
      const PoseMatrix measured = f.views[j].covariance(of_camera);
      sums[0] += (rows * robot * rows.transpose()).trace() / static_cast<double>(f.views.size());
      sums[1] += (rows * measured * rows.transpose()).trace() / static_cast<double>(f.views.size());
    }
  return sums;
}

// Noise, and what was named where the noise leaves room for it. Where rotations and shifts of the robot are not as
// independent as the noise model has them, its parts exceed the scatter: then they share it.
manifest::ScatterParts parts_of(const RobotWork& work, const std::vector<PoseMatrix>& whitener, const Explanation& e,
                                const FinalNoise& final, double scatter_m2) {
  const std::array<double, 2> noise = noise_m2(work, final);
  const double share = std::min(1.0, scatter_m2 / std::max(noise[0] + noise[1], 1e-30));
  std::array<double, 3> part = {share * noise[0], share * noise[1], 0};  // robot, camera, board: the order of Family
  double left = std::max(0.0, scatter_m2 - part[0] - part[1]), wanted = 0;
  std::array<double, 3> systematic{};
  for (std::size_t f = 0; f < 3; ++f) wanted += systematic[f] = named_m2(work, whitener, e, static_cast<Family>(f));
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
  if (part == Part::backlash) return "the play of joint " + number;
  if (part == Part::growth) return index == 0 ? "the arm's growth with temperature" : "the arm's growth with time";
  if (part == Part::lag) return "the lag of the poses";
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
    if (!same && role.part != Part::growth && role.part != Part::lag)
      sweeps.push_back(role.part == Part::sag ? role.index + 1 : role.index);
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

std::string degrees(double rad) {
  const double value = rad * 180 / pi;
  return (value < 5e-4 ? std::string("less than 0.001") : printed(value, 2)) + " degrees";
}

// Which noise it is: handeye states that of all poses that it kept, about the mountings alone.
std::string about(const RobotWork& work, const RobotFindings& f) {
  if (f.with_named) return "once what is named is put in";
  if (work.outliers.empty()) return "about the mountings as handeye states it";
  std::string names;
  for (const std::string& image : work.outliers) names += (names.empty() ? "" : ", ") + image;
  return "about the mountings without " + names + ", beyond any noise";
}

std::string words_of(const RobotWork& work, const RobotFindings& f) {
  std::string text = "The board's position scatters by " + millimetres(f.scatter_m) +
                     ": the robot's poses account for " + millimetres(*f.parts.robot_m) + ", corners and camera for " +
                     millimetres(*f.parts.camera_m) + ", the board's shape for " + millimetres(*f.parts.board_m) +
                     ", and " + millimetres(*f.parts.unexplained_m) +
                     " remains unexplained (root mean squares; their squares add).";
  text += " The noise of the robot's poses, " + about(work, f) + ", is " + millimetres(f.robot_m) +
          " a coordinate and " + degrees(f.robot_rad) + " an axis; the board is seen turned by " +
          degrees(f.board_rad) + " an axis beyond its corners' noise.";
  if (work.input.links.empty() || work.input.views[0].joints_rad.empty())
    text += " Without joint angles and a known arm its kinematics cannot be examined.";
  return text;
}

}  // namespace

double place_noise2(const RobotWork& work) {
  double sum = 0;
  for (std::size_t v = 0; v < work.noisy.size(); ++v) {
    const ShiftMatrix middle = of_middle(work, v);
    sum += (middle * work.noisy[v].covariance(work.noise.sizes) * middle.transpose()).trace();
  }
  return std::max(1e-24, sum / static_cast<double>(work.noisy.size()));
}

RobotFindings findings_of(const RobotWork& work, const std::vector<PoseMatrix>& whitener, const Explanation& e) {
  RobotFindings f;
  const double scatter = shift_m2(work, whitener, e.residual_before);
  const FinalNoise final = final_noise(work, e);
  f.scatter_m = std::sqrt(scatter);
  f.robot_m = final.noise.robot_m;
  f.robot_rad = final.noise.robot_rad;
  f.board_rad = final.noise.board_rad;
  f.with_named = !e.estimates.empty();
  f.parts = parts_of(work, whitener, e, final, scatter);
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
