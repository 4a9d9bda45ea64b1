// From what quadratics leave at some hundred places: noise.h.
#include "mesh/clean/noise.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mesh/clean/local_frame.h"
#include "mesh/clean/local_quadratic.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

constexpr std::size_t telling_places = 600, stating_places = 60;
constexpr double least_reach = 2.2;   // mean edges
constexpr double telling_radius = 3;  // mean edges, and no less than the reach
constexpr double near_by = 1.6;       // mean edges: pairs that tell the shared part
constexpr std::size_t least_points = 12;

using Terms6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Rows6 = Eigen::Matrix<double, Eigen::Dynamic, 6>;

double overlap_of_discs(double t) {
  return t >= 1 ? 0 : 2 / pi * (std::acos(t) - t * std::sqrt(1 - t * t));
}

// A neighbourhood with its fit. Rows are scaled by the roots of the weights, so that all errors have one variance.
struct Patch {
  std::vector<LocalPlace> places;
  Rows6 b;
  Eigen::VectorXd left;
  Matrix6 inverse = Matrix6::Zero();
  bool good = false;
  double freedom() const { return static_cast<double>(places.size()) - 6; }
};

Patch patch_of(const NoisySurface& surface, const std::vector<double>& weights, Neighbourhood& around,
               std::uint32_t face) {
  const LocalFrame frame(surface, face);
  Patch patch;
  LocalQuadratic quadratic;
  for (const std::uint32_t v : around.vertices()) {
    const LocalPlace at = frame.of(surface.positions_m[v]);
    patch.places.push_back(at);
    quadratic.add(at.u, at.v, at.h, weights.empty() ? 1 : weights[v]);
  }
  const auto fit = quadratic.fit();
  patch.good = fit.good && patch.places.size() >= least_points;
  if (!patch.good) return patch;
  const auto n = static_cast<Eigen::Index>(patch.places.size());
  patch.b.resize(n, 6), patch.left.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double root = weights.empty() ? 1 : std::sqrt(weights[around.vertices()[at]]);
    const LocalPlace& p = patch.places[at];
    const auto t = LocalQuadratic::terms(p.u, p.v);
    for (Eigen::Index k = 0; k < 6; ++k) patch.b(i, k) = root * t[static_cast<std::size_t>(k)];
    patch.left[i] = root * (p.h - fit.at(p.u, p.v));
  }
  for (Eigen::Index i = 0; i < 6; ++i)
    for (Eigen::Index j = 0; j < 6; ++j) patch.inverse(i, j) = fit.inverse[static_cast<std::size_t>(6 * i + j)];
  return patch;
}

// Calls body(i, j, distance) for all pairs i > j that are nearer than `within`, mean edges.
template <class Body>
void for_near_pairs(const Patch& patch, double within, const Body& body) {
  for (std::size_t i = 0; i < patch.places.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double du = patch.places[i].u - patch.places[j].u, dv = patch.places[i].v - patch.places[j].v;
      const double squared = du * du + dv * dv;
      if (squared < within * within)
        body(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j), std::sqrt(squared));
    }
}

// What a patch says: mean square and products of near pairs of what is left, and what they would be of errors that are
// all independent, or all shared, of variance 1.
struct Telling {
  bool good = false;
  double squares = 0, products = 0;
  std::array<double, 2> squares_of{}, products_of{};  // own, shared
};

Telling told_by(const Patch& patch, double reach) {
  Telling t;
  t.good = patch.good;
  if (!t.good) return t;
  const auto n = static_cast<double>(patch.places.size());
  Rows6 kb = patch.b, wb = Rows6::Zero(patch.b.rows(), 6);  // K B, W B: K the shared correlation, W the near pairs
  double near_k = 0;
  for_near_pairs(patch, std::max(reach, near_by), [&](Eigen::Index i, Eigen::Index j, double d) {
    const double k = overlap_of_discs(d / reach);
    kb.row(i) += k * patch.b.row(j), kb.row(j) += k * patch.b.row(i);
    if (d >= near_by) return;
    wb.row(i) += patch.b.row(j), wb.row(j) += patch.b.row(i);
    near_k += 2 * k;
    t.products += 2 * patch.left[i] * patch.left[j];
  });
  t.squares = patch.left.squaredNorm();
  const Matrix6 g = patch.b.transpose() * kb, w = patch.b.transpose() * wb;
  const auto trace = [&](const Matrix6& m) { return (patch.inverse * m).trace(); };
  const Matrix6 whw = patch.inverse * w * patch.inverse;
  t.squares_of = {n - 6, n - trace(g)};
  t.products_of = {-trace(w), near_k - 2 * trace(kb.transpose() * wb) + (whw * g).trace()};
  for (double* x : {&t.squares, &t.products, &t.squares_of[0], &t.squares_of[1], &t.products_of[0], &t.products_of[1]})
    *x /= patch.freedom();
  return t;
}

