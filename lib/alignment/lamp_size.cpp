// See lamp_size.h.
#include "alignment/lamp_size.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "alignment/edge_spread.h"
#include "alignment/model_region.h"
#include "linear/solve.h"

namespace gonio::alignment {
namespace {

using Eigen::Index;
constexpr double stretch_px = 48;  // of rim, over which errors are taken for one
constexpr double least_px2 = 0.2;  // of a variance, added to what its own error is a share of
constexpr int rounds = 20;
constexpr std::size_t fewest_edges = 20;  // places of a lamp's shadows
constexpr double reach_px = 6;

struct Measured {
  std::size_t lamp = 0, lens = 0, stretch = 0;
  double lever = 0, variance = 0;  // px^2 / m^2, px^2
};

// |g|^2 of a rim's place.
double lever_of(const Setting& setting, const RimSubject& shadow, const RimPlace& place) {
  std::array<double, 3> g{};
  slopes_of(setting, {{Block::lamp_shift, *shadow.lamp}}, ground_axes(setting), shadow.station, shadow.body,
            shadow.lamp, place.mesh_point, place.outward, g.data());
  return g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
}

// `first`: radii of the lamps as far as they are known; 0: of points.
std::vector<Measured> measured(const AlignmentInput& in, const Setting& setting, const std::vector<double>& first) {
  std::vector<Measured> all;
  std::map<std::tuple<std::size_t, std::uint32_t, long>, std::size_t> stretches;
  for (std::size_t k = 0; k < in.rims.size(); ++k) {
    const Sighting& sighting = in.question.sightings[k];
    if (!sighting.subject.lamp || in.rims[k].spread_px.empty()) continue;
    const std::vector<double> levers = edge_levers(in, setting, k, first[*sighting.subject.lamp]);
    for (std::size_t i = 0; i < sighting.points.size(); ++i) {
      const RimPoint& point = sighting.points[i];
      if (!std::isfinite(in.rims[k].spread_px[i]) || !std::isfinite(levers[i])) continue;
      const auto stretch =
          stretches.try_emplace({k, point.loop, static_cast<long>(point.arc_px / stretch_px)}, stretches.size());
      all.push_back({*sighting.subject.lamp, setting.stations[sighting.subject.station].lens, stretch.first->second,
                     levers[i], std::pow(in.rims[k].spread_px[i], 2)});
    }
  }
  return all;
}

// Unknowns: blur^2 of each lens, then r^2 / 4 of each lamp.
struct Line {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;
};

Line line_of(const std::vector<Measured>& all, std::size_t lenses, std::size_t lamps) {
  const auto n = static_cast<Index>(lenses + lamps);
  Line line{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n)};
  const auto slot = [&](const Measured& m) { return static_cast<Index>(lenses + m.lamp); };
  std::vector<double> usual;
  for (const Measured& m : all) usual.push_back(m.variance);
  std::nth_element(usual.begin(), usual.begin() + static_cast<std::ptrdiff_t>(usual.size() / 2), usual.end());
  for (Index i = 0; i < static_cast<Index>(lenses); ++i) line.x(i) = usual[usual.size() / 2];
  double width = 1;
  for (int round = 0; round < rounds; ++round) {
    Eigen::MatrixXd h = Eigen::MatrixXd::Identity(n, n) * 1e-12;
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    std::map<std::size_t, Eigen::VectorXd> scores;
    std::vector<double> sizes;
    for (const Measured& m : all) {
      const auto lens = static_cast<Index>(m.lens);
      const double expected = line.x(lens) + m.lever * line.x(slot(m)), sigma = expected + least_px2;
      const double r = (m.variance - expected) / sigma;
      const double weight = 1 / (1 + r * r / (width * width)) / (sigma * sigma);
      sizes.push_back(std::abs(r));
      Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
      row(lens) = 1, row(slot(m)) = m.lever;
      h += weight * row * row.transpose(), g += weight * m.variance * row;
      auto& score = scores.try_emplace(m.stretch, Eigen::VectorXd::Zero(n)).first->second;
      score += weight * (m.variance - expected) * row;
    }
    const linear::Ldlt solver(h);
    line.x = solver.solve(g).cwiseMax(0.0);
    std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
    width = std::max(0.05, 2.5 * 1.4826 * sizes[sizes.size() / 2]);
    Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(n, n);
    for (const auto& [stretch, score] : scores) middle += score * score.transpose();
    const Eigen::MatrixXd inverse = solver.solve(Eigen::MatrixXd::Identity(n, n));
    line.covariance = inverse * middle * inverse;
  }
  return line;
}

std::vector<LampSize> sizes_of(const AlignmentInput& in, const Setting& setting, const std::vector<double>& first) {
  std::vector<LampSize> sizes(setting.lamps_m.size());
  const std::vector<Measured> all = measured(in, setting, first);
  if (all.size() < fewest_edges) return sizes;
  const std::size_t lenses = setting.lenses.size();
  const Line line = line_of(all, lenses, sizes.size());
  for (const Measured& m : all) ++sizes[m.lamp].edges;
  for (std::size_t l = 0; l < sizes.size(); ++l) {
    if (sizes[l].edges < fewest_edges) continue;
    const auto at = static_cast<Index>(lenses + l);
    const double squared = 4 * line.x(at), sigma = 4 * std::sqrt(std::max(0.0, line.covariance(at, at)));
    sizes[l].radius_m = std::sqrt(squared);
    // Of a root: near nothing it is known no better than that of its square's error.
    sizes[l].sigma_m = std::min(sigma / std::max(2 * sizes[l].radius_m, 1e-12), std::sqrt(sigma));
  }
  return sizes;
}

}  // namespace

std::vector<double> edge_levers(const AlignmentInput& in, const Setting& setting, std::size_t k, double radius_m) {
  const Sighting& sighting = in.question.sightings[k];
  std::vector<double> levers(sighting.points.size(), std::numeric_limits<double>::quiet_NaN());
  if (radius_m > 0) {
    const std::size_t lens = setting.stations[sighting.subject.station].lens;
    std::vector<float> light = model_region(in, setting, sighting.subject, radius_m);
    for (float& v : light) v = 1 - v;
    const Luminance picture(in.models[lens].width_px(), in.models[lens].height_px(), std::move(light));
    const std::vector<double> spread = edge_spreads(picture, in.rims[k].in_picture, [&](Vec2 pixel) {
      return sighting.unseen && sighting.unseen(in.straight(lens, pixel));
    });
    for (std::size_t i = 0; i < levers.size(); ++i) levers[i] = 4 * std::pow(spread[i] / radius_m, 2);
    return levers;
  }
  const ModelRim rim(setting, sighting.subject);
  for (std::size_t i = 0; i < levers.size(); ++i) {
    const RimPoint& point = sighting.points[i];
    if (!std::isfinite(in.rims[k].spread_px[i])) continue;
    if (const auto place = rim.nearest(point.pixel, point.outward, reach_px))
      levers[i] = lever_of(setting, sighting.subject, *place);
  }
  return levers;
}

std::vector<LampSize> lamp_sizes(const AlignmentInput& in, const Setting& setting) {
  std::vector<double> first(setting.lamps_m.size(), 0.0);
  std::vector<LampSize> sizes = sizes_of(in, setting, first);
  bool simulate = false;
  for (std::size_t l = 0; l < sizes.size(); ++l)
    if (sizes[l].told()) first[l] = sizes[l].radius_m, simulate = true;
  return simulate ? sizes_of(in, setting, first) : sizes;
}

}  // namespace gonio::alignment
