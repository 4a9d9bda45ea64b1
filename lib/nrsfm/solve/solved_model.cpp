// See solved_model.h. With M the F x 3P matrix of shapes, one row a frame, M = c B is its truncated singular value
// decomposition; c = sqrt(F) U, so that weights are of the order of one.
#include "nrsfm/solve/solved_model.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "linear/qr.h"
#include "linear/svd.h"
#include "nrsfm/solve/factorization.h"

namespace gonio::nrsfm {
namespace {

constexpr Eigen::Index most_frames = 48, most_points = 40, fewest_points = 8, fewest_frames = 8;
constexpr double shape_share = 1e-3, cosine_share = 1e-3;

std::string text(Eigen::Index n) {
  return std::to_string(n);
}

std::vector<Eigen::Index> evenly(const std::vector<Eigen::Index>& all, Eigen::Index most) {
  const auto n = static_cast<Eigen::Index>(all.size());
  if (n <= most) return all;
  std::vector<Eigen::Index> taken;
  for (Eigen::Index k = 0; k < most; ++k) taken.push_back(all[static_cast<std::size_t>(k * n / most)]);
  return taken;
}

std::vector<Eigen::Index> estimated_points(const Reconstruction& r) {
  std::vector<Eigen::Index> points;
  for (Eigen::Index p = 0; p < r.points(); ++p)
    if (r.shapes.col(p).allFinite()) points.push_back(p);
  return points;
}

Eigen::MatrixXd one_row_a_frame(const Reconstruction& r, const std::vector<Eigen::Index>& points) {
  Eigen::MatrixXd m(r.frames(), 3 * static_cast<Eigen::Index>(points.size()));
  for (Eigen::Index f = 0; f < r.frames(); ++f)
    for (std::size_t p = 0; p < points.size(); ++p)
      m.block<1, 3>(f, 3 * static_cast<Eigen::Index>(p)) = shape_of(r.shapes, f).col(points[p]).transpose();
  return m;
}

// Weights of all frames, and the family that they may move in.
struct Weights {
  Eigen::MatrixXd omega, x;  // F x d, d x K
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> held;
};

Weights within(Eigen::MatrixXd omega, Eigen::MatrixXd x, bool held) {
  const Eigen::Index d = x.rows(), terms = x.cols();
  return {std::move(omega), std::move(x), Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>::Constant(d, terms, held)};
}

Weights weights_of(const Eigen::MatrixXd& u) {
  const Eigen::Index frames = u.rows(), terms = u.cols();
  const double size = std::sqrt(static_cast<double>(frames));
  const Eigen::MatrixXd cosines = dct_basis(frames, frames), spectrum = cosines.transpose() * u;
  Eigen::Index d = frames;
  double beyond = 0;
  while (d > terms && (beyond += spectrum.row(d - 1).squaredNorm()) <= cosine_share * cosine_share * double(terms)) --d;
  if (d == terms) return within(size * cosines.leftCols(d), Eigen::MatrixXd::Identity(d, d), true);
  return within(Eigen::MatrixXd::Identity(frames, frames), size * u, false);
}

// Rows of `omega` for the frames that take part; columns that vanish there go.
void take_frames(const Weights& all, SolvedModel& model) {
  const Eigen::MatrixXd omega = all.omega(model.frames, Eigen::all);
  std::vector<Eigen::Index> used;
  for (Eigen::Index j = 0; j < omega.cols(); ++j)
    if (omega.col(j).squaredNorm() > 0) used.push_back(j);
  model.omega = omega(Eigen::all, used);
  model.x = all.x(used, Eigen::all);
  model.held = all.held(used, Eigen::all);
}

struct FrameFit {  // tracks = s R S + t
  double dot = 0, energy = 0;
  Eigen::Vector2d track_mean = Eigen::Vector2d::Zero(), seen_mean = Eigen::Vector2d::Zero();
};
FrameFit fit_of(const Sequence& s, const SolvedModel& m, Eigen::Index f) {
  FrameFit fit;
  const Eigen::Index frame = m.frames[static_cast<std::size_t>(f)];
  std::vector<Eigen::Vector2d> tracks, seen;
  for (std::size_t p = 0; p < m.points.size(); ++p) {
    if (!s.visible(frame, m.points[p])) continue;
    tracks.emplace_back(s.tracks.block<2, 1>(2 * frame, m.points[p]));
    const Eigen::Vector3d q =
        m.rotation[static_cast<std::size_t>(f)] * (m.basis[p] * (m.omega.row(f) * m.x).transpose());
    seen.emplace_back(q.head<2>());
    fit.track_mean += tracks.back();
    fit.seen_mean += seen.back();
  }
  const double count = std::max(1.0, static_cast<double>(tracks.size()));
  fit.track_mean /= count;
  fit.seen_mean /= count;
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    fit.dot += (tracks[k] - fit.track_mean).dot(seen[k] - fit.seen_mean);
    fit.energy += (seen[k] - fit.seen_mean).squaredNorm();
  }
  return fit;
}

// Scales and translations by least squares; the scales' geometric mean goes into the shapes.
void place_frames(const Solved& solved, SolvedModel& m) {
  const Eigen::Index frames = m.frame_count();
  std::vector<FrameFit> fits;
  double dot = 0, energy = 0;
  for (Eigen::Index f = 0; f < frames; ++f) {
    fits.push_back(fit_of(solved.sequence, m, f));
    dot += fits.back().dot;
    energy += fits.back().energy;
  }
  const double common = dot > 0 && energy > 0 ? dot / energy : 1;
  m.log_scale.resize(frames);
  m.translation.resize(2, frames);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const FrameFit& fit = fits[static_cast<std::size_t>(f)];
    const bool own = solved.free_scales && fit.dot > 0 && fit.energy > 0;
    m.log_scale(f) = std::log(own ? fit.dot / fit.energy : common);
    m.translation.col(f) = fit.track_mean - std::exp(m.log_scale(f)) * fit.seen_mean;
  }
  const double mean = m.log_scale.mean();
  m.log_scale.array() -= mean;
  for (Eigen::MatrixXd& b : m.basis) b *= std::exp(mean);
}

