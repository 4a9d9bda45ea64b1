// What each pixel says by itself: densities of brightness and colour on ground and object, which are learned from the
// labels so far. See segmentation_field.h.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "alignment/segmentation_field.h"
#include "linear/solve.h"

namespace gonio::alignment {
namespace {

constexpr double darkest = -6, brightest = 2, bin = 0.1;  // of the logarithm of the ratio
constexpr int bins = 80;
const double dark_from = std::log(0.6);  // shadows are darker than this share of lit ground
constexpr double dark_object = -1;       // an object's dark side has a colour of its own: light from its surroundings
constexpr std::size_t enough = 40;       // pixels, to learn from
constexpr double most_evidence = 20;     // nats, of one pixel: no model is surer

constexpr double lit_share = 0.85, dark_share = 0.12, between_share = 0.005, odd_share = 0.01;    // of ground
const double one_picture = std::log(dark_share / (dark_from - darkest) * (brightest - darkest));  // dark says nothing

int bin_of(double brightness) {
  return std::clamp(static_cast<int>((brightness - darkest) / bin), 0, bins - 1);
}

struct Colours {  // of the logarithms of ratios about their mean, channels but the last: independent normals
  std::array<double, 2> mean{0, 0}, sigma{0.5, 0.5};
};
struct Densities {
  std::array<double, bins> object{}, dark{};
  Colours object_lit, object_dark, ground_dark;
};

double log_ratio(const Field& field, const LampPicture& picture, std::size_t p, int c) {
  const std::size_t i = p * static_cast<std::size_t>(field.channels) + static_cast<std::size_t>(c);
  const float value = std::max(picture.value[i], picture.sigma[i]);
  return std::log(static_cast<double>(value) / std::max(static_cast<double>(picture.ground[i]), 1e-30));
}
// Standard deviation of that by noise: a value below its noise says nothing of its colour.
double log_sigma(const Field& field, const LampPicture& picture, std::size_t p, int c) {
  const std::size_t i = p * static_cast<std::size_t>(field.channels) + static_cast<std::size_t>(c);
  return static_cast<double>(picture.sigma[i] / std::max(picture.value[i], picture.sigma[i]));
}
int colours(const Field& field) {
  return std::min(2, field.channels - 1);
}

// Of the colour of pixel p under a class: the normal widened by the noise and by `slack`.
double colour_density(const Field& field, const LampPicture& picture, std::size_t p, const Colours& of, double slack) {
  double density = 1;
  for (int c = 0; c < colours(field); ++c) {
    const auto k = static_cast<std::size_t>(c);
    const double noise = log_sigma(field, picture, p, c);
    const double variance = of.sigma[k] * of.sigma[k] + noise * noise + slack * slack;
    const double d = log_ratio(field, picture, p, c) - static_cast<double>(picture.brightness[p]) - of.mean[k];
    // The odd pixel may have any colour.
    density *= 0.98 * std::exp(-0.5 * d * d / variance) / std::sqrt(2 * 3.14159265 * variance) + 0.02 * 0.25;
  }
  return density;
}

// Of a cast shadow's colour: the learned one, or tinted by light from the object up to the object's own colour, as it
// is where they touch.
double shadow_colour(const Field& field, const LampPicture& picture, std::size_t p, const Densities& learned) {
  constexpr double tinted = 0.4;
  constexpr int tints = 4;
  double sum = (1 - tinted) * colour_density(field, picture, p, learned.ground_dark, 0);
  double most = colour_density(field, picture, p, learned.ground_dark, 0);
  for (int t = 1; t <= tints; ++t) {
    const double share = static_cast<double>(t) / tints;
    Colours colour{{0, 0}, {0.06, 0.06}};
    for (std::size_t c = 0; c < 2; ++c)
      colour.mean[c] = (1 - share) * learned.ground_dark.mean[c] + share * learned.object_lit.mean[c];
    const double density = colour_density(field, picture, p, colour, 0);
    sum += tinted / tints * density, most = std::max(most, density);
  }
  return field.pictures.size() == 1 ? most : sum;  // of one picture, a colour that either may have says nothing
}

double ground_density(const Field& field, const LampPicture& picture, std::size_t p, const Densities& learned) {
  const double b = static_cast<double>(picture.brightness[p]), s = static_cast<double>(picture.spread[p]);
  const Colours own{{0, 0}, {0, 0}};
  double sum = odd_share / (brightest - darkest) * 0.1;
  sum += lit_share * std::exp(-0.5 * b * b / (s * s)) / (2.5066 * s) *
         colour_density(field, picture, p, own, picture.model_error);
  // Light that comes back from the object brightens and tints the ground beside it by some per cent.
  if (b > -0.5 && b < 0.5)
    sum += between_share * std::exp(-0.5 * b * b / 0.01) / 0.25 * colour_density(field, picture, p, own, 0.05);
  if (b < dark_from)
    sum += dark_share * learned.dark[static_cast<std::size_t>(bin_of(b))] * shadow_colour(field, picture, p, learned);
  // Penumbrae, and pixels that a shadow's rim cuts.
  if (b > -2.5 && b < 0) sum += between_share / 2.5 * colour_density(field, picture, p, own, 0.1);
  return sum;
}

double object_density(const Field& field, const LampPicture& picture, std::size_t p, const Densities& learned) {
  const double b = static_cast<double>(picture.brightness[p]);
  return learned.object[static_cast<std::size_t>(bin_of(b))] *
         colour_density(field, picture, p, b > dark_object ? learned.object_lit : learned.object_dark, 0);
}

// A histogram with some of every bin, blurred over about a quarter of a factor e.
void learn_histogram(const std::vector<double>& values, double upper, std::array<double, bins>& out) {
  const double uniform = 1 / (upper - darkest);
  out.fill(uniform);
  if (values.size() < enough) return;
  std::array<double, bins> count{};
  for (const double v : values) count[static_cast<std::size_t>(bin_of(v))] += 1;
  for (int i = 0; i < bins; ++i) {
    double sum = 0, weight = 0;
    for (int j = std::max(0, i - 5); j <= std::min(bins - 1, i + 5); ++j) {
      const double w = std::exp(-0.5 * (i - j) * (i - j) / 6.0);
      sum += w * count[static_cast<std::size_t>(j)], weight += w;
    }
    out[static_cast<std::size_t>(i)] = 0.8 * sum / weight / (static_cast<double>(values.size()) * bin) + 0.2 * uniform;
  }
}

double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Colour {
  std::array<double, 2> value, noise;
};
// Median, and half the way from the 16th to the 84th per cent, less the noise.
void learn_colours(const std::vector<Colour>& seen, int count, Colours& out) {
  if (seen.size() < enough) return;
  for (int c = 0; c < count; ++c) {
    const auto k = static_cast<std::size_t>(c);
    std::vector<double> values, noise;
    for (const Colour& colour : seen) values.push_back(colour.value[k]), noise.push_back(colour.noise[k]);
    out.mean[k] = quantile(values, 0.5);
    const double half = 0.5 * (quantile(values, 0.84) - quantile(values, 0.16)), own = quantile(noise, 0.5);
    out.sigma[k] = std::sqrt(std::max(half * half - own * own, 0.03 * 0.03));
  }
}

Densities learn(const Field& field, std::span<const std::uint8_t> object) {
  Densities learned;
  std::vector<double> object_values, dark_values;
  std::vector<Colour> lit, dark, ground;
  if (!object.empty())
    for (const LampPicture& picture : field.pictures)
      for (std::size_t p = 0; p < field.pixels(); ++p) {
        const double b = static_cast<double>(picture.brightness[p]);
        if (!object[p] && b >= dark_from) continue;
        Colour colour{};
        double worst = 0;
        for (int c = 0; c < colours(field); ++c) {
          const auto k = static_cast<std::size_t>(c);
          colour.value[k] = log_ratio(field, picture, p, c) - b, colour.noise[k] = log_sigma(field, picture, p, c);
          worst = std::max(worst, colour.noise[k]);
        }
        (object[p] ? object_values : dark_values).push_back(b);
        if (worst < 0.3) (object[p] ? (b > dark_object ? lit : dark) : ground).push_back(colour);
      }
  // One picture cannot tell an object's dark side from the shadow: what the cut called them would teach only itself.
  if (field.pictures.size() == 1) object_values.clear(), dark_values.clear(), dark.clear(), ground.clear();
  learn_histogram(object_values, brightest, learned.object);
  learn_histogram(dark_values, dark_from, learned.dark);
  learn_colours(lit, colours(field), learned.object_lit);
  learned.object_dark = learned.object_lit;
  for (double& sigma : learned.object_dark.sigma) sigma = std::hypot(sigma, 0.05);
  learned.ground_dark.sigma =
      field.pictures.size() == 1 ? std::array<double, 2>{0.1, 0.1} : std::array<double, 2>{0.3, 0.3};
  learn_colours(dark, colours(field), learned.object_dark);
  learn_colours(ground, colours(field), learned.ground_dark);
  return learned;
}

// How log(value) follows log(ground) over the dark pixels of the 5x5 about p, planes taken off both (shading, and light
// that falls off): slope, sum of squares of the ground, and the variance of what the slope leaves, at least the noise.
// False: too few.
struct Following {
  double slope = 0, squares = 0, variance = 0;
};
bool following_about(const Field& field, const LampPicture& picture, std::size_t p, Following& out) {
  const auto w = static_cast<std::size_t>(field.width), channels = static_cast<std::size_t>(field.channels);
  std::array<Eigen::Vector3d, 25> place;
  std::array<Eigen::Vector2d, 25> logs;  // of value and of ground
  std::size_t n = 0;
  double noise = 0;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  around(field, p, 2, [&](std::size_t q) {
    const double b = static_cast<double>(picture.brightness[q]), s = static_cast<double>(picture.spread[q]);
    if (b > dark_from) return;
    double ground = 0;
    for (std::size_t c = 0; c < channels; ++c)
      ground += std::log(std::max(static_cast<double>(picture.ground[q * channels + c]), 1e-30)) / field.channels;
    place[n] = {1, static_cast<double>(q % w) - static_cast<double>(p % w),
                static_cast<double>(q / w) - static_cast<double>(p / w)};
    logs[n] = {b + ground, ground};
    normal += place[n] * place[n].transpose(), right += place[n] * logs[n].transpose(), noise += s * s;
    ++n;
  });
  if (n < 12) return false;
  const Eigen::Matrix<double, 3, 2> plane = linear::solve_ldlt(normal, right);
  double vv = 0, vg = 0, gg = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d left = logs[i] - plane.transpose() * place[i];
    vv += left[0] * left[0], vg += left[0] * left[1], gg += left[1] * left[1];
  }
  if (!(gg > 1e-9)) return false;
  out.slope = vg / gg, out.squares = gg;
  out.variance = std::max(noise / static_cast<double>(n), (vv - vg * vg / gg) / static_cast<double>(n - 4));
  return true;
}

}  // namespace