VertexNoise::Fitted stated_by(const Patch& patch, double shared, double reach) {
  Rows6 cb = patch.b;
  auto n = static_cast<double>(patch.places.size());
  double squares = n;  // of all correlations
  for_near_pairs(patch, reach, [&](Eigen::Index i, Eigen::Index j, double d) {
    const double c = shared * overlap_of_discs(d / reach);
    cb.row(i) += c * patch.b.row(j), cb.row(j) += c * patch.b.row(i);
    squares += 2 * c * c;
  });
  const Matrix6 g = patch.b.transpose() * cb, ag = patch.inverse * g;
  const double left = n - ag.trace();
  const double fourth = squares - 2 * (patch.inverse * (cb.transpose() * cb)).trace() + (ag * ag).trace();
  VertexNoise::Fitted f{
      patch.freedom(), left / patch.freedom(), std::sqrt(2 * std::max(0.0, fourth)) / patch.freedom(), {}};
  const Matrix6 covariance = ag * patch.inverse;
  for (Eigen::Index k = 0; k < 3; ++k)
    f.inflation[static_cast<std::size_t>(k)] = covariance(k, k) / patch.inverse(k, k);
  return f;
}

// Places that are spread over the surface.
template <class Body>
void at_places(const NoisySurface& surface, std::size_t places, const Body& body) {
  const std::size_t count = surface.triangles.size(), step = std::max<std::size_t>(1, count / places);
  parallel_for(
      0, (count + step - 1) / step,
      [&](std::size_t i) {
        Neighbourhood around(surface);
        const auto face = static_cast<std::uint32_t>(i * step);
        around.start(face);
        body(i, around, face);
      },
      16);
}
std::size_t places_of(const NoisySurface& surface, std::size_t places) {
  const std::size_t count = surface.triangles.size(), step = std::max<std::size_t>(1, count / places);
  return (count + step - 1) / step;
}

// Of the half that leaves least: where the object bends what is left is not the noise's.
double shared_part(const std::vector<Telling>& half) {
  double squares = 0, products = 0;
  std::array<double, 2> s{}, p{};
  for (const Telling& t : half) {
    squares += t.squares, products += t.products;
    for (std::size_t k = 0; k < 2; ++k) s[k] += t.squares_of[k], p[k] += t.products_of[k];
  }
  if (!(squares > 0)) return 0;
  // ((1 - x) p0 + x p1) / ((1 - x) s0 + x s1) = ratio
  const double ratio = products / squares, below = (p[1] - p[0]) - ratio * (s[1] - s[0]);
  return below != 0 ? std::clamp((ratio * s[0] - p[0]) / below, 0.0, 1.0) : 0;
}

}  // namespace

VertexNoise noise_of(const NoisySurface& surface, const std::vector<double>& weights, const StatedNoise& stated_noise) {
  VertexNoise noise;
  if (!(surface.edge_m > 0)) return noise;
  const double reach = std::max(least_reach, stated_noise.alike_m / surface.edge_m);
  noise.reach_m = reach * surface.edge_m;
  std::vector<Telling> told(places_of(surface, telling_places));
  at_places(surface, telling_places, [&](std::size_t i, Neighbourhood& around, std::uint32_t face) {
    around.grow(std::max(telling_radius, reach) * surface.edge_m);
    told[i] = told_by(patch_of(surface, weights, around, face), reach);
  });
  std::erase_if(told, [](const Telling& t) { return !t.good; });
  if (told.empty()) return noise;
  std::ranges::sort(told, {}, &Telling::squares);
  noise.shared = shared_part({told.begin(), told.begin() + static_cast<std::ptrdiff_t>((told.size() + 1) / 2)});
  std::vector<double> variances;
  for (const Telling& t : told)
    variances.push_back(t.squares / ((1 - noise.shared) * t.squares_of[0] + noise.shared * t.squares_of[1]));
  noise.sigma_m = surface.edge_m * std::sqrt(stats::median(variances));
  if (stated_noise.sigma_m > 0) noise.sigma_m = stated_noise.sigma_m;

  std::vector<std::array<VertexNoise::Fitted, fit_radii.size()>> stated(places_of(surface, stating_places));
  at_places(surface, stating_places, [&](std::size_t i, Neighbourhood& around, std::uint32_t face) {
    for (std::size_t r = 0; r < fit_radii.size(); ++r) {
      around.grow(fit_radii[r] * surface.edge_m);
      const Patch patch = patch_of(surface, weights, around, face);
      stated[i][r].left = 0;
      if (patch.good) stated[i][r] = stated_by(patch, noise.shared, reach);
    }
  });
  for (std::size_t r = 0; r < fit_radii.size(); ++r) {
    std::array<std::vector<double>, 6> each;
    for (const auto& one : stated) {
      const VertexNoise::Fitted& f = one[r];
      if (!(f.left > 0)) continue;
      each[0].push_back(f.freedom), each[1].push_back(f.left), each[2].push_back(f.left_sd);
      for (std::size_t k = 0; k < 3; ++k) each[3 + k].push_back(f.inflation[k]);
    }
    if (each[0].empty()) {
      if (r > 0) noise.fitted[r] = noise.fitted[r - 1];
      continue;
    }
    VertexNoise::Fitted& f = noise.fitted[r];
    f.freedom = stats::median(each[0]), f.left = stats::median(each[1]), f.left_sd = stats::median(each[2]);
    for (std::size_t k = 0; k < 3; ++k) f.inflation[k] = stats::median(each[3 + k]);
  }
  return noise;
}

}  // namespace gonio::mesh
