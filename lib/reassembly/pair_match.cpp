// The search of pair_match.h.
#include "reassembly/pair_match.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <unordered_set>

#include "linear/geom_matrices.h"
#include "linear/positive.h"
#include "linear/symmetric_eigen.h"
#include "reassembly/bundle_sight.h"
#include "stats/distributions.h"

namespace gonio::reassembly {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double side_gate = 4.5;  // deviations of a distance
// Triangles that are tried: 20 us each; fewer where several scales are.
constexpr std::size_t most_triangles = 12000, most_loose_triangles = 1500;
constexpr std::size_t most_points = 400;
constexpr double thresholds = 10;  // values of k that are tried, in effect
double point_gate() {              // of a pair's squared deviation
  static const double gate = stats::chi2_quantile(1 - 1e-4, 3);
  return gate;
}

// Sets of points, for each two markers and one point: those at the markers' distance from it.
class Sides {
 public:
  Sides(std::span<const Spot> markers, const Points& points, double loose)
      : m_(markers.size()), b_(points.spots.size()), words_((b_ + 63) / 64), bits_(m_ * m_ * b_ * words_) {
    for (std::size_t a = 0; a < b_; ++a)
      for (std::size_t b = a + 1; b < b_; ++b) {
        if (!points.open[a] || !points.open[b] || std::ranges::count(points.rivals[a], b) > 0) continue;
        const Vector3d ab = points.spots[b].at - points.spots[a].at;
        const double d = ab.norm();
        if (!(d > 0)) continue;
        const double variance = ab.dot((points.spots[a].covariance + points.spots[b].covariance) * ab) / (d * d);
        for (std::size_t i = 0; i < m_; ++i)
          for (std::size_t j = i + 1; j < m_; ++j) {
            const Vector3d ij = markers[j].at - markers[i].at;
            const double length = ij.norm();
            const double own =
                ij.dot((markers[i].covariance + markers[j].covariance) * ij) / std::max(length * length, 1e-30);
            if (std::abs(length - d) > side_gate * std::sqrt(variance + own) + loose * length) continue;
            set(i, j, a, b), set(i, j, b, a), set(j, i, a, b), set(j, i, b, a);
          }
      }
  }
  const std::uint64_t* row(std::size_t i, std::size_t j, std::size_t a) const {
    return &bits_[((i * m_ + j) * b_ + a) * words_];
  }
  std::size_t words() const { return words_; }

 private:
  void set(std::size_t i, std::size_t j, std::size_t a, std::size_t b) {
    bits_[((i * m_ + j) * b_ + a) * words_ + b / 64] |= std::uint64_t{1} << (b % 64);
  }
  std::size_t m_, b_, words_;
  std::vector<std::uint64_t> bits_;
};

Matrix3d covariance_of(const Spot& marker, const Spot& point, const PointFit& f) {
  return f.scale * f.scale * f.rotation * marker.covariance * f.rotation.transpose() + point.covariance;
}

class PoseSearch {
 public:
  PoseSearch(std::span<const Spot> markers, const Points& points, std::size_t fewest, double loose)
      : markers_(markers),
        points_(points),
        fewest_(std::max<std::size_t>(3, fewest)),
        loose_(loose),
        sides_(markers, points, loose) {
    for (const Spot& s : points.spots) wide_.push_back(s.covariance.trace());
  }

  Matches all() {
    // How many triangles there are of each support; as many of the best supported are tried as time allows.
    const std::size_t m = markers_.size(), budget = loose_ > 0 ? most_loose_triangles : most_triangles;
    std::vector<std::size_t> count(m);
    each_triangle([&](const Triangle& t) { ++count[support_of(t)]; });
    std::size_t least = m - 3, tried = count[least];
    // Three pairs of a piece with more than four markers are never an answer.
    while (least > (m > 4 ? 1 : 0) && tried + count[least - 1] <= budget) tried += count[--least];
    std::vector<std::pair<std::size_t, Triangle>> triangles;
    each_triangle([&](const Triangle& t) {
      if (const std::size_t support = support_of(t); support >= least) triangles.push_back({m - support, t});
    });
    std::ranges::stable_sort(triangles, {}, &std::pair<std::size_t, Triangle>::first);
    if (triangles.size() > budget) triangles.resize(budget), ++least;
    std::size_t most = 0;
    for (const auto& [missing, t] : triangles) {
      if (2 * (m - missing + 3) < most) break;  // neither a rival nor a second place of half as many
      try_triangle(t);
      for (; judged_ < found_.size(); ++judged_) most = std::max(most, found_[judged_].pairs.size());
    }
    std::ranges::sort(found_, [](const Match& x, const Match& y) { return x.score > y.score; });
    return {std::move(found_), least > 1 ? least + 3 : 0};
  }

 private:
  using Triangle = std::array<Pairing, 3>;

