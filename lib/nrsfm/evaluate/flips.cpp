// Frames that are mirrored although most are not (errors.h). With C = sum y q' of a frame, both centred, y after the
// sequence's similarity:
//   -y:              |-y - q|^2 - |y - q|^2 = 4 tr C,          r = tr C / (|y| |q|)
//   y - 2 n (n . y): the difference is 4 n' C n,               r = n' C n / (|n . y| |n . q|)
// Of unknown n the least n' C n: the eigenvector of the least eigenvalue of (C + C') / 2. The similarity itself suffers
// from flips, so that it is found again without those found, until they stay.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "linear/symmetric_eigen.h"
#include "nrsfm/evaluate/errors.h"
#include "stats/distributions.h"
#include "stats/intervals.h"

namespace gonio::nrsfm {
namespace {

constexpr double most_correlation = 1 - 1e-12;
constexpr int most_rounds = 6;
constexpr Eigen::Index blocks = 20;
constexpr double clear_p = 1e-3;

struct FrameSums {
  Eigen::Index points = 0;
  Eigen::Matrix3d yq = Eigen::Matrix3d::Zero(), yy = yq, qq = yq;
  double square = 0;  // sum |y - q|^2, not centred
};

FrameSums sums_of(const Eigen::Matrix3Xd& y, const Eigen::Matrix3Xd& q) {
  FrameSums s;
  std::vector<Eigen::Index> both;
  for (Eigen::Index p = 0; p < y.cols(); ++p)
    if (is_finite(y.col(p)) && is_finite(q.col(p))) both.push_back(p);
  s.points = static_cast<Eigen::Index>(both.size());
  if (both.empty()) return s;
  const Eigen::Matrix3Xd a = y(Eigen::all, both), b = q(Eigen::all, both);
  const Eigen::Matrix3Xd ac = a.colwise() - a.rowwise().mean(), bc = b.colwise() - b.rowwise().mean();
  s.yq = ac * bc.transpose(), s.yy = ac * ac.transpose(), s.qq = bc * bc.transpose();
  s.square = (a - b).squaredNorm();
  return s;
}

struct Candidate {
  double z = 0, gain = 0;                            // gain: how much the sum of squares falls when the flip is undone
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // in the truth's frame
  bool known = false;
};

double fisher(double covariance, double variance_a, double variance_b) {
  const double product = variance_a * variance_b;
  const double r = product > 0 ? covariance / std::sqrt(product) : 0;
  return std::atanh(std::clamp(r, -most_correlation, most_correlation));
}

Candidate candidate(const FrameSums& s, FlipKind kind, const Eigen::Vector3d* depth) {
  Candidate c;
  if (s.points < 4) return c;
  c.known = true;
  if (kind == FlipKind::mirror) {
    c.z = fisher(s.yq.trace(), s.yy.trace(), s.qq.trace());
    c.gain = -4 * s.yq.trace();
    return c;
  }
  if (depth != nullptr) {
    c.normal = *depth;
  } else {
    const linear::SymmetricEigen<Eigen::Matrix3d> solver(0.5 * (s.yq + s.yq.transpose()));
    c.normal = solver.eigenvectors().col(0);
  }
  const double along = c.normal.dot(s.yq * c.normal);
  c.z = fisher(along, c.normal.dot(s.yy * c.normal), c.normal.dot(s.qq * c.normal));
  c.gain = -4 * along;
  return c;
}

// Probability of so low a z among frames that are not flipped; 1 where z is not negative.
std::vector<double> probabilities(const std::vector<Candidate>& frames) {
  std::vector<double> z, above;
  for (const Candidate& c : frames)
    if (c.known) z.push_back(c.z);
  std::vector<double> p(frames.size(), 1);
  if (z.size() < 8) return p;
  const double centre = stats::median(z);
  for (const double v : z)
    if (v >= centre) above.push_back(v - centre);
  const double sigma = std::max(stats::sigma_of_median * stats::median(above), 1e-9);
  for (std::size_t f = 0; f < frames.size(); ++f)
    if (frames[f].known && frames[f].z < 0) p[f] = stats::normal_cdf((frames[f].z - centre) / sigma);
  return p;
}

// One round: flips of x as it stands after `s`.
std::vector<Flip> flips_after(const Shapes& x, const Shapes& truth, const Similarity& s, const FlipOptions& options) {
  const Eigen::Index frames = x.rows() / 3;
  std::vector<std::vector<Candidate>> candidates(2);
  std::vector<FrameSums> sums;
  for (Eigen::Index f = 0; f < frames; ++f) {
    sums.push_back(sums_of(moved(s, shape_of(x, f)), shape_of(truth, f)));
    Eigen::Vector3d depth;
    if (!options.depth.empty()) depth = (s.rotation * options.depth[static_cast<std::size_t>(f)]).normalized();
    candidates[0].push_back(candidate(sums.back(), FlipKind::depth_reversal, options.depth.empty() ? nullptr : &depth));
    candidates[1].push_back(candidate(sums.back(), FlipKind::mirror, nullptr));
  }
  const double limit = options.false_alarm / (2 * static_cast<double>(frames));
  const std::vector<double> p[2] = {probabilities(candidates[0]), probabilities(candidates[1])};
  std::vector<Flip> flips;
  for (Eigen::Index f = 0; f < frames; ++f) {
    const auto i = static_cast<std::size_t>(f);
    if (std::min(p[0][i], p[1][i]) >= limit) continue;
    // Of both kinds, the one that explains more.
    const bool mirror = p[1][i] < limit && (p[0][i] >= limit || candidates[1][i].gain > candidates[0][i].gain);
    const Candidate& c = candidates[mirror ? 1 : 0][i];
    const double n = static_cast<double>(sums[i].points);
    flips.push_back({f, mirror ? FlipKind::mirror : FlipKind::depth_reversal, std::sqrt(sums[i].square / n),
                     std::sqrt(std::max(0.0, sums[i].square - c.gain) / n), s.rotation.transpose() * c.normal});
  }
  return flips;
}

// Between order statistics, as stats::quantile, of values that it may reorder.
double quantile_of(Eigen::VectorXd& values, double p) {
  const double rank = p * static_cast<double>(values.size() - 1);
  double* const below = values.data() + static_cast<Eigen::Index>(rank);
  double* const end = values.data() + values.size();
  std::nth_element(values.data(), below, end);
  const double above = below + 1 < end ? *std::min_element(below + 1, end) : *below;
  return *below + (rank - std::floor(rank)) * (above - *below);
}

// Mean over blocks of frames of how much larger the truncated squares are with `other`, over its standard error.
double paired_z(const Shapes& x, const Shapes& truth, const RobustError& e) {
  const Matched m = matched(x, truth);
  const Eigen::Index frames = x.rows() / 3, count = std::min(blocks, frames);
  const auto truncated = [&](const Similarity& s) {
    const Eigen::VectorXd d2 = (moved(s, m.x) - m.q).colwise().squaredNorm();
    Eigen::VectorXd d = d2.cwiseSqrt();
    const double w = 2.5 * quantile_of(d, 0.75) - 1.5 * quantile_of(d, 0.25);
    return Eigen::VectorXd(d2.cwiseMin(w * w));
  };
  const Eigen::VectorXd difference = truncated(e.other) - truncated(e.alignment);
  std::vector<double> sum(static_cast<std::size_t>(count)), n(sum.size()), means;
  for (Eigen::Index i = 0; i < difference.size(); ++i) {
    const auto b = static_cast<std::size_t>(m.frame[static_cast<std::size_t>(i)] * count / frames);
    sum[b] += difference(i), n[b] += 1;
  }
  for (std::size_t b = 0; b < sum.size(); ++b)
    if (n[b] > 0) means.push_back(sum[b] / n[b]);
  if (means.size() < 2) return 0;
  const double error = stats::standard_error(means);
  return stats::mean(means) / std::max(error, std::numeric_limits<double>::min());
}

bool same(const std::vector<Flip>& a, const std::vector<Flip>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Flip& x, const Flip& y) {
           return x.frame == y.frame && x.kind == y.kind;
         });
}

}  // namespace

