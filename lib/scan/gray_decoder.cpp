// See gray_decoder.h.
#include "scan/gray_decoder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/parallel.h"
#include "photograph/noise_variance.h"
#include "scan/bit_kernel.h"
#include "scan/frame_noise.h"

namespace gonio::scan {
namespace {

using What = Shown::What;

constexpr float least_of_noise = 8;  // what white adds, over its noise
constexpr std::size_t blocks_at_once = 32;
constexpr int direct_bits = 5;          // next to the finest, of each axis: what tells direct light
constexpr float direct_margin = 0.15f;  // error of the direct share, twice, and of a bit's
constexpr int coarser = 3;              // than the finest bit: of which light goes to few stripes
constexpr float moved_share = 0.5f;     // of what white adds: something else stands there

class GrayDecoder {
 public:
  GrayDecoder(const DecodeRequest& r, const FrameReader& read, std::size_t white, std::size_t black, Codes& codes)
      : r_(r), read_(read), codes_(codes), white_(read(white)), black_(read(black)) {}

  void run() {
    find_reflected();
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

  // body(first, count): a block of pixels.
  template <class Body>
  void for_blocks(const Body& body) const {
    const std::size_t pixels = white_.size(), chunk = pixels_of_block * blocks_at_once;
    parallel_for(0, (pixels + chunk - 1) / chunk, [&](std::size_t n) {
      for (std::size_t i = n * chunk; i < std::min(pixels, (n + 1) * chunk); i += pixels_of_block)
        body(i, std::min(pixels_of_block, pixels - i));
    });
  }

  void find_reflected() {
    codes_.reflected.resize(white_.size());
    for_blocks([&](std::size_t first, std::size_t count) {
      Block<float> white, black;
      light_of(white_, first, count, white), light_of(black_, first, count, black);
      for (std::size_t i = 0; i < count; ++i) codes_.reflected[first + i] = white[i] - black[i];
    });
  }

  void find_dark() {
    const photograph::NoiseModel own(codes_.noise);
    const photograph::NoiseVariance variance_of(own);
    for_blocks([&](std::size_t first, std::size_t count) {
      for (std::size_t i = first; i < first + count; ++i) {
        if (!codes_.told(i)) continue;
        const double reflected = codes_.reflected[i], variance = variance_of(white_.at(i)) + variance_of(black_.at(i));
        if (reflected < r_.least_reflected || reflected <= 0 ||
            reflected * reflected <= least_of_noise * least_of_noise * variance)
          codes_.refusal[i] = Refusal::dark;
        else if (black_.full(i))
          codes_.refusal[i] = Refusal::saturated;  // and white: nothing differs
      }
    });
  }

  // Two bits that are shown one after the other, each with its inverse: later ones have seen the scene drift.
  manifest::Noise found_noise() {
    std::vector<std::size_t> frames;
    for (std::size_t f = 0; f < r_.sequence.frames.size() && frames.size() < 4; ++f) {
      const Shown& s = r_.sequence.frames[f];
      if (s.what != What::bit || s.inverse) continue;
      if (const auto inverse = inverse_of(s)) frames.insert(frames.end(), {f, *inverse});
    }
    if (frames.size() < 4) {
      const auto reflected = [&](std::size_t i) { return codes_.reflected[i]; };
      return noise_of(between_neighbours(reflected, std::sqrt(2.0), reflected, r_.width, r_.height));
    }
    for (const std::size_t f : frames) kept_[f] = {};
    parallel_for(0, 4, [&](std::size_t k) { kept_[frames[k]] = read_(frames[k]); });
    const CameraFrame &a = kept_[frames[0]], &b = kept_[frames[1]], &c = kept_[frames[2]], &d = kept_[frames[3]];
    const auto left = [&](std::size_t i) {
      return a.full(i) || b.full(i) || c.full(i) || d.full(i) ? std::numeric_limits<float>::quiet_NaN()
                                                              : a.at(i) + b.at(i) - c.at(i) - d.at(i);
    };
    const auto light = [&](std::size_t i) { return 0.25f * (a.at(i) + b.at(i) + c.at(i) + d.at(i)); };
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
      if (bits.empty()) continue;
      finest_[static_cast<std::size_t>(axis)] = bits.front();
      gray_[static_cast<std::size_t>(axis)].resize(white_.size());
      for (std::size_t k = 1; r_.indirect && k < std::min<std::size_t>(bits.size(), 1 + direct_bits); ++k)
        shares_[{axis, bits[k]}].assign(white_.size(), 0);
    }
    if (r_.indirect) least_share_.assign(white_.size(), 255);
  }