  template <class Body>
  void each(const std::uint64_t* x, const std::uint64_t* y, Body&& body) const {
    for (std::size_t w = 0; w < sides_.words(); ++w)
      for (std::uint64_t bits = y ? x[w] & y[w] : x[w]; bits != 0; bits &= bits - 1)
        body(64 * w + static_cast<std::size_t>(__builtin_ctzll(bits)));
  }
  template <class Body>
  void each_triangle(Body&& body) const {
    const std::size_t m = markers_.size(), b = points_.spots.size();
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = i + 1; j < m; ++j)
        for (std::size_t a = 0; a < b; ++a)
          each(sides_.row(i, j, a), nullptr, [&](std::size_t c) {
            for (std::size_t k = j + 1; k < m; ++k)
              each(sides_.row(i, k, a), sides_.row(j, k, c), [&](std::size_t e) {
                body(Triangle{{{i, a}, {j, c}, {k, e}}});
              });
          });
  }
  // Markers beside the three for which some point is at the right distances from all of these: a pose that pairs n of
  // them has n - 3, at least.
  std::size_t support_of(const Triangle& t) const {
    std::size_t support = 0;
    for (std::size_t n = 0; n < markers_.size(); ++n) {
      if (n == t[0][0] || n == t[1][0] || n == t[2][0]) continue;
      const auto *x = sides_.row(t[0][0], n, t[0][1]), *y = sides_.row(t[1][0], n, t[1][1]),
                 *z = sides_.row(t[2][0], n, t[2][1]);
      for (std::size_t w = 0; w < sides_.words(); ++w)
        if ((x[w] & y[w] & z[w]) != 0) {
          ++support;
          break;
        }
    }
    return support;
  }

  std::uint64_t key_of(const Pairing& a, const Pairing& b, const Pairing& c) const {
    const auto number = [&](const Pairing& p) { return std::uint64_t{p[0] * points_.spots.size() + p[1]}; };
    return (number(a) << 42) ^ (number(b) << 21) ^ number(c);
  }

  void try_triangle(const Triangle& three) {
    if (covered_.contains(key_of(three[0], three[1], three[2]))) return;
    std::vector<Pairing> pairs(three.begin(), three.end());
    std::optional<PointFit> fit;
    for (int round = 0; round < 5; ++round) {
      fit = fit_points(markers_, points_.spots, pairs, loose_ > 0 && pairs.size() > 2);
      if (!fit) return;
      auto next = gathered(*fit);
      if (next.size() < fewest_ || next.size() < pairs.size()) return;
      const bool settled = next == pairs;
      pairs = std::move(next);
      if (settled) break;
    }
    fit = fit_points(markers_, points_.spots, pairs, loose_ > 0);
    if (!fit || !seen_.insert(pairs).second) return;
    for (std::size_t a = 0; a < pairs.size(); ++a)
      for (std::size_t b = a + 1; b < pairs.size(); ++b)
        for (std::size_t c = b + 1; c < pairs.size(); ++c) covered_.insert(key_of(pairs[a], pairs[b], pairs[c]));
    keep(std::move(pairs), *fit);
  }

  // Every marker's nearest point within its gate, one to one, the surest first.
  std::vector<Pairing> gathered(const PointFit& f) {
    const double gate = point_gate();
    near_.clear();
    for (std::size_t i = 0; i < markers_.size(); ++i) {
      const Vector3d there = f.rotation * (f.scale * markers_[i].at) + f.place, arm = there - f.centroid;
      Eigen::Matrix<double, 3, 7> j;
      j << -linear::cross_matrix(arm), Matrix3d::Identity(), arm;
      const Matrix3d own = f.scale * f.scale * f.rotation * markers_[i].covariance * f.rotation.transpose() +
                           j * f.covariance * j.transpose();
      const double wide = own.trace();
      for (std::size_t b = 0; b < points_.spots.size(); ++b) {
        if (!points_.open[b]) continue;
        const Vector3d r = points_.spots[b].at - there;
        if (r.squaredNorm() > gate * (wide + wide_[b])) continue;
        const Matrix3d c = own + points_.spots[b].covariance;
        std::array<double, 9> a, inverse;
        Eigen::Map<Matrix3d>(a.data()) = c;
        if (!linear::positive_inverse<3>(a, inverse)) continue;
        const double square = r.dot(Eigen::Map<const Matrix3d>(inverse.data()) * r);
        if (square < gate) near_.push_back({square, {i, b}});
      }
    }
    std::ranges::sort(near_);
    std::vector<bool> marker(markers_.size()), point(points_.spots.size());
    std::vector<Pairing> pairs;
    for (const auto& [square, p] : near_) {
      if (marker[p[0]] || point[p[1]]) continue;
      marker[p[0]] = point[p[1]] = true;
      for (const std::size_t rival : points_.rivals[p[1]]) point[rival] = true;
      pairs.push_back(p);
    }
    std::ranges::sort(pairs);
    return pairs;
  }