void take_points(const Solved& solved, const std::vector<Eigen::Index>& estimated, Eigen::Index terms, bool all,
                 SolvedModel& m) {
  std::vector<Eigen::Index> enough;
  const Eigen::Index least = std::max(fewest_frames, 3 * terms);
  for (const Eigen::Index p : estimated) {
    Eigen::Index seen = 0;
    for (const Eigen::Index f : m.frames) seen += solved.sequence.visible(f, p);
    if (seen >= least) enough.push_back(p);
  }
  const Eigen::Index needed = std::max(fewest_points, (5 + terms + 1) / 2 + 2);
  if (static_cast<Eigen::Index>(enough.size()) < needed)
    throw Error(Exit::data, solved.place,
                "has " + text(static_cast<Eigen::Index>(enough.size())) + " points that are seen in " + text(least) +
                    " frames, and " + text(needed) + " are the least for " + text(terms) + " shapes",
                "track more points over more frames, or solve with a lower rank");
  m.points = all ? enough : evenly(enough, std::max(most_points, 2 * needed));
}

}  // namespace

SolvedModel solved_model(const Solved& solved, bool all) {
  const Sequence& s = solved.sequence;
  const Reconstruction& r = solved.reconstruction;
  if (r.rotations.empty())
    throw Error(Exit::data, solved.place, "has no rotations", "solve with nrsfm-solve, which writes them (R)");
  if (r.frames() != s.frames() || r.points() != s.points() ||
      static_cast<Eigen::Index>(r.rotations.size()) != s.frames())
    throw Error(Exit::data, solved.place,
                "has " + text(r.frames()) + " frames of " + text(r.points()) + " points where its sequence has " +
                    text(s.frames()) + " of " + text(s.points()));
  const std::vector<Eigen::Index> estimated = estimated_points(r);
  if (static_cast<Eigen::Index>(estimated.size()) < fewest_points)
    throw Error(Exit::data, solved.place,
                "estimates " + text(static_cast<Eigen::Index>(estimated.size())) + " points in all frames, " +
                    text(fewest_points) + " are the least");
  const Eigen::MatrixXd shapes = one_row_a_frame(r, estimated);
  const linear::DividedSvd svd(shapes, Eigen::ComputeThinU);
  const double total = svd.singularValues().squaredNorm();
  Eigen::Index terms = svd.singularValues().size();
  double left = 0;
  while (terms > 1 && (left += std::pow(svd.singularValues()(terms - 1), 2)) <= shape_share * shape_share * total)
    --terms;

  SolvedModel m;
  std::vector<Eigen::Index> every(static_cast<std::size_t>(s.frames()));
  for (std::size_t f = 0; f < every.size(); ++f) every[f] = static_cast<Eigen::Index>(f);
  m.frames = all ? every : evenly(every, std::max(most_frames, 5 * terms));
  take_points(solved, estimated, terms, all, m);
  for (const Eigen::Index f : m.frames) m.rotation.push_back(completed(r.rotations[static_cast<std::size_t>(f)]));
  const Weights weights = weights_of(svd.matrixU().leftCols(terms));
  take_frames(weights, m);
  const Eigen::MatrixXd basis = linear::PivotedQr(weights.omega * weights.x).solve(one_row_a_frame(r, m.points));
  for (Eigen::Index p = 0; p < m.point_count(); ++p) m.basis.emplace_back(basis.middleCols<3>(3 * p).transpose());
  place_frames(solved, m);
  m.centre = s.pinhole ? Eigen::Vector2d(s.pinhole->cx_px, s.pinhole->cy_px) : m.translation.rowwise().mean().eval();
  return m;
}

}  // namespace gonio::nrsfm
