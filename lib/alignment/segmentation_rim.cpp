// The rims of object and shadow, where pixels hold both sides: see segmentation_field.h.
#include <algorithm>
#include <array>
#include <cmath>

#include "alignment/segmentation_field.h"

namespace gonio::alignment {
namespace {

constexpr double fall = 0.5;       // px^2, of the weights of those with their distance
constexpr double most_misfit = 2;  // of a mixture: chi squared over degrees of freedom
constexpr int reach = 3;           // pixels, of what a rim's pixel is compared with
constexpr int widest_reach = 24;   // where the shadow of a large lamp goes on growing darker
constexpr double still_falls = 0.1;

// 1 per pixel that has a neighbour with the other label.
std::vector<std::uint8_t> rim_of(const Field& field, std::span<const std::uint8_t> object) {
  std::vector<std::uint8_t> rim(field.pixels());
  for (std::size_t p = 0; p < field.pixels(); ++p)
    around(field, p, 1, [&](std::size_t q) { rim[p] = rim[p] || object[q] != object[p]; });
  return rim;
}

struct Near {
  std::size_t pixel;
  double weight;  // falls with the distance
};
struct Sides {  // pixels about a rim's one that are wholly of one side
  std::vector<Near> object, ground;
};
Sides sides_of(const Field& field, std::size_t p, std::span<const std::uint8_t> object,
               std::span<const std::uint8_t> rim) {
  Sides sides;
  around(field, p, reach, [&](std::size_t q) {
    if (rim[q]) return;
    const auto w = static_cast<std::size_t>(field.width);
    const double dx = static_cast<double>(q % w) - static_cast<double>(p % w);
    const double dy = static_cast<double>(q / w) - static_cast<double>(p / w);
    (object[q] ? sides.object : sides.ground).push_back({q, std::exp(-0.5 * (dx * dx + dy * dy - 4) / fall)});
  });
  return sides;
}

struct Level {
  double mean = 0, variance = 0;
};
// Of the ratio in picture and channel.
Level level_of(const Field& field, const LampPicture& picture, const std::vector<Near>& pixels, std::size_t c) {
  double sum = 0, squares = 0, n = 0;
  for (const auto& [q, weight] : pixels) {
    const std::size_t i = q * static_cast<std::size_t>(field.channels) + c;
    const double r = static_cast<double>(picture.value[i] / picture.ground[i]);
    sum += weight * r, squares += weight * r * r, n += weight;
  }
  const double mean = sum / n;
  return {mean, std::max(0.0, squares / n - mean * mean)};
}

// Share of the object in pixel p: the mixture of both sides' levels that comes nearest to it, channels weighted by
// noise and by how far each side is from being of one level. Negative: the sides look alike, one of them is nowhere, or
// no mixture of them comes near, as where an edge of the object is of a brightness of its own.
double share_of(const Field& field, std::size_t p, const Sides& sides) {
  if (sides.object.size() < 2 || sides.ground.size() < 2) return -1;
  double along = 0, whole = 0, square = 0;
  for (const LampPicture& picture : field.pictures)
    for (std::size_t c = 0; c < static_cast<std::size_t>(field.channels); ++c) {
      const Level o = level_of(field, picture, sides.object, c), g = level_of(field, picture, sides.ground, c);
      const std::size_t i = p * static_cast<std::size_t>(field.channels) + c;
      const double r = static_cast<double>(picture.value[i] / picture.ground[i]);
      const double s =
          static_cast<double>(picture.sigma[i] / picture.ground[i]) + picture.model_error * std::abs(g.mean);
      const double weight = 1 / (s * s + o.variance + g.variance), d = o.mean - g.mean;
      along += weight * (r - g.mean) * d, whole += weight * d * d, square += weight * (r - g.mean) * (r - g.mean);
    }
  if (!(whole > 4)) return -1;
  const double share = std::clamp(along / whole, 0.0, 1.0);
  const double misfit = square - 2 * share * along + share * share * whole;
  return misfit < most_misfit * static_cast<double>(field.pictures.size()) * field.channels ? share : -1;
}

// The level of the shadow nearby: of the darkest wholly ground pixel. `wide`: it lies farther off than an edge is wide
// that a point throws, so that this is a penumbra, of which each pixel's brightness says the share of the lamp.
struct Darkest {
  double level = 1;
  bool wide = false;
};
Darkest darkest_near(const Field& field, std::size_t p, std::span<const float> object, std::span<const float> ratio) {
  const auto within = [&](int pixels) {
    double least = 1;
    around(field, p, pixels, [&](std::size_t q) {
      if (object[q] <= 0.02f) least = std::min(least, static_cast<double>(ratio[q]));
    });
    return std::max(0.0, least);
  };
  Darkest found{within(reach)};
  for (int far = 2 * reach; far <= widest_reach; far *= 2) {
    const double level = within(far);
    if (level > found.level - still_falls) break;
    found = {level, true};
  }
  return found;
}

// Shares of the shadow in pixels between it and lit ground, by the brightness of what lies two and three pixels to
// either side; 0 or 1 elsewhere. `own`: the ratio of each pixel's ground.
void add_shadow_shares(const Field& field, const std::vector<float>& own, const std::vector<float>& penumbra,
                       Segmentation& result) {
  result.shadow_share.assign(field.pixels(), 0);
  std::vector<std::uint8_t> rim(field.pixels());
  for (std::size_t p = 0; p < field.pixels(); ++p) {
    const Label label = result.labels[p];
    if (label != Label::shadow && label != Label::ground) continue;
    result.shadow_share[p] = label == Label::shadow ? 1.0f : 0.0f;
    const Label other = label == Label::shadow ? Label::ground : Label::shadow;
    around(field, p, 1, [&](std::size_t q) { rim[p] = rim[p] || result.labels[q] == other; });
  }
  for (std::size_t p = 0; p < field.pixels(); ++p) {
    if (penumbra[p] >= 0) result.shadow_share[p] = penumbra[p];
    if (!rim[p] || penumbra[p] >= 0) continue;
    double dark = 0, darks = 0, lit = 0, lits = 0;
    around(field, p, reach, [&](std::size_t q) {
      if (rim[q] || result.object_share[q] > 0.02f) return;
      const auto w = static_cast<std::size_t>(field.width);
      const double dx = static_cast<double>(q % w) - static_cast<double>(p % w);
      const double dy = static_cast<double>(q / w) - static_cast<double>(p / w);
      const double weight = std::exp(-0.5 * (dx * dx + dy * dy - 4) / 4), v = static_cast<double>(own[q]);
      if (result.labels[q] == Label::shadow) dark += weight * v, darks += weight;
      if (result.labels[q] == Label::ground) lit += weight * v, lits += weight;
    });
    if (!(darks > 0 && lits > 0)) continue;
    dark /= darks, lit /= lits;
    if (lit - dark > 0.1)
      result.shadow_share[p] =
          static_cast<float>(std::clamp((lit - static_cast<double>(own[p])) / (lit - dark), 0.0, 1.0));
  }
}

}  // namespace

std::vector<float> rim_shares(const Field& field, std::span<const std::uint8_t> object) {
  std::vector<std::uint8_t> now(object.begin(), object.end());
  std::vector<float> share(now.begin(), now.end());
  // The first round moves what the cut has put a pixel too far out or in.
  for (int round = 0; round < 2; ++round) {
    const std::vector<std::uint8_t> rim = rim_of(field, now);
    for (std::size_t p = 0; p < field.pixels(); ++p) {
      share[p] = now[p];
      if (!rim[p]) continue;
      const double s = share_of(field, p, sides_of(field, p, now, rim));
      if (s >= 0) share[p] = static_cast<float>(s);
    }
    for (std::size_t p = 0; p < field.pixels(); ++p) now[p] = share[p] > 0.5f;
  }
  return share;
}

Segmentation labels_of(const Field& field, std::size_t k, std::span<const float> share) {
  const LampPicture& picture = field.pictures[k];
  Segmentation result{field.width,
                      field.height,
                      std::vector<Label>(field.pixels(), Label::ground),
                      std::vector<float>(share.begin(), share.end()),
                      {},
                      1};
  // Brightness of the ground's part of each pixel, and of the object's where it is whole.
  std::vector<float> ratio(field.pixels());
  for (std::size_t p = 0; p < field.pixels(); ++p) {
    double value = 0, ground = 0;
    for (int c = 0; c < field.channels; ++c) {
      const std::size_t i = p * static_cast<std::size_t>(field.channels) + static_cast<std::size_t>(c);
      value += static_cast<double>(picture.value[i]), ground += static_cast<double>(picture.ground[i]);
    }
    ratio[p] = static_cast<float>(value / ground);
  }
  std::vector<std::uint8_t> mixed(field.pixels());
  for (std::size_t p = 0; p < field.pixels(); ++p) mixed[p] = share[p] > 0.02f && share[p] <= 0.5f;
  std::vector<float> own = ratio;
  for (std::size_t p = 0; p < field.pixels(); ++p) {
    if (!mixed[p]) continue;
    double sum = 0, n = 0;
    around(field, p, 2, [&](std::size_t q) {
      if (share[q] > 0.98f) sum += static_cast<double>(ratio[q]), n += 1;
    });
    const double a = static_cast<double>(share[p]);
    if (n > 0) own[p] = static_cast<float>((static_cast<double>(ratio[p]) - a * sum / n) / (1 - a));
  }
  std::vector<float> penumbra(field.pixels(), -1);  // share of the lamp that is gone, in penumbrae
  for (std::size_t p = 0; p < field.pixels(); ++p) {
    if (!field.beyond.empty() && field.beyond[p]) {
      result.labels[p] = Label::unknown;
      continue;
    }
    if (share[p] > 0.5f) {
      result.labels[p] = Label::object;
      continue;
    }
    const Darkest darkest = darkest_near(field, p, share, ratio);
    const double least = std::min(darkest.level, 0.5), v = static_cast<double>(own[p]);
    if (v < 0.5 * (1 + least)) result.labels[p] = Label::shadow;
    if (darkest.wide && v > least + still_falls && v < 1 - still_falls)
      penumbra[p] = static_cast<float>(std::clamp((1 - v) / (1 - least), 0.0, 1.0));
  }
  add_shadow_shares(field, own, penumbra, result);
  return result;
}

}  // namespace gonio::alignment