// In a shadow the picture follows the ground's texture (slope 1), on an object it does not (slope 0).
void add_texture_evidence(const Field& field, std::vector<float>& evidence) {
  constexpr double most = 3, overlap = 0.2;  // neighbouring windows share pixels
  const LampPicture& picture = field.pictures.front();
  for (std::size_t p = 0; p < field.pixels(); ++p) {
    Following f;
    if (static_cast<double>(picture.brightness[p]) > dark_from || !following_about(field, picture, p, f)) continue;
    const double e = 0.5 * (1 - 2 * f.slope) * f.squares / f.variance;
    evidence[p] += static_cast<float>(std::clamp(overlap * e, -most, most));
  }
}

std::vector<float> object_evidence(const Field& field, std::span<const std::uint8_t> object) {
  const Densities learned = learn(field, object);
  std::vector<float> evidence(field.pixels());
  for (std::size_t p = 0; p < field.pixels(); ++p) {
    double sum = field.pictures.size() == 1 ? one_picture : 0;
    // Where the pixel is dark in several pictures, the same light from the surroundings has tinted it in each: such
    // pictures repeat each other, and count as one.
    double dark_sum = 0;
    int dark = 0;
    for (const LampPicture& picture : field.pictures) {
      const double e =
          std::log(object_density(field, picture, p, learned) / ground_density(field, picture, p, learned));
      if (static_cast<double>(picture.brightness[p]) < dark_object)
        dark_sum += e, ++dark;
      else
        sum += e;
    }
    if (dark > 0) sum += dark_sum / dark;
    evidence[p] = static_cast<float>(std::clamp(sum, -most_evidence, most_evidence));
  }
  return evidence;
}

std::vector<std::uint8_t> lit_ground(const Field& field, std::size_t k, std::span<const std::uint8_t> object) {
  const LampPicture& picture = field.pictures[k];
  std::vector<std::uint8_t> lit(field.pixels());
  for (int y = 0; y < field.height; ++y)
    for (int x = 0; x < field.width; ++x) {
      const std::size_t p =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(field.width) + static_cast<std::size_t>(x);
      bool away = std::abs(picture.brightness[p]) < 4 * picture.spread[p];
      for (int j = std::max(0, y - 2); away && j <= std::min(field.height - 1, y + 2); ++j)
        for (int i = std::max(0, x - 2); i <= std::min(field.width - 1, x + 2); ++i)
          away = away && !object[static_cast<std::size_t>(j) * static_cast<std::size_t>(field.width) +
                                 static_cast<std::size_t>(i)];
      lit[p] = away;
    }
  return lit;
}

}  // namespace gonio::alignment
