// The dark parts of one picture: see judge_dark() in segmentation_field.h.
#include <algorithm>
#include <cmath>

#include "alignment/segmentation_field.h"
#include "geom/vector.h"

namespace gonio::alignment {
namespace {

const double dark_from = std::log(0.6);  // of the ratio
const double hardly_dark = std::log(0.3);
constexpr double step = 0.12;             // of log brightness between neighbours: shading has less, rims more
constexpr double sure = 5, decisive = 1;  // nats, of one pixel and in the mean of 3x3
constexpr double turn = 1.5;              // nats, between neighbours
constexpr std::size_t speck = 6;          // pixels: smaller parts are what rims leave
constexpr std::size_t large = 30;         // pixels: such parts show how dark a shadow is here,
constexpr double distinct = 0.15;         // of logarithms: colours that are not the same
constexpr double levels = 0.6;            // and what is brighter by more than this (of the logarithm) is none

class Dark {
 public:
  Dark(const Field& field, std::span<const float> evidence)
      : field_(field), picture_(field.pictures.front()), evidence_(evidence), says_(field.pixels()) {
    for (std::size_t p = 0; p < field.pixels(); ++p) {
      double sum = 0, count = 0;
      around(field_, p, 1, [&](std::size_t q) {
        if (dark(q)) sum += static_cast<double>(evidence_[q]), count += 1;
      });
      says_[p] = sum / std::max(1.0, count);
      smooth(p);
    }
  }
  bool dark(std::size_t p) const { return brightness(p) < dark_from; }
  double brightness(std::size_t p) const { return static_cast<double>(picture_.brightness[p]); }
  bool lit_ground(std::size_t p) const {
    return std::abs(picture_.brightness[p]) < 5 * picture_.spread[p] + 0.03f && static_cast<double>(evidence_[p]) < 0;
  }
  // By every channel, of medians over 3x3: they keep a rim's step, which the pixels that hold both sides would bridge.
  bool joined(std::size_t p, std::size_t q) const {
    const auto channels = static_cast<std::size_t>(field_.channels);
    const double noise = std::hypot(static_cast<double>(picture_.spread[p]), static_cast<double>(picture_.spread[q]));
    for (std::size_t c = 0; c < channels; ++c)
      if (std::abs(smooth_[p * channels + c] - smooth_[q * channels + c]) >
          step + 0.5 * noise * std::sqrt(field_.channels))
        return false;
    // A tint that wanes with the distance from the object changes what its colour says step by step, a rim at once.
    return !dark(p) || !dark(q) || std::abs(says_[p] - says_[q]) < turn;
  }
  bool open(std::size_t p) const { return std::abs(says_[p]) < decisive; }  // neither colour nor texture decide
  // The pixels that smooth brightness joins to `start`, over those of which `within` says so.
  template <class Within>
  std::vector<std::size_t> part(std::vector<std::size_t> start, std::vector<std::uint8_t>& seen,
                                const Within& within) const {
    for (const std::size_t p : start) seen[p] = 1;
    for (std::size_t i = 0; i < start.size(); ++i) {
      const std::size_t p = start[i];
      around(field_, p, 1, [&](std::size_t q) {
        if (!seen[q] && within(q) && joined(p, q)) seen[q] = 1, start.push_back(q);
      });
    }
    return start;
  }
  double level(const std::vector<std::size_t>& part) const {
    double sum = 0;
    for (const std::size_t p : part) sum += brightness(p);
    return sum / static_cast<double>(part.size());
  }
  // Mean of the ratio's logarithms about their mean, of the first three channels.
  Vec3 colour(const std::vector<std::size_t>& part) const {
    Vec3 sum{};
    if (field_.channels == 3)
      for (const std::size_t p : part)
        sum += Vec3{log_ratio(p, 0), log_ratio(p, 1), log_ratio(p, 2)} - brightness(p) * Vec3{1, 1, 1};
    return part.empty() ? sum : sum / static_cast<double>(part.size());
  }
  bool meets_ground(const std::vector<std::size_t>& part) const {
    std::size_t meets = 0;
    for (const std::size_t p : part) {
      bool near = false;
      around(field_, p, 2, [&](std::size_t q) { near = near || lit_ground(q); });
      meets += near;
    }
    // Of n pixels at least 3.5 sqrt(n) lie at the rim.
    return static_cast<double>(meets) > 0.8 * std::sqrt(static_cast<double>(part.size()));
  }

