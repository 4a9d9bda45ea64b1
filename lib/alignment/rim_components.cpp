// See rim_components.h.
#include "alignment/rim_components.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "alignment/seen_points.h"

namespace gonio::alignment {
namespace {

using Eigen::Index;

constexpr double fewest_lengths = 2;  // of what is alike in any case, that a piece is long
constexpr double pieces_around = 8;   // of a rim, about

struct Piece {
  std::size_t mask = 0;  // place of the first sighting of its rim
  bool shadow = false;
  double weight = 0, points = 0, offset = 0, noise = 0;  // sums over its points
  Eigen::VectorXd score, slope;                          // s, and the sum of w j
};

// Of each sighting, the first one that shows the same rim: one mask, or one that errs like it.
std::vector<std::size_t> masks_of(const Question& q) {
  std::vector<std::size_t> mask(q.sightings.size());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    mask[i] = i;
    for (std::size_t k = 0; k < i && mask[i] == i; ++k)
      if (q.sightings[k].subject == q.sightings[i].subject) mask[i] = k;
  }
  return mask;
}

double piece_length(const Sighting& sighting, double length_px) {
  double longest = 0;
  for (const RimPoint& p : sighting.points) longest = std::max(longest, p.arc_px);
  return std::max({fewest_lengths * length_px, longest / pieces_around, 8.0});
}

std::vector<Piece> pieces_of(const Question& q, const Fitted& f, const std::vector<RimSlopes>& slopes,
                             const std::vector<ShortErrors>& short_errors) {
  const auto numbers = static_cast<Index>(numbers_of(q.freedoms));
  const std::vector<std::size_t> masks = masks_of(q);
  std::map<std::tuple<std::size_t, std::uint32_t, long>, Piece> pieces;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    const Sighting &own = q.sightings[i], &first = q.sightings[masks[i]];
    const SightingFit& fit = f.sightings[i];
    const SeenPoints known(first.points);
    const double size = piece_length(first, short_errors[masks[i]].length_px);
    for (std::size_t r = 0; r < slopes[i].used.size(); ++r) {
      const RimPoint& point = own.points[slopes[i].used[r]];
      const auto near = masks[i] == i ? std::optional(slopes[i].used[r]) : known.nearest(point.pixel, point.outward, 4);
      if (!near) continue;
      const RimPoint& place = first.points[*near];
      Piece& piece = pieces[{masks[i], place.loop, static_cast<long>(place.arc_px / size)}];
      if (piece.points == 0) {
        piece.mask = masks[i], piece.shadow = own.subject.lamp.has_value();
        piece.score = piece.slope = Eigen::VectorXd::Zero(numbers);
      }
      const double w = fit.weight[slopes[i].used[r]];
      piece.weight += w, piece.points += 1, piece.offset += w * fit.offset_px[slopes[i].used[r]];
      piece.noise += short_errors[i].variance_px2;
      piece.score += (w / fit.sigma_px) * slopes[i].slopes.row(static_cast<Index>(r)).transpose();
      piece.slope += (w * fit.sigma_px / fit.share) * slopes[i].slopes.row(static_cast<Index>(r)).transpose();
    }
  }
  std::vector<Piece> all;
  for (auto& [place, piece] : pieces)
    if (piece.weight > 0) all.push_back(std::move(piece));
  return all;
}

// Groups that share an error: pieces by themselves, or those of one mask.
struct Grouping {
  bool shadow = false, whole = false;
  std::vector<std::vector<Index>> groups;
};
std::array<Grouping, 4> groupings(const std::vector<Piece>& pieces) {
  std::array<Grouping, 4> all{Grouping{false, true, {}}, {true, true, {}}, {false, false, {}}, {true, false, {}}};
  for (Grouping& g : all) {
    std::map<std::size_t, std::vector<Index>> masks;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      if (pieces[p].shadow != g.shadow) continue;
      masks[g.whole ? pieces[p].mask : p].push_back(static_cast<Index>(p));
    }
    for (auto& [mask, members] : masks) g.groups.push_back(std::move(members));
  }
  return all;
}

// a t = b with no t below nothing, by descent along one of them after the other.
std::array<double, 4> not_negative(const Eigen::Matrix4d& a, const Eigen::Vector4d& b) {
  const Eigen::Matrix4d h = a.transpose() * a;
  const Eigen::Vector4d g = a.transpose() * b;
  std::array<double, 4> t{};
  for (int round = 0; round < 2000; ++round)
    for (Index i = 0; i < 4; ++i) {
      if (!(h(i, i) > 0)) continue;
      double rest = g(i);
      for (Index k = 0; k < 4; ++k)
        if (k != i) rest -= h(i, k) * t[static_cast<std::size_t>(k)];
      t[static_cast<std::size_t>(i)] = std::max(0.0, rest / h(i, i));
    }
  return t;
}

}  // namespace

