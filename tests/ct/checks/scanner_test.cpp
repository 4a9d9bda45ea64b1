// The tomograph against what can be computed without one: attenuation and edges of a disk, the cup that hardening digs
// (an inverse Abel transform), noise that goes with the root of the photons, and what each imperfection does.
#include "ct/scanner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace gonio::ct {
namespace {

Phantom disk(double radius, Vec3 at = {}) {
  return {"disk", {{"disk", cylinder(at - Vec3{0, 0, 1}, at + Vec3{0, 0, 1}, radius), glass()}}, {}};
}

Scanner slice_scanner(std::size_t voxels, const Spectrum& spectrum) {
  Scanner s;
  s.voxels = voxels, s.slices = 2, s.spectrum = spectrum;
  return s;
}

double sampled(const io::VolumeData& volume, double i, double j, std::size_t k) {
  const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
  const double f = i - static_cast<double>(a), g = j - static_cast<double>(b);
  return (1 - g) * ((1 - f) * volume.at(a, b, k) + f * volume.at(a + 1, b, k)) +
         g * ((1 - f) * volume.at(a, b + 1, k) + f * volume.at(a + 1, b + 1, k));
}

// Mean over the angle at a distance from `centre` (index coordinates).
double ring_mean(const io::VolumeData& volume, Vec3 centre, double radius, std::size_t k = 0) {
  double sum = 0;
  constexpr int angles = 720;
  for (int a = 0; a < angles; ++a)
    sum += sampled(volume, centre.x + radius * std::cos(2 * pi * a / angles),
                   centre.y + radius * std::sin(2 * pi * a / angles), k);
  return sum / angles;
}

double sd_of(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  for (const double v : values) sum += v, squares += v * v;
  const auto n = static_cast<double>(values.size());
  return std::sqrt((squares - sum * sum / n) / (n - 1));
}

TEST(CtScanner, ADiskHasItsAttenuationAndItsEdge) {
  const Scanner s = slice_scanner(128, mono(60));
  const double radius = 40.3;
  for (const Vec3 off : {Vec3{0, 0, 0}, Vec3{7.31, -4.57, 0}}) {
    const io::VolumeData v = scan(disk(radius * s.voxel_m, off * s.voxel_m), s);
    const Vec3 centre{63.5 + off.x, 63.5 + off.y, 0};
    const double mu = glass().attenuation_per_m(60);
    for (const double r : {2.0, 15.0, 30.0, 36.0}) EXPECT_NEAR(ring_mean(v, centre, r), mu, 0.005 * mu) << r;
    double sum = 0, squares = 0;
    constexpr int angles = 180;
    for (int a = 0; a < angles; ++a) {  // half-way down, along rays from the centre
      const double c = std::cos(2 * pi * a / angles), d = std::sin(2 * pi * a / angles);
      double r = radius - 3;
      while (sampled(v, centre.x + r * c, centre.y + r * d, 0) > mu / 2) r += 0.01;
      sum += r - radius, squares += (r - radius) * (r - radius);
    }
    EXPECT_NEAR(sum / angles, 0, 0.02);
    EXPECT_LT(std::sqrt(squares / angles), 0.05);
  }
}

// Readings of a disk are p(u) = -ln sum w exp(-2 mu sqrt(R^2 - u^2)); what has these readings is, by Abel's inversion,
// f(r) = -1/pi integral_r^R p'(u) / sqrt(u^2 - r^2) du. With u^2 = r^2 + q^2 the integrand is smooth up to the rim.
double hardened(const Spectrum& s, double radius, double r) {
  std::vector<double> mu;
  for (const double e : s.kev) mu.push_back(glass().attenuation_per_m(e));
  const auto slope_over_u = [&](double chord) {  // p'(u) / u, chord = 2 sqrt(R^2 - u^2)
    double sum = 0, slope = 0;
    for (std::size_t e = 0; e < mu.size(); ++e) {
      const double w = s.share[e] * std::exp(-mu[e] * chord);
      sum += w, slope += w * mu[e];
    }
    return -4 * slope / (sum * chord);  // d chord / du = -4 u / chord
  };
  const double most = std::sqrt(radius * radius - r * r);  // of q; q = most sin t takes the pole at the rim away
  constexpr int steps = 2000;
  double sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double t = pi / 2 * (k + 0.5) / steps, q = most * std::sin(t);
    sum += slope_over_u(2 * std::sqrt(most * most - q * q)) * most * std::cos(t);
  }
  return -sum * (pi / 2 / steps) / pi;
}