 private:
  void smooth(std::size_t p) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(field_.channels); ++c) {
      std::vector<double> values;
      around(field_, p, 1, [&](std::size_t q) { values.push_back(log_ratio(q, c)); });
      std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
      smooth_.push_back(values[values.size() / 2]);
    }
  }
  double log_ratio(std::size_t p, std::size_t c) const {
    const std::size_t i = p * static_cast<std::size_t>(field_.channels) + c;
    return static_cast<double>(std::log(std::max(picture_.value[i], picture_.sigma[i]) / picture_.ground[i]));
  }
  const Field& field_;
  const LampPicture& picture_;
  std::span<const float> evidence_;
  std::vector<double> says_;    // evidence, mean of the dark pixels of 3x3
  std::vector<double> smooth_;  // logarithms of ratios, as `value`
};

struct Part {
  std::vector<std::size_t> pixels;
  double level = 0, unlike = 0;  // brightness; how far its colour is from that of the object's lit side
  bool grounded = false;
};

// The dark pixels that brightness does not join to the lit side.
std::vector<Part> parts_of(const Field& field, const Dark& picture, std::vector<std::uint8_t>& seen,
                           Vec3 object_colour) {
  std::vector<Part> parts;
  for (std::size_t start = 0; start < field.pixels(); ++start) {
    const auto within = [&](std::size_t p) { return picture.dark(p) && (field.beyond.empty() || !field.beyond[p]); };
    if (seen[start] || !within(start)) continue;
    Part part{picture.part({start}, seen, within)};
    if (part.pixels.size() < speck) continue;
    part.level = picture.level(part.pixels), part.grounded = picture.meets_ground(part.pixels);
    part.unlike = norm(picture.colour(part.pixels) - object_colour);
    parts.push_back(std::move(part));
  }
  return parts;
}

// What the darkest tenth of `brightness` is not darker than: 0 where there are few.
double dark_tenth(std::vector<double>& brightness) {
  if (brightness.size() < large) return 0;
  const auto tenth = brightness.begin() + static_cast<std::ptrdiff_t>(brightness.size() / 10);
  std::nth_element(brightness.begin(), tenth, brightness.end());
  return *tenth;
}

}  // namespace

std::vector<std::uint8_t> judge_dark(const Field& field, std::span<const float> evidence,
                                     std::vector<std::uint8_t>& object) {
  const Dark picture(field, evidence);
  std::vector<std::uint8_t> unknown(field.pixels()), seen(field.pixels());
  std::vector<std::size_t> lit;
  for (std::size_t p = 0; p < field.pixels(); ++p)
    if (object[p] && !picture.dark(p) && static_cast<double>(evidence[p]) > sure) lit.push_back(p);
  const auto within = [&](std::size_t p) { return picture.dark(p) && (field.beyond.empty() || !field.beyond[p]); };
  std::vector<double> led_on;  // the shadow may be among it
  for (const std::size_t p : picture.part(lit, seen, within)) {
    if (!picture.dark(p) || !picture.open(p)) continue;
    object[p] = 1;
    unknown[p] = picture.brightness(p) < hardly_dark;
    if (unknown[p]) led_on.push_back(picture.brightness(p));
  }
  const std::vector<Part> parts = parts_of(field, picture, seen, picture.colour(lit));
  double darkest = dark_tenth(led_on), unlike = 0;
  for (const Part& part : parts)
    if (part.grounded && part.pixels.size() >= large)
      darkest = std::min(darkest, part.level), unlike = std::max(unlike, part.unlike);
  for (const Part& part : parts) {
    const bool coloured = unlike > distinct && part.unlike < 0.5 * unlike;  // as the object, where a shadow is not
    const bool shadow = part.grounded && part.level < darkest + levels && !coloured;
    for (const std::size_t p : part.pixels)
      if (picture.open(p)) object[p] = 0, unknown[p] = !shadow;
  }
  return unknown;
}

}  // namespace gonio::alignment
