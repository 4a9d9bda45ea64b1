// See gray_decoder.h.
#include "scan/gray_decoder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/parallel.h"
#include "photograph/noise_variance.h"
#include "scan/frame_noise.h"

namespace gonio::scan {
namespace {

using What = Shown::What;

constexpr float least_of_noise = 8;  // what white adds, over its noise
constexpr std::size_t rows_at_once = 1 << 15;
constexpr int direct_bits = 5;           // next to the finest, of each axis: what tells direct light
constexpr float share_unit = 1 / 200.f;  // of shares in bytes
constexpr float direct_margin = 0.15f;   // error of the direct share, twice, and of a bit's
constexpr int coarser = 3;               // than the finest bit: of which light goes to few stripes

std::uint8_t share_code(float share) {
  return static_cast<std::uint8_t>(std::clamp(share, 0.0f, 1.2f) / share_unit + 0.5f);
}

class GrayDecoder {
 public:
  GrayDecoder(const DecodeRequest& r, const FrameReader& read, std::size_t white, std::size_t black, Codes& codes)
      : r_(r), read_(read), codes_(codes), white_(read(white)), black_(read(black)) {}

  void run() {
    const std::size_t pixels = white_.size();
    codes_.reflected.resize(pixels);
    for (std::size_t i = 0; i < pixels; ++i) codes_.reflected[i] = white_.at(i) - black_.at(i);
    codes_.noise = r_.noise ? *r_.noise : found_noise();
    find_dark();
    find_bits();
    for (const Axis axis : {Axis::column, Axis::row})
      for (std::size_t f = 0; f < r_.sequence.frames.size(); ++f) {
        const Shown& s = r_.sequence.frames[f];
        if (s.what == What::bit && s.axis == axis && !s.inverse) take(axis, s.bit, f, inverse_of(s));
      }
    if (shares_.size() > 1) refuse_indirect();
    for (const Axis axis : {Axis::column, Axis::row}) places(axis);
    codes_.whole = true;
  }

 private:
  std::optional<std::size_t> inverse_of(const Shown& shown) const {
    Shown wanted = shown;
    wanted.inverse = true;
    const auto found = std::ranges::find(r_.sequence.frames, wanted);
    if (found == r_.sequence.frames.end()) return std::nullopt;
    return static_cast<std::size_t>(found - r_.sequence.frames.begin());
  }

  template <class Body>
  void for_pixels(const Body& body) const {
    const std::size_t pixels = white_.size();
    parallel_for(0, (pixels + rows_at_once - 1) / rows_at_once, [&](std::size_t n) {
      for (std::size_t i = n * rows_at_once; i < std::min(pixels, (n + 1) * rows_at_once); ++i) body(i);
    });
  }

  void find_dark() {
    const photograph::NoiseModel own(codes_.noise);
    const photograph::NoiseVariance variance_of(own);
    for_pixels([&](std::size_t i) {
      if (!codes_.told(i)) return;
      const double noise = std::sqrt(variance_of(white_.at(i)) + variance_of(black_.at(i)));
      if (codes_.reflected[i] < r_.least_reflected || codes_.reflected[i] <= least_of_noise * noise)
        codes_.refusal[i] = Refusal::dark;
      else if (black_.full(i))
        codes_.refusal[i] = Refusal::saturated;  // and white: nothing differs
    });
  }

  // Two bits that are shown one after the other, each with its inverse: later ones have seen the scene drift.
  manifest::Noise found_noise() const {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t f = 0; f < r_.sequence.frames.size() && pairs.size() < 2; ++f) {
      const Shown& s = r_.sequence.frames[f];
      if (s.what != What::bit || s.inverse) continue;
      if (const auto inverse = inverse_of(s)) pairs.emplace_back(f, *inverse);
    }
    if (pairs.size() < 2)
      return noise_of(between_neighbours(codes_.reflected, std::sqrt(2.0), codes_.reflected, r_.width, r_.height));
    std::vector<float> left(white_.size()), light(left.size());
    for (const auto& [bit, inverse] : pairs) {
      const CameraFrame a = read_(bit), b = read_(inverse);
      const float sign = bit == pairs[0].first ? 1.0f : -1.0f;
      for (std::size_t i = 0; i < left.size(); ++i) {
        const bool counts = !a.full(i) && !b.full(i);
        left[i] += counts ? sign * (a.at(i) + b.at(i)) : std::numeric_limits<float>::quiet_NaN();
        light[i] += 0.25f * (a.at(i) + b.at(i));
      }
    }
    return noise_of(between_neighbours(left, 2, light, r_.width, r_.height));
  }

