// Pearson's chi-square test of a sampler of directions against the density it states.
//
// The sphere is cut into bins of equal (cos theta, phi); the density is integrated over each by adaptive Gauss
// quadrature, which looks closer wherever samples crowd, so that it does not step over narrow lobes; samples that
// failed form one more bin, whose expectation is what the density leaves out. Bins that expect
// fewer than five are pooled. With m tests in one family, Sidak's correction makes the family's false-alarm rate what
// `family_rate` says: each test rejects below 1 - (1 - family_rate)^(1/m).
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/random.h"
#include "geom/vector.h"

namespace gonio::tests {

// Probability that chi-square with `degrees` of freedom exceeds `value`: the regularised incomplete gamma function
// Q(degrees / 2, value / 2), by its series or continued fraction (Press et al. 2007, section 6.2).
inline double chi_square_tail(double value, double degrees) {
  const double a = degrees / 2, x = value / 2;
  if (x <= 0) return 1;
  const double front = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (double n = a + 1; std::abs(term) > 1e-15 * sum; ++n) sum += term *= x / n;
    return 1 - front * sum;
  }
  double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int i = 1; i < 100000; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-14) break;
  }
  return front * h;
}

// f at four by four Gauss points of a rectangle, times its area.
inline double gauss_rule(const std::function<double(double, Vec2)>& f, double z0, double z1, double p0, double p1) {
  constexpr std::array<double, 4> node = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                          0.8611363115940526};
  constexpr std::array<double, 4> weight = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                            0.3478548451374538};
  std::array<Vec2, 4> turned;
  for (std::size_t j = 0; j < 4; ++j) {
    const double phi = (p0 + p1) / 2 + node[j] * (p1 - p0) / 2;
    turned[j] = {std::cos(phi), std::sin(phi)};
  }
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      sum += weight[i] * weight[j] * f((z0 + z1) / 2 + node[i] * (z1 - z0) / 2, turned[j]);
  return sum * (z1 - z0) * (p1 - p0) / 4;
}

// Integral of f(cos theta, (cos phi, sin phi)) over a rectangle: by gauss_rule, split until the parts agree with the
// whole, which is the rule of the rectangle itself where a caller has it already. Patches that hold `crowd` of the
// points `hints` are split in any case, and so is what is not a sixteenth yet: its own rule is not asked for.
inline double integrate_patch(const std::function<double(double, Vec2)>& f, double z0, double z1, double p0, double p1,
                              double tolerance, int depth = 0, const std::vector<Vec2>& hints = {},
                              std::size_t crowd = 600, std::optional<double> whole = std::nullopt) {
  const double zm = (z0 + z1) / 2, pm = (p0 + p1) / 2;
  std::array<std::optional<double>, 4> parts;  // low left, high left, low right, high right
  const bool split = hints.size() >= crowd && depth <= 16;
  if (!split && depth >= 1) {
    parts = {gauss_rule(f, z0, zm, p0, pm), gauss_rule(f, zm, z1, p0, pm), gauss_rule(f, z0, zm, pm, p1),
             gauss_rule(f, zm, z1, pm, p1)};
    const double sum = *parts[0] + *parts[1] + *parts[2] + *parts[3];
    if (depth > 16) return sum;
    if (depth >= 2 && std::abs(sum - (whole ? *whole : gauss_rule(f, z0, z1, p0, p1))) < tolerance) return sum;
  }
  const auto quarter = [&](bool high, bool right) {
    std::vector<Vec2> inside;
    for (const Vec2 p : hints)
      if ((p.x >= zm) == high && (p.y >= pm) == right) inside.push_back(p);
    return integrate_patch(f, high ? zm : z0, high ? z1 : zm, right ? pm : p0, right ? p1 : pm, tolerance / 2,
                           depth + 1, inside, crowd, parts[(right ? 2 : 0) + (high ? 1 : 0)]);
  };
  return quarter(false, false) + quarter(true, false) + quarter(false, true) + quarter(true, true);
}

struct Sampler {
  std::string name;
  std::function<std::optional<Vec3>(Random&)> draw;  // nothing: the sample failed
  std::function<double(Vec3)> density;               // per steradian
  Vec3 axis{0, 0, 1};                                // the cap that holds the density
  double least_cosine = -1;
};

inline constexpr std::size_t chi_rows = 20, chi_columns = 24;
inline constexpr double chi_samples = 60000;