  void keep(std::vector<Pairing> pairs, const PointFit& fit) {
    Match match{std::move(pairs), fit, 0, 0, 0};
    const double volume = points_.widths.prod(), count = points_.count();
    double log_root = 0, side = 0, widest = 0;
    for (const auto& [i, b] : match.pairs) {
      const Matrix3d c = covariance_of(markers_[i], points_.spots[b], fit);
      const Vector3d off = fit.rotation * (fit.scale * markers_[i].at) + fit.place - points_.spots[b].at;
      widest = std::max(widest, (lower_inverse(lower_root(c)) * off).squaredNorm());
      log_root += lower_root(c).diagonal().array().log().sum() / static_cast<double>(match.pairs.size());
      side += std::sqrt(2 * c.trace() / 3) / static_cast<double>(match.pairs.size());
    }
    const auto n = static_cast<double>(match.pairs.size()), m = static_cast<double>(markers_.size());
    match.score = n * (std::log(volume / count) - 1.5 * std::log(2 * pi) - log_root) - fit.chi_square / 2;
    match.degrees = 3 * static_cast<int>(match.pairs.size()) - 6 - (loose_ > 0 ? 1 : 0);
    // k is what these pairs need, of what the fit has taken up given back.
    const double square = std::clamp(widest * n / (n - 2), 1.0, point_gate()), k = std::sqrt(square);
    const double length = std::min(1.0, (2 * k * side + 2 * loose_ * points_.diameter / 2) / points_.diameter);
    const double inside = std::min(1.0, count / volume * 4 * pi / 3 * square * k * std::exp(log_root));
    const double triangles = m * (m - 1) * (m - 2) / 3 * count * (count - 1) * (count - 2);
    const int more = static_cast<int>(n) - 3;
    match.log_alarm = std::log(triangles) + std::log(thresholds) + 3 * std::log(length);
    if (more > 0)
      match.log_alarm += std::log(std::max(1e-300, stats::binomial_upper(more, static_cast<int>(m) - 3, inside)));
    found_.push_back(std::move(match));
  }

  std::span<const Spot> markers_;
  const Points& points_;
  std::size_t fewest_;
  double loose_;
  Sides sides_;
  std::vector<Match> found_;
  std::set<std::vector<Pairing>> seen_;
  std::unordered_set<std::uint64_t> covered_;  // triangles of what was found
  std::size_t judged_ = 0;                     // of found_, for the largest
  std::vector<std::pair<double, Pairing>> near_;
  std::vector<double> wide_;  // traces of the points' covariances
};

}  // namespace

double Points::count() const {
  return static_cast<double>(std::ranges::count(open, true));
}

Points points_of(const std::vector<Bundle>& bundles) {
  Points p;
  Vector3d mean = Vector3d::Zero(), noise = Vector3d::Zero();
  const auto n = static_cast<double>(bundles.size());
  for (const Bundle& b : bundles) {
    p.spots.push_back({linear::as_eigen(b.centre_m), linear::as_eigen(b.covariance_m2)});
    mean += p.spots.back().at / n;
    noise += p.spots.back().covariance.diagonal() / n;
  }
  p.open.assign(bundles.size(), true);
  if (bundles.size() > most_points) {  // chance alone makes thousands of two views where outlines abound
    std::vector<std::size_t> order(bundles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t x, std::size_t y) {
      const std::size_t nx = bundles[x].sightings.size(), ny = bundles[y].sightings.size();
      return nx != ny ? nx > ny : bundles[x].centre_m.x < bundles[y].centre_m.x;
    });
    for (std::size_t k = most_points; k < order.size(); ++k) p.open[order[k]] = false;
  }
  p.rivals.resize(bundles.size());
  Matrix3d spread = Matrix3d::Zero();
  for (std::size_t a = 0; a < bundles.size(); ++a) {
    spread += (p.spots[a].at - mean) * (p.spots[a].at - mean).transpose() / n;
    for (std::size_t b = 0; b < bundles.size(); ++b) {
      p.diameter = std::max(p.diameter, (p.spots[a].at - p.spots[b].at).norm());
      const bool shared = a != b && std::ranges::any_of(bundles[a].sightings, [&](const Sighting& s) {
                            return std::ranges::count(bundles[b].sightings, s) > 0;
                          });
      if (shared) p.rivals[a].push_back(b);
    }
  }
  // A uniform box of that spread; a plane is as thick as its noise.
  if (bundles.empty()) return p;
  const Vector3d values = linear::SymmetricEigen<Matrix3d>(spread, Eigen::EigenvaluesOnly).eigenvalues();
  for (int k = 0; k < 3; ++k) p.widths[k] = std::sqrt(12 * std::max(values[k], 0.0) + 12 * noise.maxCoeff() + 1e-18);
  return p;
}

Matches matches(std::span<const Spot> markers, const Points& points, std::size_t fewest, double loose) {
  if (markers.size() < 3 || points.count() < 3) return {};
  return PoseSearch(markers, points, fewest, loose).all();
}

bool same_place(const Match& a, const Match& b, std::span<const Spot> markers, const Points& points) {
  return std::ranges::all_of(a.pairs, [&](const Pairing& p) {
    const auto put = [&](const PointFit& f) { return Vector3d(f.rotation * (f.scale * markers[p[0]].at) + f.place); };
    const double off = (put(a.fit) - put(b.fit)).squaredNorm();
    return off < 25 * covariance_of(markers[p[0]], points.spots[p[1]], a.fit).trace();
  });
}

}  // namespace gonio::reassembly
