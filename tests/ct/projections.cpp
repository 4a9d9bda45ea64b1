// What the detector reads: rays through the phantom, photons of the spectrum, and the imperfections of scanner.h in the
// order in which a photon meets them.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "base/parallel.h"
#include "base/random.h"
#include "ct/scanner.h"

namespace gonio::ct {
namespace {

const std::vector<std::string> known{"scale", "beam-hardening", "cupping",   "scatter",     "ring", "streak",
                                     "blur",  "focal-spot",     "axis-tilt", "axis-offset", "drift"};

// T as a function of the lengths in the parts. Through one part alone, from a table of ln T; through several, summed
// up.
class Transmission {
 public:
  Transmission(const Phantom& phantom, const Spectrum& spectrum, double longest) : spectrum_(spectrum) {
    for (const Part& part : phantom.parts) {
      std::vector<double>& mu = attenuation_.emplace_back();
      for (const double e : spectrum.kev) mu.push_back(part.material.attenuation_per_m(e));
    }
    step_ = longest / steps;
    for (std::size_t k = 0; k < attenuation_.size(); ++k) {
      std::vector<double>& table = logarithm_.emplace_back(steps + 2);
      for (std::size_t s = 0; s < table.size(); ++s) {
        std::vector<double> lengths(attenuation_.size(), 0.0);
        lengths[k] = static_cast<double>(s) * step_;
        table[s] = std::log(summed(lengths));
      }
    }
  }
  double of(std::span<const double> lengths) const {
    std::size_t used = 0, part = 0;
    for (std::size_t k = 0; k < lengths.size(); ++k)
      if (lengths[k] > 0) ++used, part = k;
    if (used == 0) return 1;
    const double at = lengths[part] / step_;
    if (used > 1 || at >= steps) return summed(lengths);
    const auto s = static_cast<std::size_t>(at);
    const double f = at - static_cast<double>(s);
    return std::exp(logarithm_[part][s] * (1 - f) + logarithm_[part][s + 1] * f);
  }
  // Of the first part: the reading that its length would give with photons of one energy, by what it gives with all.
  double linearised(double reading) const {
    const std::vector<double>& table = logarithm_.front();
    const double slope = -table[1];
    // Below the table's first entry, which is nought but for rounding, the slope at nought goes on.
    if (reading <= std::max(0.0, -table.front())) return reading * step_ * mean_attenuation() / slope;
    const auto above = std::partition_point(table.begin(), table.end(), [&](double v) { return -v <= reading; });
    if (above == table.end()) return reading;
    const auto s = static_cast<std::size_t>(above - table.begin()) - 1;
    const double f = (reading + table[s]) / (table[s] - table[s + 1]);
    return (static_cast<double>(s) + f) * step_ * mean_attenuation();
  }

 private:
  static constexpr std::size_t steps = 4096;
  double mean_attenuation() const {
    return std::inner_product(attenuation_[0].begin(), attenuation_[0].end(), spectrum_.share.begin(), 0.0);
  }
  double summed(std::span<const double> lengths) const {
    double sum = 0;
    for (std::size_t e = 0; e < spectrum_.kev.size(); ++e) {
      double depth = 0;
      for (std::size_t k = 0; k < lengths.size(); ++k) depth += attenuation_[k][e] * lengths[k];
      sum += spectrum_.share[e] * std::exp(-depth);
    }
    return sum;
  }
  const Spectrum& spectrum_;
  std::vector<std::vector<double>> attenuation_;  // part, energy
  std::vector<std::vector<double>> logarithm_;    // part, length
  double step_ = 1;
};

// Rays of one view, in the phantom's frame.
class View {
 public:
  View(const Scanner& s, std::size_t view, std::size_t columns, std::size_t rows)
      : voxel_(s.voxel_m),
        source_(s.source_m),
        field_(static_cast<double>(s.voxels) * s.voxel_m),
        middle_u_((static_cast<double>(columns) - 1) / 2),
        middle_v_((static_cast<double>(rows) - 1) / 2),
        offset_(s.amplitude("axis-offset")) {
    const double angle =
        (s.source_m > 0 ? 2 * pi : pi) * static_cast<double>(view) / static_cast<double>(s.view_count());
    const double tilt = s.amplitude("axis-tilt");  // the axis is (sin, 0, cos) in the laboratory
    back_ = rotation_about({0, 0, 1}, -angle) * rotation_about({0, 1, 0}, -tilt);
  }
  // Through (u, v) of the detector; `spot`: where on the focal spot the ray begins, in pixels of its shadow at the
  // axis.
  Ray ray(double u, double v, Vec2 spot) const {
    const double x = (u - middle_u_ - offset_) * voxel_, z = (v - middle_v_) * voxel_;
    Vec3 from, through;
    if (source_ > 0) {  // the detector stands one field behind the axis
      const double to_detector = source_ + field_, widened = to_detector / source_;
      through = {x * widened, field_, z * widened};
      from = Vec3{spot.x, 0, spot.y} * (voxel_ * to_detector / field_) - Vec3{0, source_, 0};
    } else {
      through = {x, field_, z};
      from = through - Vec3{spot.x * voxel_ / field_, 1, spot.y * voxel_ / field_};
    }
    const Vec3 d = normalized(through - from);
    return {back_ * (through - d * (4 * field_)), back_ * d};
  }

