// Probabilistic principal components (EM-PPCA): the deformation's weights are normal and integrated out.
//   w_fp = c_f R_f (m_p + V_p z_f) + t_f + n,   z_f ~ N(0, I_K),   n ~ N(0, sigma^2 I_2)
// Expectation maximization (Torresani, Hertzmann & Bregler, PAMI 30, 2008, sections 3 and 4). With D_f = c_f R_f, sums
// over the points that are visible in the frame, or the frames that see the point:
//   E   Lambda_f = I + sum_p V_p' D_f' D_f V_p / sigma^2,  mu_f = Lambda_f^-1 sum_p V_p' D_f' (w - t_f - D_f m_p) /
//   sigma^2
//       E[z z'] = Lambda_f^-1 + mu_f mu_f'
//   M   H_p = [m_p V_p] from sum_f (E[y y'] (x) D_f' D_f) vec H_p = vec sum_f D_f' (w - t_f) E[y]',  y = [1; z]
//       camera: least squares on the mean shape, plus c^2 trace(R Q R'), Q = sum_p V_p Lambda_f^-1 V_p'
//       sigma^2: the mean expected squared residual
// Missing tracks need nothing besides. Start: the cameras of csf and the rigid shape that they see, z from the largest
// temporal modes of its residuals; the paper starts at rigid cameras (camera_rank=1), from where walking ends at four
// times the error. Turns creep, and end early on purpose: what a model of K deformations leaves of real tracks is no
// independent noise, and on the way to the greatest likelihood, where `extrapolate` (extrapolation.h) leads, rotations
// and depths take it up (walking: error 0.13 after 150 plain turns, 0.18 at the maximum; a shark that the model
// contains: 0.09 and 0.07). Left out: the paper's linear dynamics of z (its EM-LDS).
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "base/atomic_file.h"
#include "linear/qr.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"
#include "nrsfm/solve/extrapolation.h"
#include "nrsfm/solve/factorization.h"
#include "nrsfm/solve/solver_support.h"

namespace gonio::nrsfm::solvers {
namespace {

constexpr double kGain = 1e-6;

struct EmState {
  std::vector<WeakCamera> cameras;
  Eigen::MatrixXd basis;                    // 3 (K + 1) x P: m, V_1 .. V_K
  Eigen::MatrixXd weights;                  // F x (K + 1): E[y]
  std::vector<Eigen::MatrixXd> covariance;  // K x K: Lambda_f^-1
  double variance = 0;

  CameraRows rows(Eigen::Index f) const {
    const WeakCamera& camera = cameras[static_cast<std::size_t>(f)];
    return camera.scale * camera.rotation;
  }
  Eigen::Vector2d seen(const Sequence& sequence, Eigen::Index f, Eigen::Index p) const {
    return sequence.tracks.block<2, 1>(2 * f, p) - cameras[static_cast<std::size_t>(f)].translation;
  }
};

// The logarithm of the likelihood, but for a constant; a frame's determinant and squares by way of Lambda.
double expect(const Sequence& sequence, EmState& state) {
  const Eigen::Index terms = state.weights.cols() - 1;
  double likelihood = 0;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    const CameraRows d = state.rows(f);
    Eigen::MatrixXd precision = Eigen::MatrixXd::Identity(terms, terms);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
    double squares = 0;
    for (Eigen::Index p = 0; p < sequence.points(); ++p) {
      if (!sequence.visible(f, p)) continue;
      const Eigen::Map<const Eigen::Matrix3Xd> h(state.basis.col(p).data(), 3, terms + 1);
      const Eigen::Matrix2Xd slopes = d * h.rightCols(terms);
      const Eigen::Vector2d left = state.seen(sequence, f, p) - d * h.col(0);
      precision.noalias() += slopes.transpose() * slopes / state.variance;
      right.noalias() += slopes.transpose() * left / state.variance;
      squares += left.squaredNorm() / state.variance;
    }
    const linear::Llt factor(precision);
    const Eigen::VectorXd mean = factor.solve(right);
    state.covariance[static_cast<std::size_t>(f)] = factor.solve(Eigen::MatrixXd::Identity(terms, terms));
    state.weights.row(f).tail(terms) = mean.transpose();
    const double seen = 2 * static_cast<double>(sequence.visible.row(f).count());
    likelihood -= (squares - right.dot(mean) + seen * std::log(state.variance)) / 2;
    likelihood -= factor.diagonal().array().log().sum();
  }
  return likelihood;
}

void solve_basis(const Sequence& sequence, EmState& state) {
  const Eigen::Index n = state.weights.cols();
  std::vector<Eigen::MatrixXd> blocks;  // E[y y'] (x) D' D
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    Eigen::MatrixXd second = state.weights.row(f).transpose() * state.weights.row(f);
    second.bottomRightCorner(n - 1, n - 1) += state.covariance[static_cast<std::size_t>(f)];
    const Eigen::Matrix3d dd = state.rows(f).transpose() * state.rows(f);
    Eigen::MatrixXd block(3 * n, 3 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) block.block<3, 3>(3 * i, 3 * j) = second(i, j) * dd;
    }
    blocks.push_back(std::move(block));
  }
  for (Eigen::Index p = 0; p < sequence.points(); ++p) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(3 * n);
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      if (!sequence.visible(f, p)) continue;
      normal += blocks[static_cast<std::size_t>(f)];
      const Eigen::Vector3d back = state.rows(f).transpose() * state.seen(sequence, f, p);
      right += (back * state.weights.row(f)).reshaped();
    }
    normal.diagonal().array() += 1e-12 * normal.trace() + 1e-300;
    state.basis.col(p) = linear::solve_ldlt(normal, right);
  }
}

