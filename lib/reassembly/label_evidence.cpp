// How well each material explains a pixel, with light that is known or not, with a highlight or without.
//
// With shading S, a material of albedo a sends v = a S (1 + e) + h l + noise: e is the shading's error, common to the
// channels; h >= 0 is a highlight of the light's colour l = S / mean(S). The covariance D + s_e^2 p p' of p = a S is
// inverted by Sherman & Morrison's formula, h by completing the square (Laplace's approximation of its integral). A
// Student density of four degrees keeps what no material explains from being evidence for any.
// Without shading v = s a + h + noise, and s is integrated over with the scale-free prior ds / s: that leaves the two
// dimensions of chromaticity, which a shadow does not change (the dichromatic model, Shafer 1985).
#include "reassembly/label_evidence.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"

namespace gonio::reassembly {
namespace {

constexpr float student_degrees = 4, highlight_share = 0.05f;

struct Setting {
  float per_value = 0, read = 0, shading_precision = 0, lack = 0;
  bool highlight_known = false;
};

struct Sums {  // of residual r, prediction p and highlight's colour l under the inverse variances
  float rr = 0, rp = 0, pp = 0, lr = 0, lp = 0, ll = 0, precision = 1;
  void add(float r, float p, float l, float weight) {
    rr += r * r * weight;
    rp += r * p * weight;
    pp += p * p * weight;
    lr += l * r * weight;
    lp += l * p * weight;
    ll += l * l * weight;
    precision *= weight;
  }
};

float student(float chi_square, float dimensions) {
  return -0.5f * (student_degrees + dimensions) * std::log(1 + std::max(0.0f, chi_square) / student_degrees);
}

// Log of the highlights' share of the density: that of h is scale / (scale + h)^2, heavy in the tail, for they are as
// bright as lights; times the Gaussian integral about the best h.
float glint_density(float h, float scale, float stiffness) {
  const float beyond = 1 + h / scale;
  return 0.5f * std::log(6.2831853f / (stiffness * scale * scale * beyond * beyond * beyond * beyond));
}

float lit_density(const Tone& v, const Tone& s, float s_mean, float glint, const LabelColour& colour,
                  const Setting& setting) {
  Sums sums;
  for (std::size_t c = 0; c < 3; ++c) {
    const float p = colour.albedo[c] * s[c], lacking = colour.albedo[c] * setting.lack, spread = colour.spread * p;
    const float variance = p * setting.per_value + setting.read + spread * spread + lacking * lacking;
    sums.add(v[c] - p, p, s[c] / s_mean, 1 / variance);
  }
  const float joint = setting.shading_precision + sums.pp, chi_square = sums.rr - sums.rp * sums.rp / joint;
  const float volume = 0.5f * std::log(sums.precision * setting.shading_precision / joint);
  const float share = setting.highlight_known ? 0.5f : highlight_share;
  const float plain = std::log(1 - share) + volume + student(chi_square, 3);
  if (!setting.highlight_known && chi_square < 3) return plain;  // nothing is left for a highlight to explain
  const float slope = sums.lr - sums.lp * sums.rp / joint, stiffness = sums.ll - sums.lp * sums.lp / joint;
  if (!(slope > 0) || !(stiffness > 0)) return plain;
  const float h = slope / stiffness, scale = setting.highlight_known ? glint + 0.01f * s_mean : 0.2f * s_mean;
  const float shining =
      std::log(share) + volume + student(chi_square - h * slope, 2) + glint_density(h, scale, stiffness);
  return std::max(plain, shining);
}

float unlit_density(const Tone& v, const LabelColour& colour, const Setting& setting) {
  float vv = 0, va = 0, aa = 0, l_v = 0, l_a = 0, ll = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float value = std::max(v[c], 0.0f), spread = colour.spread * value;
    const float weight = 1 / (value * setting.per_value + setting.read + spread * spread), a = colour.albedo[c];
    vv += v[c] * v[c] * weight;
    va += v[c] * a * weight;
    aa += a * a * weight;
    l_v += v[c] * weight;
    l_a += a * weight;
    ll += weight;
  }
  if (!(va > 0)) return -30;
  const float s = va / aa, chi_square = vv - s * va, stiffness = ll - l_a * l_a / aa;
  const float volume = -std::log(s * std::sqrt(aa));
  const float plain = volume + student(chi_square, 2);
  const float slope = l_v - l_a * s;
  if (!(slope > 0) || !(stiffness > 1e-3f * ll)) return plain;
  const float h = slope / stiffness, under = s - h * l_a / aa;  // what is left for the material itself
  if (!(under > 0.1f * s)) return plain;
  const float scale = 0.5f * s * (colour.albedo[0] + colour.albedo[1] + colour.albedo[2]) / 3;
  const float glint = glint_density(h, scale, stiffness);
  return std::max(plain, std::log(highlight_share) + volume + student(chi_square - h * slope, 1) + glint);
}

// Takes mixed pixels apart: see unmix().
class Unmixing {
 public:
  Unmixing(Evidence& evidence, const io::Image& picture, const LabelWish& wish)
      : evidence_(evidence), labels_(evidence.labels), values_(picture, "the photograph"), best_(evidence.pixels()) {
    if (!wish.shading.data.empty()) shading_ = {wish.shading, "the shading"};
    each_row([&](int y) {
      for (std::size_t i = at(0, y); i < at(0, y + 1); ++i) best_[i] = told(evidence_.of(i));
    });
  }
  void run() {
    each_row([&](int y) {
      for (int x = 0; x < evidence_.width; ++x) {
        // Near pairs decide for all pixels; farther ones, for blurred borders, for what is neither side's material.
        mend(x, y, 2, false);
        mend(x, y, 4, true);
      }
    });
  }