// Of counts against what was expected; bins that expect fewer than five are pooled.
inline double pearson_p(const std::vector<double>& seen, const std::vector<double>& expected, const std::string& name) {
  double chi2 = 0, pooled_seen = 0, pooled_expected = 0, bins = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (expected[i] < 5) {
      pooled_seen += seen[i];
      pooled_expected += expected[i];
      continue;
    }
    chi2 += (seen[i] - expected[i]) * (seen[i] - expected[i]) / expected[i];
    ++bins;
  }
  if (pooled_expected >= 5) {
    chi2 += (pooled_seen - pooled_expected) * (pooled_seen - pooled_expected) / pooled_expected;
    ++bins;
  } else {  // Poisson: far more than expected where next to nothing should be
    EXPECT_LE(pooled_seen, pooled_expected + 6 * std::sqrt(pooled_expected + 1) + 6) << name;
  }
  return bins > 1 ? chi_square_tail(chi2, bins - 1) : 1;
}

// The p-value of one sampler.
inline double chi_square_p(const Sampler& sampler, std::uint64_t seed) {
  std::vector<double> seen(chi_rows * chi_columns + 1), expected(seen.size());
  const Basis frame(sampler.axis);
  const double height = (1 - sampler.least_cosine) / chi_rows;
  std::vector<std::vector<Vec2>> where(chi_rows * chi_columns);
  Random random(seed);
  for (int i = 0; i < chi_samples; ++i) {
    const auto w = sampler.draw(random);
    const Vec3 local = w ? frame.to_local(*w) : Vec3{0, 0, -2};
    if (local.z < sampler.least_cosine) {
      ++seen.back();
      continue;
    }
    const double turn = std::atan2(local.y, local.x) / (2 * pi) + 0.5;
    const auto row = std::min(chi_rows - 1, static_cast<std::size_t>((local.z - sampler.least_cosine) / height));
    const auto column = std::min(chi_columns - 1, static_cast<std::size_t>(turn * chi_columns));
    ++seen[row * chi_columns + column];
    where[row * chi_columns + column].push_back({local.z, (turn - 0.5) * 2 * pi});
  }
  const auto f = [&](double z, Vec2 turned) {
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return sampler.density(frame.to_world({r * turned.x, r * turned.y, z}));
  };
  const auto say_otherwise = [&](std::size_t bin) {
    return std::abs(seen[bin] - expected[bin]) > 3 * std::sqrt(expected[bin]) + 3;
  };
  const auto integrate = [&](std::size_t bin, int depth, std::size_t crowd) {
    const double z = sampler.least_cosine + height * static_cast<double>(bin / chi_columns),
                 width = 2 * pi / chi_columns, phi = -pi + width * static_cast<double>(bin % chi_columns);
    const double part = integrate_patch(f, z, z + height, phi, phi + width, 1e-5, depth, where[bin], crowd);
    expected[bin] = part * chi_samples;
    return part;
  };
  // Where the counts say so, finer from the start (hard edges may lie between the points) and near each few samples
  // (so may parts of a narrow, slanted ridge, which no single bin need show, but the sum does).
  double mass = 0;
  for (const bool again : {false, true}) {
    if (again && !say_otherwise(where.size())) break;
    mass = 0;
    for (std::size_t bin = 0; bin < where.size(); ++bin) {
      double part = integrate(bin, 0, again ? 5 : 600);
      if (say_otherwise(bin)) part = integrate(bin, -3, again ? 1 : 600);
      mass += part;
    }
    expected.back() = std::max(0.0, 1 - mass) * chi_samples;
  }
  EXPECT_LE(mass, 1 + 1e-5 * chi_rows * chi_columns) << sampler.name << ": the density integrates to more than one";
  return pearson_p(seen, expected, sampler.name);
}

// `members`: how many tests the whole family has, where these are a part of it.
inline void expect_samplers_match(const std::vector<Sampler>& family, double family_rate, std::uint64_t seed,
                                  std::size_t members = 0) {
  ASSERT_FALSE(family.empty());
  members = std::max(members, family.size());
  const double limit = 1 - std::pow(1 - family_rate, 1.0 / static_cast<double>(members));
  for (std::size_t i = 0; i < family.size(); ++i)
    EXPECT_GT(chi_square_p(family[i], seed + i), limit)
        << family[i].name << ", Sidak limit for " << members << " tests";
}

}  // namespace gonio::tests