TEST(CtScanner, HardeningCupsAsAbelsInversionOfBeerAndLambertSays) {
  EXPECT_NEAR(hardened(mono(60), 4e-3, 1e-3), glass().attenuation_per_m(60), 1e-3);  // one energy: no cup
  Scanner s = slice_scanner(128, tube(120));
  const double radius = 50 * s.voxel_m;
  const io::VolumeData v = scan(disk(radius), s);
  const double middle = hardened(s.spectrum, radius, 0), rim = hardened(s.spectrum, radius, 0.9 * radius);
  EXPECT_GT(rim / middle, 1.02);
  for (const double r : {3.0, 10.0, 25.0, 40.0, 45.0}) {
    const double truth = hardened(s.spectrum, radius, r * s.voxel_m);
    EXPECT_NEAR(ring_mean(v, {63.5, 63.5, 0}, r), truth, 0.004 * truth) << r;
  }
  const double cup = (ring_mean(v, {63.5, 63.5, 0}, 45) - ring_mean(v, {63.5, 63.5, 0}, 2)) / middle;
  EXPECT_NEAR(cup, (rim - middle) / middle, 0.05 * (rim - middle) / middle);
  s.imperfections["beam-hardening"] = 0;  // linearised: flat
  const io::VolumeData flat = scan(disk(radius), s);
  const double mu = s.spectrum.attenuation_per_m(glass());
  for (const double r : {3.0, 25.0, 45.0}) EXPECT_NEAR(ring_mean(flat, {63.5, 63.5, 0}, r), mu, 0.005 * mu) << r;
}

// The variance of a reading is 1 / (photons T); a volume's noise goes with it.
TEST(CtScanner, NoiseGoesWithTheRootOfThePhotons) {
  Scanner s = slice_scanner(64, mono(60));
  s.slices = 16;
  const Phantom p = disk(10 * s.voxel_m);
  const io::VolumeData clean = scan(p, s);
  const auto noise = [&](double photons) {
    s.photons = photons;
    const io::VolumeData v = scan(p, s);
    std::vector<double> rest;
    for (std::size_t k = 0; k < v.values.size(); ++k)
      if (clean.values[k] != 0) rest.push_back(v.values[k] - clean.values[k]);
    return sd_of(rest);
  };
  const double few = noise(1000), more = noise(16000);
  EXPECT_NEAR(few / more, 4, 0.04 * 4);
  // Readings themselves, in the open beam: sd 1 / sqrt(photons). 3,000 of them: sd of the sd 1.3 %.
  s.photons = 2500;
  const Projections read = projections(p, s);
  std::vector<double> open;
  for (std::size_t view = 0; view < read.views; ++view)
    for (std::size_t row = 0; row < 4; ++row) open.push_back(read.column(view, 5)[row]);
  EXPECT_NEAR(sd_of(open), 0.02, 0.06 * 0.02);
}

// Poisson numbers of small and of large means: mean and variance are equal.
TEST(CtScanner, StarvedPixelsReadAsPoissonSays) {
  Scanner s = slice_scanner(32, mono(60));
  s.slices = 32;
  s.photons = 20;  // exp(-p) * 20 has mean 20 (1 - P(none)) up to the half photon
  const Phantom nothing = disk(1e-9);
  const Projections read = projections(nothing, s);
  double sum = 0, squares = 0;
  for (const float v : read.values) {
    const double count = 20 * std::exp(-static_cast<double>(v));
    sum += count, squares += count * count;
  }
  const auto n = static_cast<double>(read.values.size());
  EXPECT_NEAR(sum / n, 20, 5 * std::sqrt(20 / n));
  EXPECT_NEAR(squares / n - sum * sum / n / n, 20, 5 * 20 * std::sqrt(2 / n));
}

TEST(CtScanner, ResultsDependOnTheSeedAlone) {
  Scanner s = slice_scanner(32, tube(90));
  s.photons = 1000;
  const Phantom p = disk(8 * s.voxel_m);
  const io::VolumeData a = scan(p, s), b = scan(p, s);
  EXPECT_EQ(a.values, b.values);
  s.seed = 2;
  EXPECT_NE(a.values, scan(p, s).values);
}

// Where a small ball is found, as the centroid of its values.
Vec3 centroid(const io::VolumeData& v, double least) {
  Vec3 sum{};
  double weight = 0;
  for (std::size_t k = 0; k < v.head.size[2]; ++k)
    for (std::size_t j = 0; j < v.head.size[1]; ++j)
      for (std::size_t i = 0; i < v.head.size[0]; ++i) {
        const double value = v.at(i, j, k);
        if (value < least) continue;
        sum += Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} * value, weight += value;
      }
  return sum / weight;
}