 private:
  template <class Body>
  void each_row(const Body& body) {
    parallel_for(0, static_cast<std::size_t>(evidence_.height), [&](std::size_t y) { body(static_cast<int>(y)); });
  }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(evidence_.width) + static_cast<std::size_t>(x);
  }
  std::int32_t told(const float* log) const {  // unlabelled: several labels explain it
    const float* most = std::max_element(log, log + labels_);
    const auto rivals = std::count_if(log, log + labels_, [&](float v) { return v > *most - 2; });
    return rivals == 1 ? static_cast<std::int32_t>(most - log) : unlabelled;
  }
  Tone tone(std::size_t i) const {
    Tone v = values_(i);
    if (!shading_.known()) return v;
    const Tone s = shading_(i);
    for (std::size_t c = 0; c < 3; ++c) v[c] /= std::max(s[c], 1e-6f);
    return v;
  }
  // Where between a and b the pixel lies, 0 to 1, or -1 where it does not.
  float between(std::size_t i, std::size_t a, std::size_t b, float& contrast) const {
    const Tone from = tone(a), to = tone(b), here = tone(i);
    float along = 0, off = 0;
    contrast = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      along += (here[c] - from[c]) * (to[c] - from[c]);
      contrast += (to[c] - from[c]) * (to[c] - from[c]);
    }
    const float t = along / std::max(contrast, 1e-12f);
    for (std::size_t c = 0; c < 3; ++c) {
      const float rest = here[c] - from[c] - t * (to[c] - from[c]);
      off += rest * rest;
    }
    return t > 0.05f && t < 0.95f && off < 0.04f * contrast ? t : -1.0f;
  }
  void mend(int x, int y, int reach, bool third_only) {
    constexpr std::array<std::array<int, 2>, 4> ways{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
    const std::size_t i = at(x, y);
    float most = 0, share = -1;
    std::int32_t one = 0, other = 0;
    for (const auto& way : ways) {
      const int dx = way[0] * reach, dy = way[1] * reach, tall = std::abs(dy);
      if (x < dx || x + dx >= evidence_.width || y < tall || y + tall >= evidence_.height) continue;
      const std::size_t off = at(dx, 0) + static_cast<std::size_t>(dy) * static_cast<std::size_t>(evidence_.width);
      const std::size_t a = i - off, b = i + off;  // modulo 2^64 where dy < 0
      if (best_[a] == best_[b] || best_[a] < 0 || best_[b] < 0) continue;
      if (third_only && (best_[i] == best_[a] || best_[i] == best_[b])) continue;
      float contrast = 0;
      const float t = between(i, a, b, contrast);
      if (t < 0 || contrast <= most) continue;
      most = contrast;
      share = t;
      one = best_[a];
      other = best_[b];
    }
    if (share < 0) return;
    float* log = evidence_.of(i);
    std::fill(log, log + labels_, -8.0f);
    const float lean = 4 * (2 * share - 1);  // towards `other`
    log[one] = std::min(0.0f, -lean);
    log[other] = std::min(0.0f, lean);
  }

  Evidence& evidence_;
  int labels_;
  Tones values_, shading_;
  std::vector<std::int32_t> best_;
};

}  // namespace