Eigen::Matrix3Xd mean_shape(const EmState& state, Eigen::Index f) {
  Eigen::Matrix3Xd shape = Eigen::Matrix3Xd::Zero(3, state.basis.cols());
  for (Eigen::Index k = 0; k < state.weights.cols(); ++k) {
    shape += state.weights(f, k) * state.basis.middleRows<3>(3 * k);
  }
  return shape;
}

// Q of the camera's term, over visible points.
Eigen::Matrix3d shape_spread(const Sequence& sequence, const EmState& state, Eigen::Index f) {
  const Eigen::Index terms = state.weights.cols() - 1;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (Eigen::Index p = 0; p < sequence.points(); ++p) {
    if (!sequence.visible(f, p)) continue;
    const Eigen::Map<const Eigen::Matrix3Xd> v(state.basis.col(p).data() + 3, 3, terms);
    spread += v * state.covariance[static_cast<std::size_t>(f)] * v.transpose();
  }
  return spread;
}

// Cameras, then sigma^2; the mean of the scales stays 1.
void solve_cameras(const Sequence& sequence, bool free_scales, EmState& state) {
  double scales = 0;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    WeakCamera& camera = state.cameras[static_cast<std::size_t>(f)];
    camera = fit_camera(sequence.tracks.middleRows<2>(2 * f), sequence.visible.row(f), mean_shape(state, f), camera,
                        free_scales, shape_spread(sequence, state, f));
    scales += camera.scale / static_cast<double>(sequence.frames());
  }
  for (WeakCamera& camera : state.cameras) camera.scale /= scales;
  state.basis *= scales;
}

double expected_variance(const Sequence& sequence, const EmState& state) {
  double sum = 0;
  for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
    const CameraRows d = state.rows(f);
    const Eigen::Matrix2Xd at = d * mean_shape(state, f);
    for (Eigen::Index p = 0; p < sequence.points(); ++p) {
      if (sequence.visible(f, p)) sum += (state.seen(sequence, f, p) - at.col(p)).squaredNorm();
    }
    sum += (d * shape_spread(sequence, state, f) * d.transpose()).trace();
  }
  return sum / (2 * static_cast<double>(sequence.visible.count()));
}

// One turn; the likelihood before it.
double turn(const Sequence& sequence, bool free_scales, double floor, EmState& state) {
  throw_if_interrupted();
  const double likelihood = expect(sequence, state);
  solve_basis(sequence, state);
  solve_cameras(sequence, free_scales, state);
  state.variance = std::max(floor, expected_variance(sequence, state));
  return likelihood;
}

