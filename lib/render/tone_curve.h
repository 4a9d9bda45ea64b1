// Responses of sensors, film and the processing behind them: from light to what is read, step 6 of
// render/sensor_chain.h. All quantities are over a reference; what is negative is mirrored about zero.
//   quadratic   reading = v (1 + quadratic v)
//   power law   reading = v^gamma, with a linear toe where it has one
//   shoulder    reading = v (1 + shoulder) / (1 + shoulder v)
//   tone curve  d ln(light) / d ln(reading) = p(reading), p linear in ln(reading) between nodes, constant beyond them
// The tone curve is the inverse response of Debevec & Malik 1997, equation 3, g(reading) = ln(light), by its slope in
// logarithms rather than by a value for each code: any positive slopes make a rising curve, slopes of one are a linear
// sensor, and equal slopes p are the power law gamma = 1 / p. Light and reading agree at one.
#pragma once
#include <array>
#include <cstddef>

namespace gonio::render {

inline constexpr std::array<double, 11> tone_nodes{1.0 / 64, 1.0 / 32, 1.0 / 16, 3.0 / 32, 1.0 / 8, 3.0 / 16,
                                                   1.0 / 4,  3.0 / 8,  1.0 / 2,  3.0 / 4,  1.0};
inline constexpr std::size_t tone_anchor = 6;              // the node at a quarter
using ToneSlopes = std::array<double, tone_nodes.size()>;  // p at the nodes, each > 0
inline constexpr ToneSlopes linear_tone{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
// The slopes as they are declared and fitted: `slope` at the anchor; going outwards from it to both sides, each bend is
// the logarithm of the outer slope over the inner one. bends[k] lies between nodes k and k + 1.
using ToneBends = std::array<double, tone_nodes.size() - 1>;
ToneSlopes slopes_of(double slope, const ToneBends& bends);

class ToneCurve {
 public:
  explicit ToneCurve(const ToneSlopes& slopes = linear_tone);
  bool linear() const { return linear_; }
  double light(double reading) const;
  double reading(double light) const;  // its inverse

 private:
  double log_light(double log_reading) const;
  ToneSlopes slopes_, log_light_;  // the latter at the nodes
  bool linear_;
};

// One reading: the four in this order, each with `reference` as its unit. Unchanged to the last bit where quadratic
// and shoulder are 0, gamma is 1 and the curve is linear.
struct Response {
  double quadratic = 0, gamma = 1, reference = 1;
  ToneCurve curve{};
  double toe = 0, shoulder = 0;
  double operator()(double light) const;
  double light(double reading) const;  // the inverse; the rising branch of the quadratic, its top beyond
};

}  // namespace gonio::render