Tones::Tones(const io::Image& picture, const char* place, int width, int height)
    : data_(picture.data.data()), stride_(picture.channels.size()), pixels_(picture.pixels()) {
  const int grey = picture.channel("Y");
  const std::array<int, 3> rgb{picture.channel("R"), picture.channel("G"), picture.channel("B")};
  for (std::size_t c = 0; c < 3; ++c) {
    const int channel = rgb[c] >= 0 ? rgb[c] : grey;
    if (channel < 0)
      throw Error(Exit::data, place, "has neither channels R, G, B nor Y", "give a photograph in linear colour");
    channel_[c] = static_cast<std::size_t>(channel);
  }
  if (width > 0 && (picture.width != width || picture.height != height))
    throw Error(Exit::data, place,
                "is of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                    " pixels, its photograph of " + std::to_string(width) + " x " + std::to_string(height),
                "render it with the photograph's camera");
}

Tone Tones::mean() const {
  std::array<double, 3> sum{};
  double count = 0;
  for (std::size_t i = 0; i < pixels_; ++i) {
    const Tone tone = (*this)(i);
    if (!std::isfinite(tone[0] + tone[1] + tone[2])) continue;
    for (std::size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(tone[c]);
    ++count;
  }
  Tone mean{};
  for (std::size_t c = 0; c < 3; ++c) mean[c] = count > 0 ? static_cast<float>(sum[c] / count) : 0;
  return mean;
}

std::int32_t Evidence::best(std::size_t pixel) const {
  const float* first = of(pixel);
  return static_cast<std::int32_t>(std::max_element(first, first + labels) - first);
}

Evidence evidence_of(const io::Image& picture, const std::vector<std::uint8_t>& clipped, const LabelWish& wish,
                     std::span<const LabelColour> colours, std::int32_t labels) {
  const Tones values(picture, "the photograph");
  Tones shading, highlight;
  if (!wish.shading.data.empty()) shading = {wish.shading, "the shading", picture.width, picture.height};
  if (!wish.highlight.data.empty()) highlight = {wish.highlight, "the highlights", picture.width, picture.height};
  const auto level = [](const Tone& tone) { return (tone[0] + tone[1] + tone[2]) / 3; };
  const float lack = shading.known() ? static_cast<float>(wish.shading_lack) * level(shading.mean()) : 0;
  const auto read = static_cast<float>(wish.noise_read * wish.noise_read);
  const Setting setting{wish.noise_gain > 0 ? static_cast<float>(1 / wish.noise_gain) : 0, std::max(read, 1e-12f),
                        static_cast<float>(1 / (wish.shading_spread * wish.shading_spread)), lack, highlight.known()};
  Evidence evidence{picture.width, picture.height, labels, {}};
  evidence.log.assign(evidence.pixels() * static_cast<std::size_t>(labels), 0);
  const auto pixel = [&](std::size_t i) {
    const Tone v = values(i), s = shading.known() ? shading(i) : Tone{};
    if ((!clipped.empty() && clipped[i] != 0) || !std::isfinite(level(v) + level(s))) return;  // says nothing
    const float s_mean = level(s), glint = highlight.known() ? std::max(0.0f, level(highlight(i))) : 0;
    float* log = evidence.of(i);
    std::fill(log, log + labels, -1e30f);
    for (const LabelColour& colour : colours) {
      const float density =
          s_mean > lack ? lit_density(v, s, s_mean, glint, colour, setting) : unlit_density(v, colour, setting);
      log[colour.label] = std::max(log[colour.label], density);
    }
    const float most = *std::max_element(log, log + labels);
    for (std::int32_t k = 0; k < labels; ++k) log[k] = std::max(Evidence::least, log[k] - most);
  };
  const auto width = static_cast<std::size_t>(picture.width);
  parallel_for(0, static_cast<std::size_t>(picture.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) pixel(y * width + x);
  });
  return evidence;
}

void unmix(Evidence& evidence, const io::Image& picture, const LabelWish& wish) {
  Unmixing(evidence, picture, wish).run();
}

}  // namespace gonio::reassembly