RimSlopes rim_slopes(const Setting& s, const Question& q, std::size_t index, const SightingFit& fit) {
  const Sighting& sighting = q.sightings[index];
  const GroundAxes axes = ground_axes(s);
  const ModelRim rim(s, sighting.subject);
  RimSlopes out;
  std::vector<double> row(numbers_of(q.freedoms)), rows;
  for (std::size_t i = 0; i < sighting.points.size(); ++i) {
    if (!(fit.weight[i] > 0)) continue;
    const RimPoint& point = sighting.points[i];
    const auto place = rim.nearest(point.pixel, point.outward, std::abs(fit.offset_px[i]) + 1e-6);
    if (!place) continue;
    slopes_of(s, q.freedoms, axes, sighting.subject.station, sighting.subject.body, sighting.subject.lamp,
              place->mesh_point, place->outward, row.data());
    out.used.push_back(i), rows.insert(rows.end(), row.begin(), row.end());
  }
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  out.slopes =
      Eigen::Map<const Rows>(rows.data(), static_cast<Index>(out.used.size()), static_cast<Index>(row.size())) *
      (fit.share / fit.sigma_px);
  return out;
}

CommonErrors common_errors(const Question& q, const Fitted& f, const std::vector<RimSlopes>& slopes,
                           const std::vector<ShortErrors>& short_errors, const Eigen::MatrixXd& h_inverse) {
  const std::vector<Piece> pieces = pieces_of(q, f, slopes, short_errors);
  const auto count = static_cast<Index>(pieces.size()), numbers = h_inverse.rows();
  CommonErrors common;
  common.meat = Eigen::MatrixXd::Zero(numbers, numbers);
  if (count == 0) return common;
  Eigen::MatrixXd scores(numbers, count), means(count, numbers);
  Eigen::VectorXd left(count), noise(count), weight(count);
  for (Index p = 0; p < count; ++p) {
    const Piece& piece = pieces[static_cast<std::size_t>(p)];
    scores.col(p) = piece.score, means.row(p) = piece.slope.transpose() / piece.weight;
    left(p) = piece.offset / piece.weight, weight(p) = piece.weight;
    noise(p) = piece.noise / (piece.points * piece.points);
  }
  const Eigen::MatrixXd k =
      Eigen::MatrixXd(Eigen::MatrixXd::Identity(count, count)) - means * Eigen::MatrixXd(h_inverse * scores);
  const auto kinds = groupings(pieces);
  // Sums of squares of the groups' means, each group weighted by its points; what each kind of error makes of them.
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  for (Index g = 0; g < 4; ++g)
    for (const auto& group : kinds[static_cast<std::size_t>(g)].groups) {
      double all = 0, mean = 0;
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(count);
      for (const Index p : group) all += weight(p), mean += weight(p) * left(p), row += weight(p) * k.row(p);
      mean /= all, row /= all;
      b(g) += all * (mean * mean - row.cwiseAbs2().dot(noise));
      for (Index e = 0; e < 4; ++e)
        for (const auto& alike : kinds[static_cast<std::size_t>(e)].groups) {
          double sum = 0;
          for (const Index p : alike) sum += row(p);
          a(g, e) += all * sum * sum;
        }
    }
  for (Index g = 0; g < 4; ++g) {
    const double scale = a.row(g).maxCoeff();
    if (scale > 0) a.row(g) /= scale, b(g) /= scale;
  }
  const std::array<double, 4> t = not_negative(a, b);
  for (std::size_t e = 0; e < 4; ++e) {
    (e < 2 ? common.mask_px2 : common.piece_px2)[e % 2] = t[e];
    for (const auto& alike : kinds[e].groups) {
      Eigen::VectorXd score = Eigen::VectorXd::Zero(numbers);
      double all = 0, mean = 0, by_noise = 0;
      for (const Index p : alike) {
        score += scores.col(p);
        all += weight(p), mean += weight(p) * left(p), by_noise += weight(p) * weight(p) * noise(p);
      }
      // One mask may be worse than the others: what its own mean has beyond its noise is there in any case.
      const double own = e < 2 ? (mean * mean - by_noise) / (all * all) : 0;
      common.meat += std::max(t[e], own) * score * score.transpose();
    }
  }
  return common;
}

}  // namespace gonio::alignment