TEST(CtScanner, BallsStandWhereTheyAreInParallelAndConeBeams) {
  Scanner s;
  s.voxels = 48, s.spectrum = mono(60);
  const Ball truth{Vec3{9.3, -5.2, 11.6} * s.voxel_m, 4.4 * s.voxel_m};
  const Phantom p{"ball", {{"ball", ball(truth.centre, truth.radius), glass()}}, {truth}};
  const double mu = glass().attenuation_per_m(60);
  for (const double source : {0.0, 0.05}) {
    s.source_m = source;
    const io::VolumeData v = scan(p, s);
    const Vec3 at = centroid(v, mu / 4), there = place_of(s, at.x, at.y, at.z);
    EXPECT_LT(norm(there - truth.centre) / s.voxel_m, 0.03) << source;
    EXPECT_NEAR(v.at(33, 18, 35), mu, 0.03 * mu) << source;
    const Vec3 told = *v.head.origin_m + at * v.head.spacing_m->x;
    EXPECT_LT(norm(told - there), 1e-9);
  }
}

// Each changes the volume, and twice as much where it is twice as large. (A ball on the axis knows nothing of a tilt.)
TEST(CtScanner, ImperfectionsDoWhatTheyAreNamedFor) {
  Scanner s;
  s.voxels = 48, s.slices = 24, s.spectrum = mono(60);
  const ShapePtr two = united({ball({}, 9 * s.voxel_m), ball(Vec3{4, 14, 7} * s.voxel_m, 3 * s.voxel_m)});
  const Phantom p{"balls", {{"balls", two, glass()}}, {}};
  const io::VolumeData perfect = scan(p, s);
  const auto with = [&](const std::string& name, double amplitude) {
    Scanner bad = s;
    bad.imperfections[name] = amplitude;
    return scan(p, bad);
  };
  const auto rms = [&](const io::VolumeData& v) {
    double sum = 0;
    for (std::size_t k = 0; k < v.values.size(); ++k) sum += std::pow(v.values[k] - perfect.values[k], 2);
    return std::sqrt(sum / static_cast<double>(v.values.size()));
  };
  EXPECT_NEAR(with("scale", 0.01).head.spacing_m->y, 1.01e-4, 1e-12);
  for (const auto& [name, amplitude] : {std::pair{"cupping", 0.1},
                                        {"scatter", 0.3},
                                        {"ring", 0.01},
                                        {"streak", 0.5},
                                        {"blur", 0.7},
                                        {"focal-spot", 0.7},
                                        {"axis-tilt", 0.02},
                                        {"axis-offset", 0.7},
                                        {"drift", 0.03}}) {
    const double one = rms(with(name, amplitude)), half = rms(with(name, amplitude / 2));
    EXPECT_GT(half, 0.02) << name;
    EXPECT_GT(one, 1.5 * half) << name;
  }
  const double mu = glass().attenuation_per_m(60), full = perfect.at(23, 23, 11);
  EXPECT_NEAR(full, mu, 0.01 * mu);
  EXPECT_LT(with("scatter", 0.3).at(23, 23, 11), 0.99 * full);  // light that should not be there looks like less glass
  EXPECT_NEAR(with("cupping", 0.1).at(23, 23, 11), 0.95 * full, 0.002 * full);
  // Both blurs have the same sd at the axis: the same width of the ball's edge, seen where the value is half.
  const double steep = perfect.at(13, 23, 11) - perfect.at(15, 23, 11),
               blurred = with("blur", 1).at(13, 23, 11) - with("blur", 1).at(15, 23, 11);
  const double spot = with("focal-spot", 1).at(13, 23, 11) - with("focal-spot", 1).at(15, 23, 11);
  EXPECT_LT(std::abs(blurred), 0.8 * std::abs(steep));
  EXPECT_NEAR(spot, blurred, 0.06 * std::abs(blurred));
  EXPECT_THROW(with("colour", 1), std::invalid_argument);
}

TEST(CtScanner, CodesAreRoundedAndClamped) {
  io::VolumeData v;
  v.head.size = {4, 1, 1};
  v.values = {-3, 0.26f, 100, 1000};
  const io::VolumeData stored = stored_as(v, io::VoxelType::u8, 2, 10);
  EXPECT_EQ(stored.values, (std::vector<float>{4, 11, 210, 255}));
  EXPECT_EQ(stored.head.type, io::VoxelType::u8);
}

}  // namespace
}  // namespace gonio::ct
