// optics.bloom: the halo comes from the recorded picture, which holds the bloom itself. With K the convolution with a
// halo's kernel the picture without it is (1 - s + s K)^-1 of the recorded one, so that its halo is
//   K (1 + s (1 - K) + s^2 (1 - K)^2 + ...) of what is recorded,
// and K^n is the convolution with n times the radius (render/halo.h): three radii suffice, what is left is of the order
// of s^3. Of the pixel itself the predicted value is taken, so that no reading is held against its own noise. Halos are
// tabulated over the radius' logarithm, half an octave apart, with cubics between; where the amounts are settled, at
// the three radii alone.
#include "render/mechanisms/optics_bloom.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "geom/cubic_weights.h"
#include "relighting/image_model.h"
#include "relighting/observed.h"
#include "relighting/uses.h"
#include "render/halo.h"

namespace gonio::relighting::terms {
namespace {

constexpr std::size_t powers = 3;  // of K
constexpr double nodes_per_doubling = 2;
constexpr std::size_t channels = 3;

struct Halos final : Prepared {
  std::vector<double> radii_px;  // of the nodes, evenly spaced in the logarithm; where settled: R, 2 R, 3 R
  bool settled = false;
  std::vector<std::vector<float>> around;  // [image; empty: not meant][pixel of the view's cache][node][channel]

  // Around the pixel, by `power` times the radius.
  Rgb at(std::size_t image, std::uint32_t pixel, double radius_px, std::size_t power) const {
    const float* table = &around[image][pixel * radii_px.size() * channels];
    const auto value = [&](std::size_t node) {
      const float* v = table + node * channels;
      return Rgb{v[0], v[1], v[2]};
    };
    if (settled) return value(power - 1);
    const double place =
        std::clamp(nodes_per_doubling * std::log2(static_cast<double>(power) * radius_px / radii_px[0]), 0.0,
                   static_cast<double>(radii_px.size()) - 1);
    const std::size_t k = std::min(static_cast<std::size_t>(place), radii_px.size() - 2);
    const std::array<double, 4> weight = cubic_weights(place - static_cast<double>(k));
    return value(k > 0 ? k - 1 : 0) * weight[0] + value(k) * weight[1] + value(k + 1) * weight[2] +
           value(std::min(k + 2, radii_px.size() - 1)) * weight[3];
  }
};

std::vector<Use> candidates(const Setting& s) {
  return camera_uses(s, mechanism::optics_bloom());
}

std::shared_ptr<const Prepared> prepare(const Setting& s, const Use& use) {
  auto result = std::make_shared<Halos>();
  const mechanism::Parameter& radius = mechanism::optics_bloom().parameters[1];
  if (s.fitted != nullptr && use.sets == 1) {
    result->settled = true;
    for (std::size_t n = 1; n <= powers; ++n)
      result->radii_px.push_back(static_cast<double>(n) * use.amounts(*s.fitted)[1]);
  } else {
    for (double r = radius.lower; r < powers * radius.upper * std::exp2(1 / nodes_per_doubling);
         r *= std::exp2(1 / nodes_per_doubling))
      result->radii_px.push_back(r);
  }
  for (const Recording& image : s.recordings.images) {
    if (!camera_target(use, s.recordings, image)) {
      result->around.emplace_back();
      continue;
    }
    const std::vector<Pixel>& pixels = s.model.cache(image.view).pixels;
    const render::Halo halo(image.picture, result->radii_px);
    const std::size_t stride = result->radii_px.size() * channels;
    std::vector<float>& table = result->around.emplace_back(pixels.size() * stride);
    parallel_for(
        0, pixels.size(),
        [&](std::size_t i) {
          const std::vector<double> around = halo.around(pixels[i].x, pixels[i].y);
          for (std::size_t k = 0; k < stride; ++k) table[i * stride + k] = static_cast<float>(around[k]);
        },
        64);
  }
  return result;
}

void record(const Use& use, const Frame& frame, std::span<double> values) {
  const std::span<const double> amounts = camera_amounts(use, frame);
  const double share = amounts[0], radius = amounts[1];
  if (share == 0) return;
  const auto& halos = static_cast<const Halos&>(*use.prepared);
  for (std::size_t i = 0; i < frame.picked.size(); ++i) {
    const std::span<double> own = values.subspan(channels * i, channels);
    std::array<Rgb, powers> k;
    for (std::size_t n = 0; n < powers; ++n) {
      const double power = static_cast<double>(n + 1);
      k[n] = halos.at(frame.number, frame.picked[i], radius, n + 1) +
             Rgb{own[0], own[1], own[2]} * render::Halo::own_share(power * radius);
    }
    const Rgb halo = k[0] + (k[0] - k[1]) * share + (k[0] - k[1] * 2 + k[2]) * (share * share);
    for (std::size_t c = 0; c < channels; ++c)
      own[c] = equation::optics_bloom(own[c], share, halo[static_cast<int>(c)]);
  }
}

}  // namespace

const Term& optics_bloom() {
  static const Term term{
      .mechanism = mechanism::optics_bloom,
      .reach = Reach::record,
      .order = 8,
      .candidates = candidates,
      .prepare = prepare,
      .record = record,
      .pointwise = true,
  };
  return term;
}

}  // namespace gonio::relighting::terms
