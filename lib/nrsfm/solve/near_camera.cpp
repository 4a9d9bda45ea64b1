// See near_camera.h.
#include "nrsfm/solve/near_camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/random.h"
#include "nrsfm/solve/deforming_fit.h"
#include "stats/distributions.h"

namespace gonio::nrsfm {
namespace {

constexpr std::size_t numbers_of_shapes = 2;  // K and K + 1
constexpr std::uint64_t folds = 4;            // of the observations
constexpr auto stretches = static_cast<Eigen::Index>(NearCamera::stretches);
constexpr double starts[] = {0, 0.3, -0.3};                           // kappa times the largest depth
constexpr double least_gain = 0.1, least_t = 2, least_bought = 0.25;  // what a name needs; t: points' and stretches'
constexpr int steps_to_settle = 6, steps_of_a_fold = 4, rounds_of_exchange = 2;

struct Pair {
  DeformingFit without, with;
};

UsedTracks used_tracks(const Sequence& s, const SolvedModel& m) {
  UsedTracks t{Eigen::MatrixXd::Zero(2 * m.frame_count(), m.point_count()),
               Eigen::ArrayXXd::Zero(m.frame_count(), m.point_count())};
  for (Eigen::Index f = 0; f < m.frame_count(); ++f)
    for (Eigen::Index p = 0; p < m.point_count(); ++p) {
      const Eigen::Index frame = m.frames[static_cast<std::size_t>(f)], point = m.points[static_cast<std::size_t>(p)];
      if (!s.visible(frame, point)) continue;
      t.used(f, p) = 1;
      t.tracks.block<2, 1>(2 * f, p) = s.tracks.block<2, 1>(2 * frame, point);
    }
  return t;
}

DeformingShape shape_of(const SolvedModel& m) {
  DeformingShape s{m.rotation,
                   m.translation,
                   m.log_scale.array().exp().matrix().asDiagonal() * (m.omega * m.x),
                   Eigen::MatrixXd(3 * m.terms(), m.point_count()),
                   m.centre,
                   0};
  for (Eigen::Index p = 0; p < m.point_count(); ++p) s.basis.col(p) = m.basis[static_cast<std::size_t>(p)].reshaped();
  return s;
}

DeformingFit without_perspective(const UsedTracks& tracks, DeformingShape start) {
  start.kappa = 0;
  return fit_deforming(tracks, std::move(start), {});
}

DeformingFit with_perspective(const UsedTracks& tracks, DeformingShape start, double share) {
  if (share != 0) {
    start.kappa = share / start.depth();
    start = fit_deforming(tracks, std::move(start), {.most_steps = steps_to_settle, .tolerance = 1e-3}).shape;
  }
  return fit_deforming(tracks, std::move(start), {.perspective = true});
}

void take_lower(DeformingFit& best, DeformingFit other) {
  if (other.squares < best.squares) best = std::move(other);
}

// `further`: where the pair of one shape less, with a shape more, would begin.
Pair fitted_pair(const UsedTracks& tracks, const DeformingShape& start, const DeformingShape* further) {
  Pair pair;
  pair.without = without_perspective(tracks, start);
  std::vector<DeformingFit> tried(std::size(starts) + (further == nullptr ? 0 : 1));
  parallel_for(0, tried.size(), [&](std::size_t k) {
    tried[k] = k < std::size(starts) ? with_perspective(tracks, pair.without.shape, starts[k])
                                     : with_perspective(tracks, *further, 0);
  });
  pair.with = tried[0];
  for (DeformingFit& one : tried) take_lower(pair.with, std::move(one));
  for (int round = 0; round < rounds_of_exchange; ++round) {
    take_lower(pair.without, without_perspective(tracks, pair.with.shape));
    if (pair.with.squares < pair.without.squares) break;
    take_lower(pair.with, with_perspective(tracks, pair.without.shape, 0));
  }
  return pair;
}

// Squared distances of observations from where the others put them.
Eigen::ArrayXXd held_out(const UsedTracks& tracks, const DeformingShape& shape, bool perspective) {
  std::vector<Eigen::MatrixXd> parts(folds);
  parallel_for(0, folds, [&](std::size_t fold) {
    UsedTracks fitted = tracks, judged = tracks;
    for (Eigen::Index p = 0; p < tracks.used.cols(); ++p)
      for (Eigen::Index f = 0; f < tracks.used.rows(); ++f)
        (split_mix(static_cast<std::uint64_t>(tracks.used.rows() * p + f)) % folds == fold ? fitted : judged)
            .used(f, p) = 0;
    const DeformingFit fit =
        fit_deforming(fitted, shape, {.perspective = perspective, .most_steps = steps_of_a_fold, .tolerance = 1e-3});
    parts[fold] = residuals(judged, fit.shape);
  });
  Eigen::ArrayXXd squares = Eigen::ArrayXXd::Zero(tracks.used.rows(), tracks.used.cols());
  for (const Eigen::MatrixXd& r : parts)
    for (Eigen::Index f = 0; f < squares.rows(); ++f)
      squares.row(f) += r.middleRows<2>(2 * f).colwise().squaredNorm().array();
  return squares;
}

Eigen::ArrayXd by_stretches(const Eigen::ArrayXXd& of_observations) {
  Eigen::ArrayXd sums = Eigen::ArrayXd::Zero(stretches);
  for (Eigen::Index f = 0; f < of_observations.rows(); ++f)
    sums(f * stretches / of_observations.rows()) += of_observations.row(f).sum();
  return sums;
}

// Log of a ratio of root mean squares, one for each witness: none speaks louder for lying farther off.
Eigen::ArrayXd log_ratios(const Eigen::ArrayXd& squares, const Eigen::ArrayXd& of_squares) {
  constexpr double tiny = std::numeric_limits<double>::min();
  return 0.5 * ((squares + tiny) / (of_squares + tiny)).log();
}

// Mean over its standard error.
double student_t(const Eigen::ArrayXd& witnesses) {
  const double n = static_cast<double>(witnesses.size()), mean = witnesses.mean();
  const double variance = (witnesses - mean).square().sum() / (n * (n - 1));
  return variance > 0 ? mean / std::sqrt(variance) : 0;
}

// Of kappa: what single stretches of frames pull it by.
double sandwich_sigma(const UsedTracks& tracks, const DeformingShape& shape, const PerspectiveColumn& column) {
  const Eigen::ArrayXXd pull = column.surviving.array() * residuals(tracks, shape).array();
  Eigen::ArrayXXd of_observations(tracks.used.rows(), tracks.used.cols());
  for (Eigen::Index f = 0; f < of_observations.rows(); ++f)
    of_observations.row(f) = pull.middleRows<2>(2 * f).colwise().sum();
  const double few = static_cast<double>(stretches) / static_cast<double>(stretches - 1);
  return std::sqrt(few * by_stretches(of_observations).square().sum()) / column.surviving.squaredNorm();
}

struct Judged {
  NearCamera::Step step;
  Eigen::ArrayXd of_points;  // held out, without: sums of squares
};

Judged judged(const UsedTracks& tracks, const Pair& pair) {
  const double count = std::max(1.0, tracks.used.sum());
  const Eigen::ArrayXXd without = held_out(tracks, pair.without.shape, false);
  const Eigen::ArrayXXd with = held_out(tracks, pair.with.shape, true);
  Judged result{{}, without.colwise().sum().transpose()};
  NearCamera::Step& step = result.step;
  step.shapes = static_cast<std::size_t>(pair.with.shape.terms());
  step.fitted_without = std::sqrt(pair.without.squares / count);
  step.fitted_with = std::sqrt(pair.with.squares / count);
  step.held_out_without = std::sqrt(without.sum() / count);
  step.held_out_with = std::sqrt(with.sum() / count);
  const Eigen::ArrayXd points = log_ratios(result.of_points, with.colwise().sum().transpose());
  step.log_gain = points.mean();
  step.t_of_points = student_t(points);
  step.t_of_stretches = student_t(log_ratios(by_stretches(without), by_stretches(with)));
  const PerspectiveColumn column = perspective_column(tracks, pair.with.shape);
  step.kappa = pair.with.shape.kappa;
  step.sigma = sandwich_sigma(tracks, pair.with.shape, column);
  step.depth = pair.with.shape.depth();
  const PerspectiveColumn at_zero = perspective_column(tracks, pair.without.shape);
  step.surviving_share = std::sqrt(at_zero.surviving.squaredNorm() / at_zero.whole.squaredNorm());
  const double worth = pair.without.squares * (1 / ((1 - least_gain) * (1 - least_gain)) - 1);
  step.visible_from = std::sqrt(worth / at_zero.surviving.squaredNorm()) * pair.without.shape.depth();
  return result;
}

bool stands(const NearCamera::Step& step, double of_next_shape) {
  return step.log_gain > -std::log(1 - least_gain) && step.t_of_points > least_t && step.t_of_stretches > least_t &&
         step.log_gain > least_bought * of_next_shape &&
         std::abs(step.kappa) > stats::student_quantile(0.995, static_cast<double>(stretches - 1)) * step.sigma;
}

void write_rows(const UsedTracks& tracks, const DeformingShape& shape, std::vector<double>& rows) {
  const Eigen::MatrixXd r = residuals(tracks, shape);
  for (Eigen::Index p = 0; p < tracks.used.cols(); ++p)
    for (Eigen::Index f = 0; f < tracks.used.rows(); ++f)
      if (tracks.used(f, p) > 0) rows.insert(rows.end(), {r(2 * f, p), r(2 * f + 1, p)});
}

}  // namespace

SolvedModel settled(const Sequence& sequence, SolvedModel model) {
  if (model.held.any() || model.omega.rows() != model.omega.cols() ||
      !model.omega.isIdentity())  // weights of frames that take part, each by itself
    return model;
  const DeformingShape s = without_perspective(used_tracks(sequence, model), shape_of(model)).shape;
  model.rotation = s.rotation;
  model.translation = s.shift;
  model.x = model.log_scale.array().exp().inverse().matrix().asDiagonal() * s.weights;
  for (std::size_t p = 0; p < model.basis.size(); ++p)
    model.basis[p] = s.basis.col(static_cast<Eigen::Index>(p)).reshaped(3, s.terms());
  return model;
}

NearCamera find_near_camera(const Sequence& sequence, const SolvedModel& model, double enough) {
  const UsedTracks tracks = used_tracks(sequence, model);
  NearCamera result;
  std::vector<Judged> all;
  DeformingShape start = shape_of(model), further = start;
  const DeformingFit first = without_perspective(tracks, start);
  result.lacking = first.squares > enough * enough * tracks.used.sum();
  if (!result.lacking) return result;
  start = first.shape;
  for (std::size_t k = 0; k < numbers_of_shapes; ++k) {
    const Pair pair = fitted_pair(tracks, start, k == 0 ? nullptr : &further);
    all.push_back(judged(tracks, pair));
    result.steps.push_back(all.back().step);
    if (k == 0) {
      write_rows(tracks, pair.without.shape, result.residual_without);
      write_rows(tracks, pair.with.shape, result.residual_with);
    }
    start = with_further_shape(tracks, pair.without.shape);
    further = with_further_shape(tracks, pair.with.shape);
  }
  const double of_a_shape = std::max(0.0, log_ratios(all[0].of_points, all[1].of_points).mean());
  result.of_a_shape = of_a_shape;
  result.stands = result.steps[0].kappa * result.steps[1].kappa > 0;
  for (const NearCamera::Step& step : result.steps) result.stands = result.stands && stands(step, of_a_shape);
  // Two numbers of shapes say two things of kappa: what they differ by is not known, either.
  const NearCamera::Step& last = result.steps.back();
  const double apart = last.kappa - result.steps.front().kappa;
  const double reach = stats::student_quantile(0.975, static_cast<double>(stretches - 1));
  result.sigma = std::hypot(last.sigma, apart);
  result.lower = last.kappa - reach * result.sigma, result.upper = last.kappa + reach * result.sigma;
  return result;
}

}  // namespace gonio::nrsfm