 private:
  double voxel_, source_, field_, middle_u_, middle_v_, offset_;
  Mat3 back_;
};

struct Spot {
  Vec2 at;
  double weight;
};
// Three nodes of Gauss and Hermite along each direction: they have the moments of a normal spot up to the fifth.
std::vector<Spot> spots_of(double sd) {
  if (sd <= 0) return {{{0, 0}, 1}};
  std::vector<Spot> spots;
  for (const auto& [x, wx] : {std::pair{-std::sqrt(3.0), 1 / 6.0}, {0.0, 2 / 3.0}, {std::sqrt(3.0), 1 / 6.0}})
    for (const auto& [y, wy] : {std::pair{-std::sqrt(3.0), 1 / 6.0}, {0.0, 2 / 3.0}, {std::sqrt(3.0), 1 / 6.0}})
      spots.push_back({{x * sd, y * sd}, wx * wy});
  return spots;
}

using Image = std::vector<double>;  // column after column

// Along lines of `n` numbers, `stride` apart, the ends continued.
void convolve(Image& image, std::size_t lines, std::size_t line_stride, std::size_t n, std::size_t stride,
              const std::vector<double>& half) {
  const auto last = static_cast<long>(n) - 1, reach = static_cast<long>(half.size()) - 1;
  std::vector<double> line(n);
  for (std::size_t l = 0; l < lines; ++l) {
    double* at = image.data() + l * line_stride;
    for (std::size_t k = 0; k < n; ++k) line[k] = at[k * stride];
    for (long k = 0; k <= last; ++k) {
      double sum = half[0] * line[static_cast<std::size_t>(k)];
      for (long m = 1; m <= reach; ++m)
        sum += half[static_cast<std::size_t>(m)] * (line[static_cast<std::size_t>(std::max(k - m, 0L))] +
                                                    line[static_cast<std::size_t>(std::min(k + m, last))]);
      at[static_cast<std::size_t>(k) * stride] = sum;
    }
  }
}

void blur(Image& image, std::size_t columns, std::size_t rows, double sd) {
  if (sd <= 0) return;
  std::vector<double> half;
  double sum = 0;
  for (int m = 0; m <= static_cast<int>(std::ceil(4 * sd)); ++m) {
    half.push_back(std::exp(-0.5 * m * m / (sd * sd)));
    sum += (m > 0 ? 2 : 1) * half.back();
  }
  for (double& w : half) w /= sum;
  convolve(image, columns, rows, rows, 1, half);
  convolve(image, rows, 1, columns, rows, half);
}

// Wide: on a grid four times as coarse, which an eighth of the field does not notice.
Image spread(const Image& image, std::size_t columns, std::size_t rows, double sd) {
  const std::size_t coarse = sd > 16 ? 4 : 1, c = (columns + coarse - 1) / coarse, r = (rows + coarse - 1) / coarse;
  Image small(c * r, 0.0), count(c * r, 0.0), wide(image.size());
  for (std::size_t u = 0; u < columns; ++u)
    for (std::size_t v = 0; v < rows; ++v) {
      small[u / coarse * r + v / coarse] += image[u * rows + v];
      ++count[u / coarse * r + v / coarse];
    }
  for (std::size_t k = 0; k < small.size(); ++k) small[k] /= count[k];
  blur(small, c, r, sd / static_cast<double>(coarse));
  const auto along = [&](std::size_t at, std::size_t n, std::size_t& first) {
    const double x = std::clamp((static_cast<double>(at) + 0.5) / static_cast<double>(coarse) - 0.5, 0.0,
                                static_cast<double>(n) - 1);
    first = std::min(static_cast<std::size_t>(x), n > 1 ? n - 2 : 0);
    return x - static_cast<double>(first);
  };
  for (std::size_t u = 0; u < columns; ++u) {
    std::size_t a = 0, b = 0;
    const double fu = along(u, c, a);
    for (std::size_t v = 0; v < rows; ++v) {
      const double fv = along(v, r, b);
      const std::size_t a1 = std::min(a + 1, c - 1), b1 = std::min(b + 1, r - 1);
      wide[u * rows + v] = (1 - fu) * ((1 - fv) * small[a * r + b] + fv * small[a * r + b1]) +
                           fu * ((1 - fv) * small[a1 * r + b] + fv * small[a1 * r + b1]);
    }
  }
  return wide;
}

// Multiplication of uniform numbers (Knuth) for few photons, a rounded normal for more than 60.
double poisson(double mean, Random& random) {
  if (mean > 60) return std::max(0.0, std::round(mean + std::sqrt(mean) * random.normal()));
  const double limit = std::exp(-mean);
  double count = 0;
  for (double product = random.uniform(); product > limit; product *= random.uniform()) ++count;
  return count;
}

// Primary intensity of every pixel. Samples lie in a regular grid within the pixel that moves from view to view by the
// golden ratio, so that no surface is met by all views at the same place of a pixel.
Image primary(const Phantom& phantom, const Scanner& s, const Transmission& transmission, std::size_t view,
              std::size_t columns, std::size_t rows) {
  const View rays(s, view, columns, rows);
  const std::vector<Spot> spots = spots_of(s.amplitude("focal-spot"));
  const auto turn = [&](double ratio) { return std::fmod((static_cast<double>(view) + 0.5) * ratio, 1.0); };
  const double shift_u = turn(0.61803398874989485), shift_v = turn(0.75487766624669276);
  Image image(columns * rows);
  std::vector<double> lengths(phantom.parts.size());
  for (std::size_t u = 0; u < columns; ++u)
    for (std::size_t v = 0; v < rows; ++v) {
      double sum = 0;
      for (int a = 0; a < s.samples[0]; ++a)
        for (int b = 0; b < s.samples[1]; ++b)
          for (const Spot& spot : spots) {
            phantom.lengths(rays.ray(static_cast<double>(u) - 0.5 + (a + shift_u) / s.samples[0],
                                     static_cast<double>(v) - 0.5 + (b + shift_v) / s.samples[1], spot.at),
                            lengths);
            sum += spot.weight * transmission.of(lengths);
          }
      image[u * rows + v] = sum / (s.samples[0] * s.samples[1]);
    }
  return image;
}

class Detector {
 public:
  Detector(const Scanner& s, std::size_t columns, std::size_t rows)
      : scanner_(s), columns_(columns), rows_(rows), hardening_(s.amplitude("beam-hardening", 1)) {
    const double sd = s.amplitude("ring");
    Random random(s.seed, 0x9a175);
    for (std::size_t k = 0; k < columns * rows; ++k) gain_.push_back(sd > 0 ? 1 + sd * random.normal() : 1);
  }
  // Readings of a view whose primary intensity is `image`.
  void read(Image image, std::size_t view, const Transmission& transmission, float* into) const {
    const double scatter = scanner_.amplitude("scatter"), least = scanner_.amplitude("streak");
    if (scatter > 0) {
      Image lost(image.size());
      for (std::size_t k = 0; k < image.size(); ++k) lost[k] = -image[k] * std::log(std::max(image[k], 1e-12));
      const Image wide = spread(lost, columns_, rows_, static_cast<double>(scanner_.voxels) / 8);
      for (std::size_t k = 0; k < image.size(); ++k) image[k] += scatter * wide[k];
    }
    blur(image, columns_, rows_, scanner_.amplitude("blur"));
    const double along = static_cast<double>(view) / static_cast<double>(scanner_.view_count());
    const double lamp = 1 + scanner_.amplitude("drift") * along;
    Random random(scanner_.seed, view + 1);
    for (std::size_t k = 0; k < image.size(); ++k) {
      double t = least > 0 ? std::hypot(image[k], least) / std::hypot(1, least) : image[k];
      t *= gain_[k] * lamp;
      // No photon at all reads as half a one.
      if (scanner_.photons > 0) t = std::max(poisson(scanner_.photons * t, random), 0.5) / scanner_.photons;
      const double reading = -std::log(std::max(t, 1e-12));
      into[k] = static_cast<float>(
          hardening_ == 1 ? reading : transmission.linearised(reading) * (1 - hardening_) + reading * hardening_);
    }
  }