// Coordinates of `to` as seen from `from`: turns, logarithms of scales, translations and basis shapes over the size of
// the mean shape, the logarithm of sigma^2.
Eigen::VectorXd between(const EmState& from, const EmState& to) {
  const auto frames = static_cast<Eigen::Index>(from.cameras.size());
  const double size = from.basis.topRows<3>().norm() / std::sqrt(static_cast<double>(from.basis.cols()));
  Eigen::VectorXd way(6 * frames + from.basis.size() + 1);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const WeakCamera &a = from.cameras[static_cast<std::size_t>(f)], &b = to.cameras[static_cast<std::size_t>(f)];
    const Eigen::AngleAxisd turned(Eigen::Matrix3d(completed(a.rotation).transpose() * completed(b.rotation)));
    way.segment<3>(6 * f) = turned.angle() * turned.axis();
    way(6 * f + 3) = std::log(b.scale / a.scale);
    way.segment<2>(6 * f + 4) = (b.translation - a.translation) / size;
  }
  way.segment(6 * frames, from.basis.size()) = (to.basis - from.basis).reshaped() / size;
  way(way.size() - 1) = std::log(to.variance / from.variance);
  return way;
}

EmState gone(EmState state, const Eigen::VectorXd& way) {
  const auto frames = static_cast<Eigen::Index>(state.cameras.size());
  const double size = state.basis.topRows<3>().norm() / std::sqrt(static_cast<double>(state.basis.cols()));
  for (Eigen::Index f = 0; f < frames; ++f) {
    WeakCamera& camera = state.cameras[static_cast<std::size_t>(f)];
    const Eigen::Vector3d turn = way.segment<3>(6 * f);
    const Eigen::AngleAxisd turned(turn.norm(), turn.stableNormalized());
    if (turn.norm() > 0) camera.rotation = nearest_rows(camera.rotation * turned.toRotationMatrix());
    camera.scale *= std::exp(way(6 * f + 3));
    camera.translation += size * way.segment<2>(6 * f + 4);
  }
  state.basis += size * way.segment(6 * frames, state.basis.size()).reshaped(state.basis.rows(), state.basis.cols());
  state.variance *= std::exp(way(way.size() - 1));
  return state;
}

// z: the left singular vectors of the residuals, a row per frame, turned into the frame of reference (R' r).
Eigen::MatrixXd temporal_modes(const Start& start, const Eigen::MatrixXd& rigid, Eigen::Index terms) {
  const Eigen::Index frames = start.w.rows() / 2, points = start.w.cols();
  Eigen::MatrixXd by_frame(frames, 3 * points);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const CameraRows d = start.rows.middleRows<2>(2 * f);
    by_frame.row(f) = (d.transpose() * (start.w.middleRows<2>(2 * f) - d * rigid)).reshaped().transpose();
  }
  const linear::SymmetricEigen<Eigen::MatrixXd> modes(by_frame * by_frame.transpose());
  return std::sqrt(static_cast<double>(frames)) * modes.eigenvectors().rightCols(terms).rowwise().reverse();
}

EmState start_state(const Start& start, Eigen::Index terms) {
  const Eigen::Index frames = start.w.rows() / 2;
  EmState state;
  for (Eigen::Index f = 0; f < frames; ++f) {
    state.cameras.push_back({start.upgrade.rotations[static_cast<std::size_t>(f)], start.upgrade.scales(f),
                             start.translation.segment<2>(2 * f)});
  }
  const Eigen::MatrixXd rigid = linear::PivotedQr(start.rows).solve(start.w);
  state.basis = Eigen::MatrixXd::Zero(3 * (terms + 1), start.w.cols());
  state.basis.topRows<3>() = rigid;
  state.weights = Eigen::MatrixXd::Ones(frames, terms + 1);
  state.weights.rightCols(terms) = temporal_modes(start, rigid, terms);
  state.covariance.assign(static_cast<std::size_t>(frames), 0.1 * Eigen::MatrixXd::Identity(terms, terms));
  return state;
}

// Shapes that so many points and frames can have.
Eigen::Index most_shapes(const Sequence& sequence) {
  return std::max<Eigen::Index>(1, std::min(sequence.points() - 1, 2 * sequence.frames()) / 3);
}