  // Which are finest; and room for a pixel's shares of what white adds by which bits and their inverses differ: of
  // those that tell direct light, and the least of the coarser ones.
  void find_bits() {
    for (const Axis axis : {Axis::column, Axis::row}) {
      std::vector<int> bits;
      for (const Shown& s : r_.sequence.frames)
        if (s.what == What::bit && s.axis == axis && !s.inverse) bits.push_back(s.bit);
      std::ranges::sort(bits);
      if (!bits.empty()) finest_[static_cast<std::size_t>(axis)] = bits.front();
      for (std::size_t k = 1; r_.indirect && k < std::min<std::size_t>(bits.size(), 1 + direct_bits); ++k)
        shares_[{axis, bits[k]}].assign(white_.size(), 0);
    }
    if (r_.indirect) least_share_.assign(white_.size(), 255);
  }

  void refuse_indirect() {
    std::vector<const std::vector<std::uint8_t>*> all;
    for (const auto& [bit, shares] : shares_) all.push_back(&shares);
    for_pixels([&](std::size_t i) {
      if (!codes_.told(i)) return;
      const float least = static_cast<float>(least_share_[i]) * share_unit;
      if (3 * least > 1 + direct_margin) return;  // the median is no less
      std::array<std::uint8_t, 2 * direct_bits> own{};
      for (std::size_t k = 0; k < all.size(); ++k) own[k] = (*all[k])[i];
      const auto middle = own.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
      std::nth_element(own.begin(), middle, own.begin() + static_cast<std::ptrdiff_t>(all.size()));
      if (least <= 1 + direct_margin - 2 * static_cast<float>(*middle) * share_unit)
        codes_.refusal[i] = Refusal::interreflection;
    });
  }

  void take(Axis axis, int bit, std::size_t frame, std::optional<std::size_t> inverse_frame) {
    CameraFrame own;
    std::optional<CameraFrame> inverse;
    parallel_for(0, inverse_frame ? 2 : 1, [&](std::size_t k) {
      if (k == 0)
        own = read_(frame);
      else
        inverse = read_(*inverse_frame);
    });
    std::vector<std::uint32_t>& gray = gray_[static_cast<std::size_t>(axis)];
    gray.resize(own.size());
    const photograph::NoiseModel noise(codes_.noise);
    const photograph::NoiseVariance variance_of(noise);
    const double sigmas = r_.least_sigmas * r_.least_sigmas;
    const auto direct = shares_.find({axis, bit});
    const bool coarse = !least_share_.empty() && bit >= finest_[static_cast<std::size_t>(axis)] + coarser;
    for_pixels([&](std::size_t i) {
      if (!codes_.told(i)) return;
      const float read = own.at(i), other = inverse ? inverse->at(i) : 0.5f * (white_.at(i) + black_.at(i)),
                  difference = inverse ? read - other : 2 * (read - other), size = std::abs(difference);
      if (size < r_.least_difference || size < r_.least_share * codes_.reflected[i] ||
          double{size} * size < sigmas * (variance_of(read) + variance_of(other)))
        codes_.refusal[i] = Refusal::edge;
      if (difference > 0) gray[i] |= 1u << bit;
      if (!coarse && direct == shares_.end()) return;
      const std::uint8_t share = share_code(size / codes_.reflected[i]);
      if (coarse) least_share_[i] = std::min(least_share_[i], share);
      if (direct != shares_.end()) direct->second[i] = share;
    });
  }

  // A stripe's middle.
  void places(Axis axis) {
    const std::vector<std::uint32_t>& gray = gray_[static_cast<std::size_t>(axis)];
    if (gray.empty()) return;
    std::vector<float>&place = codes_.place[static_cast<std::size_t>(axis)],
    &sigma = codes_.sigma[static_cast<std::size_t>(axis)];
    place.resize(gray.size()), sigma.resize(gray.size());
    const int finest = finest_[static_cast<std::size_t>(axis)], width = 1 << finest;
    for_pixels([&](std::size_t i) {
      const int stripe = number_of_gray(static_cast<int>(gray[i] >> finest));
      place[i] = static_cast<float>(stripe * width) + 0.5f * static_cast<float>(width - 1);
      sigma[i] = static_cast<float>(width / std::sqrt(12.0));
    });
  }

  const DecodeRequest& r_;
  const FrameReader& read_;
  Codes& codes_;
  CameraFrame white_, black_;
  std::array<std::vector<std::uint32_t>, 2> gray_;
  std::array<int, 2> finest_{};
  std::map<std::pair<Axis, int>, std::vector<std::uint8_t>> shares_;
  std::vector<std::uint8_t> least_share_;
};

}  // namespace

void decode_gray(const DecodeRequest& request, const FrameReader& read, std::size_t white, std::size_t black,
                 Codes& codes) {
  GrayDecoder(request, read, white, black, codes).run();
}

}  // namespace gonio::scan
