// Which points are which of a piece's markers: by distances alone, then by pose. For sources of this folder.
//
// Three pairs whose distances agree within their uncertainty give a pose; the pose gathers what further markers find a
// point within theirs, and is fitted again. What counts is how improbable so many pairs are by chance (a contrario:
// Moisan & Stival, IJCV 57(3), 2004): with M markers and B points spread over a volume V,
//
//   expected by chance = 2 C(M,3) B(B-1)(B-2) (2 k sigma sqrt(2) / D)^3  P(at least n-3 of M-3 | (B / V) 4 pi/3 k^3
//   |Sigma|^1/2)
//
// with k no larger than these pairs need (ten thresholds, in effect, are tried: times ten). How two answers compare is
// their likelihood ratio, a pair against a point that lies there by chance:
//
//   score = sum over pairs of  -log(B / V) - log((2 pi)^3/2 |Sigma|^1/2) - d^2 / 2
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "reassembly/place.h"

namespace gonio::reassembly {

struct Spot {  // a place and its covariance
  Eigen::Vector3d at;
  Eigen::Matrix3d covariance;
};
using Pairing = std::array<std::size_t, 2>;  // marker, point

struct PointFit {  // point = rotation * scale * marker + place
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  double scale = 1;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // of the points
  Eigen::Matrix<double, 7, 7> covariance;              // rotation vector, place (at the centroid), log scale
  double chi_square = 0;
};
// Orthogonal Procrustes weighted by both covariances; reflection excluded. Nothing where the pairs leave a rotation
// open: fewer than three, or all on a line.
std::optional<PointFit> fit_points(std::span<const Spot> markers, std::span<const Spot> points,
                                   std::span<const Pairing> pairs, bool free_scale);

struct Match {
  std::vector<Pairing> pairs;  // by marker
  PointFit fit;
  double score = 0, log_alarm = 0;
  int degrees = 0;
};

struct Points {
  std::vector<Spot> spots;
  std::vector<std::vector<std::size_t>> rivals;  // points of which only one can be true: they share a sighting
  std::vector<bool> open;                        // others are taken, or of few views among very many
  Eigen::Vector3d widths;                        // of the box in which they lie
  double diameter = 0;
  double count() const;
};
Points points_of(const std::vector<Bundle>& bundles);

struct Matches {
  std::vector<Match> all;    // best first; none twice
  std::size_t complete = 0;  // 0: all there are; else only those of at least so many pairs surely are
};
// Every pose that any three pairs lead to and that `fewest` pairs support. `loose`: relative tolerance of lengths
// besides their uncertainty, with the scale then fitted.
Matches matches(std::span<const Spot> markers, const Points& points, std::size_t fewest, double loose);

// Whether two matches put the markers (those of `a`'s pairs) at the same places, within their uncertainty.
bool same_place(const Match& a, const Match& b, std::span<const Spot> markers, const Points& points);

// Factors by which the markers' distances would have to be multiplied, likeliest first: votes of triangles of like
// shape.
std::vector<double> likely_scales(std::span<const Spot> markers, const Points& points, std::size_t most);

}  // namespace gonio::reassembly