  void refuse_indirect() {
    std::vector<const std::vector<std::uint8_t>*> all;
    for (const auto& [bit, shares] : shares_) all.push_back(&shares);
    for_blocks([&](std::size_t first, std::size_t count) {
      for (std::size_t i = first; i < first + count; ++i) {
        const float least = static_cast<float>(least_share_[i]) * share_unit;
        if (3 * least > 1 + direct_margin || !codes_.told(i)) continue;  // the median is no less
        std::array<std::uint8_t, 2 * direct_bits> own{};
        for (std::size_t k = 0; k < all.size(); ++k) own[k] = (*all[k])[i];
        const auto middle = own.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
        std::nth_element(own.begin(), middle, own.begin() + static_cast<std::ptrdiff_t>(all.size()));
        if (least <= 1 + direct_margin - 2 * static_cast<float>(*middle) * share_unit)
          codes_.refusal[i] = Refusal::interreflection;
      }
    });
  }

  CameraFrame frame(std::size_t f) {
    const auto kept = kept_.find(f);
    return kept == kept_.end() ? read_(f) : std::move(kept->second);
  }

  BitLimits limits() const {
    const photograph::NoiseModel noise(codes_.noise);
    const photograph::NoiseVariance variance_of(noise);
    return {static_cast<float>(r_.least_difference),
            static_cast<float>(r_.least_share),
            static_cast<float>(r_.least_sigmas * r_.least_sigmas),
            static_cast<float>(variance_of.least()),
            static_cast<float>(variance_of.slope()),
            static_cast<float>(moved_least),
            moved_share,
            static_cast<float>(moved_sigmas * moved_sigmas)};
  }

  void take(Axis axis, int bit, std::size_t bit_frame, std::optional<std::size_t> inverse_frame) {
    CameraFrame own, inverse;
    parallel_for(0, inverse_frame ? 2 : 1,
                 [&](std::size_t k) { (k == 0 ? own : inverse) = frame(k == 0 ? bit_frame : *inverse_frame); });
    std::vector<std::uint32_t>& gray = gray_[static_cast<std::size_t>(axis)];
    const BitLimits limit = limits();
    const auto direct = shares_.find({axis, bit});
    const bool of_many = bit >= finest_[static_cast<std::size_t>(axis)] + coarser,
               coarse = !least_share_.empty() && of_many, moves = r_.motion && of_many;
    for_blocks([&](std::size_t first, std::size_t count) {
      BitBlock read;
      BitVerdict verdict;
      Block<float> white, black;
      light_of(own, first, count, read.bit);
      if (inverse_frame) light_of(inverse, first, count, read.inverse);
      light_of(white_, first, count, white), light_of(black_, first, count, black);
      for (std::size_t i = 0; i < count; ++i) read.lit_and_dark[i] = white[i] + black[i];
      std::copy_n(&codes_.reflected[first], count, read.reflected.begin());
      judge_bits(read, limit, inverse_frame.has_value(), verdict);
      if (moves && std::ranges::count(verdict.moved, 0u) < static_cast<std::ptrdiff_t>(pixels_of_block))
        for (std::size_t i = 0; i < count; ++i)  // what is full is less than it should be
          if (white_.full(first + i) || own.full(first + i) || inverse.full(first + i)) verdict.moved[i] = 0;
      note_bits(verdict, bit, count,
                {&gray[first], &codes_.refusal[first], coarse ? &least_share_[first] : nullptr,
                 direct != shares_.end() ? &direct->second[first] : nullptr, moves});
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
    for_blocks([&](std::size_t first, std::size_t count) {
      for (std::size_t i = first; i < first + count; ++i) {
        const int stripe = number_of_gray(static_cast<int>(gray[i] >> finest));
        place[i] = static_cast<float>(stripe * width) + 0.5f * static_cast<float>(width - 1);
        sigma[i] = static_cast<float>(width / std::sqrt(12.0));
      }
    });
  }

  const DecodeRequest& r_;
  const FrameReader& read_;
  Codes& codes_;
  CameraFrame white_, black_;
  std::map<std::size_t, CameraFrame> kept_;  // by frame: those that told the noise, until they are taken
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