 private:
  const Scanner& scanner_;
  std::size_t columns_, rows_;
  double hardening_;
  Image gain_;
};

}  // namespace

std::size_t Scanner::view_count() const {
  if (views > 0) return views;
  return static_cast<std::size_t>(std::ceil((source_m > 0 ? pi : pi / 2) * static_cast<double>(voxels)));
}

double Scanner::amplitude(const std::string& name, double absent) const {
  const auto found = imperfections.find(name);
  return found == imperfections.end() ? absent : found->second;
}

Projections projections(const Phantom& phantom, const Scanner& s) {
  for (const auto& [name, amplitude] : s.imperfections)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw std::invalid_argument("no imperfection " + name);
  if (phantom.parts.empty()) throw std::invalid_argument("an empty phantom");
  Projections p{s.view_count(), s.voxels, s.slice_count(), {}};
  p.values.resize(p.views * p.columns * p.rows);
  const double field = static_cast<double>(s.voxels) * s.voxel_m;
  const Transmission transmission(phantom, s.spectrum, 1.5 * field);
  const Detector detector(s, p.columns, p.rows);
  parallel_for(0, p.views, [&](std::size_t view) {
    detector.read(primary(phantom, s, transmission, view, p.columns, p.rows), view, transmission,
                  p.values.data() + view * p.columns * p.rows);
  });
  return p;
}

}  // namespace gonio::ct