Shapes without_flips(const Shapes& x, const std::vector<Flip>& flips) {
  Shapes out = x;
  for (const Flip& flip : flips) {
    auto shape = shape_of(out, flip.frame);
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double n = 0;
    for (Eigen::Index p = 0; p < shape.cols(); ++p)
      if (is_finite(shape.col(p))) centre += shape.col(p), n += 1;
    if (n == 0) continue;
    centre /= n;
    for (Eigen::Index p = 0; p < shape.cols(); ++p) {
      const Eigen::Vector3d v = shape.col(p) - centre;
      shape.col(p) = flip.kind == FlipKind::mirror ? Eigen::Vector3d(centre - v)
                                                   : Eigen::Vector3d(centre + v - 2 * flip.depth * flip.depth.dot(v));
    }
  }
  return out;
}

Flips find_flips(const Shapes& x, const Shapes& truth, const FlipOptions& options, const RobustError* known) {
  check_comparable(x, truth);
  if (!options.depth.empty() && static_cast<Eigen::Index>(options.depth.size()) != x.rows() / 3)
    throw Error(Exit::data, "directions of depth",
                "are " + std::to_string(options.depth.size()) + " for " + std::to_string(x.rows() / 3) + " frames");
  Flips out;
  RobustError error = known != nullptr ? *known : robust_error(x, truth);
  for (int round = 0; round < most_rounds; ++round) {
    const std::vector<Flip> flips = flips_after(x, truth, error.alignment, options);
    const bool settled = same(flips, out.frames);
    out.frames = flips;
    if (settled) break;
    error = robust_error(without_flips(x, out.frames), truth);
  }
  if (std::isfinite(error.other_hand)) {
    out.mirrored_z = paired_z(without_flips(x, out.frames), truth, error);
    const double degrees = static_cast<double>(std::min(blocks, x.rows() / 3) - 1);
    out.whole_sequence_mirrored = error.alignment.mirrored() && stats::student_upper(out.mirrored_z, degrees) < clear_p;
  }
  out.error = error;
  return out;
}

}  // namespace gonio::nrsfm
