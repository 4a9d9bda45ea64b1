// See line_decoder.h.
#include "scan/line_decoder.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "photograph/noise_variance.h"

namespace gonio::scan {
namespace {

using What = Shown::What;

constexpr int half_window = 3;        // offsets to each side of the brightest that the centre is taken over
constexpr double least_of_noise = 6;  // a line's light, over its noise
constexpr double off_stripe = 0.45;   // periods that a centre may lie from the middle of its Gray code's stripe
constexpr std::size_t pixels_at_once = 1 << 14;

// Readings of a pixel with the line at offset 0, 1, ..., which go round.
struct Line {
  double centre = 0, sigma = 0;  // offset
  double light = 0, light_sigma = 0;
};

// The centroid of what the frames about the brightest have more than the mean of the others. Along a line that a lens
// blurs, whose pixels' light adds up to an even one, it is where the pixel looks. With w_k = v_k - b, A = sum w_k,
//   var(c) = (sum (k - c)^2 var_k + (sum (k - c))^2 var_b) / A^2.
Line line_of(const std::vector<float>& readings, const manifest::Noise& noise) {
  const int period = static_cast<int>(readings.size()), half = std::min(half_window, (period - 2) / 2);
  const int brightest = static_cast<int>(std::ranges::max_element(readings) - readings.begin());
  const auto at = [&](int k) { return double{readings[static_cast<std::size_t>((k + period) % period)]}; };
  double between = 0;
  const int others = period - 2 * half - 1;
  for (int k = half + 1; k <= half + others; ++k) between += at(brightest + k) / others;
  Line line;
  double moment = 0;
  for (int k = -half; k <= half; ++k)
    line.light += at(brightest + k) - between, moment += k * (at(brightest + k) - between);
  const double centre = line.light > 0 ? moment / line.light : 0;
  double variance = 0, sum = 0, of_light = 0;
  for (int k = -half; k <= half; ++k) {
    const double own = photograph::noise_variance(noise, std::max(0.0, at(brightest + k)));
    variance += (k - centre) * (k - centre) * own, sum += k - centre, of_light += own;
  }
  const double of_between = photograph::noise_variance(noise, std::max(0.0, between)) / others;
  line.centre = brightest + centre;
  line.light_sigma = std::sqrt(of_light + (2 * half + 1) * (2 * half + 1) * of_between);
  line.sigma = line.light > 0 ? std::sqrt(variance + sum * sum * of_between) / line.light : 1.0 * period;
  return line;
}

class LineDecoder {
 public:
  LineDecoder(const DecodeRequest& r, const FrameReader& read, Codes& codes) : r_(r), read_(read), codes_(codes) {}

  void run(Axis axis) {
    std::vector<std::size_t> frames;  // by offset
    for (std::size_t f = 0; f < r_.sequence.frames.size(); ++f) {
      const Shown& s = r_.sequence.frames[f];
      if (s.what != What::line || s.axis != axis) continue;
      frames.resize(static_cast<std::size_t>(s.period_px));
      frames[static_cast<std::size_t>(s.offset_px)] = f;
    }
    if (frames.empty()) return;
    std::vector<CameraFrame> all(frames.size());
    parallel_for(0, frames.size(), [&](std::size_t k) { all[k] = read_(frames[k]); });
    const std::size_t pixels = codes_.refusal.size();
    parallel_for(0, (pixels + pixels_at_once - 1) / pixels_at_once, [&](std::size_t n) {
      std::vector<float> readings(all.size());
      for (std::size_t i = n * pixels_at_once; i < std::min(pixels, (n + 1) * pixels_at_once); ++i)
        if (codes_.told(i)) codes_.refusal[i] = place_of(axis, all, i, readings);
    });
  }

 private:
  Refusal place_of(Axis axis, const std::vector<CameraFrame>& all, std::size_t i, std::vector<float>& readings) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all[k].full(i)) return Refusal::saturated;
      readings[k] = all[k].at(i);
    }
    const Line line = line_of(readings, codes_.noise);
    if (line.light <= least_of_noise * line.light_sigma) return Refusal::dark;
    const auto a = static_cast<std::size_t>(axis);
    const double period = static_cast<double>(all.size()), stripe = codes_.place[a][i],
                 off = std::remainder(line.centre - stripe, period);
    if (std::abs(off) > off_stripe * period) return Refusal::contradictory;
    codes_.place[a][i] = static_cast<float>(stripe + off), codes_.sigma[a][i] = static_cast<float>(line.sigma);
    return Refusal::none;
  }

  const DecodeRequest& r_;
  const FrameReader& read_;
  Codes& codes_;
};

}  // namespace

void decode_lines(const DecodeRequest& request, const FrameReader& read, Codes& codes) {
  LineDecoder decoder(request, read, codes);
  for (const Axis axis : {Axis::column, Axis::row}) decoder.run(axis);
  codes.whole = false;
}

}  // namespace gonio::scan