class EmPpca : public Solver {
 public:
  const SolverInfo& info() const override {
    static const SolverInfo info{
        "em_ppca",
        "probabilistic principal components (EM-PPCA)",
        "Shapes are a mean and K deformations with normal weights, integrated out; likeliest cameras and shapes.",
        "Torresani, Hertzmann & Bregler, PAMI 30 (2008), sections 3 and 4",
        Prior::shape_basis,
        true,
        true,
        false,
        {rank_parameter("deformations besides the mean shape, K", "from the singular values of the tracks"),
         {"extrapolate", 0, 0, 1, true, "1: faster turns, up to the greatest likelihood; 0: 150 plain turns at most"},
         camera_rank_parameter(),
         free_scales_parameter()}};
    return info;
  }

  Solution solve(const Sequence& sequence, const SolverOptions& options) const override {
    const bool free_scales = free_scales_of(info(), sequence, options);
    const Eigen::Index rank = std::max<Eigen::Index>(1, terms_of(info(), sequence, options, "rank", 1e-2, 8));
    Solution solution;
    const Start start = start_for(info(), sequence, options, std::min(rank + 1, most_shapes(sequence)), solution);
    EmState state = start_state(start, rank);
    solve_basis(sequence, state);
    state.variance = expected_variance(sequence, state);
    const bool extrapolate = values_in_force(info(), options.values).at("extrapolate") > 0;
    const int most = options.most_iterations > 0 ? options.most_iterations : extrapolate ? 600 : 150;
    const Climb found = climb(sequence, free_scales, extrapolate, most, state);
    solution.iterations = found.turns;
    solution.converged = found.converged;
    if (!found.converged) solution.notes.push_back(gain_note(found.gain));
    solution.values["extrapolate"] = extrapolate ? 1 : 0;
    fill_answer(sequence, state, solution.reconstruction);
    solution.values["rank"] = static_cast<double>(rank);
    return solution;
  }

 private:
  struct Climb {
    int turns = 0;
    double gain = 0;  // of the last turns, of the likelihood's logarithm for each number seen
    bool converged = false;
  };

  // Turns, or with `extrapolate` rounds of two turns and a third from where they lead to, which counts where it is
  // likelier than the first turn's end.
  static Climb climb(const Sequence& sequence, bool free_scales, bool extrapolate, int most, EmState& state) {
    const double seen = 2 * static_cast<double>(sequence.visible.count());
    const double floor = 1e-14 * centred(sequence).w.squaredNorm() / seen;
    double before = -std::numeric_limits<double>::infinity();
    Extrapolation extrapolation;
    Climb climb;
    state.variance = std::max(state.variance, floor);
    while (climb.turns < most) {
      EmState once = state;
      const double likelihood = turn(sequence, free_scales, floor, once);
      climb.gain = (likelihood - before) / seen;
      climb.converged = climb.gain <= kGain;
      if (climb.converged) break;
      before = likelihood;
      climb.turns += extrapolate ? 3 : 1;
      if (!extrapolate) {
        state = std::move(once);
        continue;
      }
      EmState twice = once;
      const double reached = turn(sequence, free_scales, floor, twice);
      EmState ahead = gone(state, extrapolation(between(state, once), between(state, twice)));
      ahead.variance = std::max(ahead.variance, floor);
      const double there = turn(sequence, free_scales, floor, ahead);
      extrapolation.judge(there >= reached);
      state = there >= reached ? std::move(ahead) : std::move(twice);
    }
    return climb;
  }

  static std::string gain_note(double gain) {
    char text[160];
    std::snprintf(text, sizeof text, "ended early: the last turns made each track likelier by a factor of %.2g",
                  std::exp(2 * gain));
    return text;
  }

  static void fill_answer(const Sequence& sequence, const EmState& state, Reconstruction& answer) {
    answer.shapes.resize(3 * sequence.frames(), sequence.points());
    for (Eigen::Index f = 0; f < sequence.frames(); ++f) {
      const Eigen::Matrix3Xd shape = mean_shape(state, f);
      shape_of(answer.shapes, f) = shape.colwise() - shape.rowwise().mean();
      answer.rotations.push_back(state.cameras[static_cast<std::size_t>(f)].rotation);
    }
    turn_to_first_camera(answer);
  }
};

}  // namespace

const Solver& em_ppca() {
  static const EmPpca solver;
  return solver;
}

}  // namespace gonio::nrsfm::solvers
