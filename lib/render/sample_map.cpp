#include "render/sample_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "render/integrator.h"

namespace gonio::render {
namespace {

constexpr std::uint64_t pilot_seed = 0x70696c6f74;
constexpr int replicates = 4, most_pilot_samples = 4;  // of a replicate
constexpr double floor_share = 0.1;                    // of the picture's mean
constexpr double least = 0.25, most = 8;               // of a pass' samples
constexpr double defence = 0.2;                        // share of the mean variance that every pixel is held to have
constexpr double several = 2;                          // paths onward

struct Moments {  // of a sample in a pixel; variances as far as a replicate's own order leaves them
  double mean = 0, variance = 0, near_variance = 0;
  double near_work = 0, far_work = 0;
  void add(const Moments& o, double weight) {
    mean += weight * o.mean;
    variance += weight * o.variance;
    near_variance += weight * o.near_variance;
    near_work += weight * o.near_work;
    far_work += weight * o.far_work;
  }
  double variance_of(double onward) const {
    const double near = std::min(near_variance, variance);
    return near + (variance - near) / onward;
  }
  double work_of(double onward) const { return near_work + onward * far_work; }
};

double spread(const std::array<double, replicates>& values) {
  double mean = 0, sum = 0;
  for (const double v : values) mean += v / replicates;
  for (const double v : values) sum += (v - mean) * (v - mean) / (replicates - 1);
  return sum;
}

class Pilot {
 public:
  Pilot(const Integrator& integrator, int samples)
      : integrator_(integrator),
        samples_(samples),
        planes_(integrator.planes().size()),
        noticed_{std::vector<std::uint32_t>(integrator.lights())} {}

  Moments moments(int x, int y, std::uint64_t pixel) {
    Moments m;
    std::array<double, replicates> totals{}, nears{};
    for (std::uint64_t replicate = 0; replicate < replicates; ++replicate)
      for (int i = 0; i < samples_; ++i) {
        Sampler sampler(pilot_seed, (pixel << 24) + replicate, static_cast<std::uint32_t>(i));
        std::fill(planes_.begin(), planes_.end(), Rgb{});
        noticed_.near = 0;
        noticed_.events = 0;
        integrator_.trace(Vec2{x - 0.5, y - 0.5} + sampler.two(), sampler, planes_, noticed_);
        const double total = mean(planes_[0]);
        const auto events = static_cast<double>(noticed_.events);
        const double share = 1.0 / (replicates * samples_);
        totals[replicate] += total / samples_;
        nears[replicate] += noticed_.near / samples_;
        m.add({total, 0, 0, events > 0 ? 2.0 : 1.0, events > 0 ? 2 * events - 1 : 0}, share);
      }
    m.variance = spread(totals) * samples_;
    m.near_variance = spread(nears) * samples_;
    return m;
  }

 private:
  const Integrator& integrator_;
  int samples_;
  std::vector<Rgb> planes_;
  Noticed noticed_;
};

class Grid {
 public:
  Grid(int width_px, int height_px) : width_px_(width_px), height_px_(height_px), all_(cells()) {}
  std::size_t cells() const { return static_cast<std::size_t>(width_px_) * static_cast<std::size_t>(height_px_); }
  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(std::clamp(y, 0, height_px_ - 1)) * static_cast<std::size_t>(width_px_) +
           static_cast<std::size_t>(std::clamp(x, 0, width_px_ - 1));
  }
  void survey(const Integrator& integrator, int samples) {
    parallel_for(0, static_cast<std::size_t>(height_px_), [&](std::size_t row) {
      Pilot pilot(integrator, samples);
      const auto y = static_cast<int>(row);
      for (int x = 0; x < width_px_; ++x) all_[place(x, y)] = pilot.moments(x, y, place(x, y));
    });
  }
  // Variances over y_i^2 + f^2; averaged over neighbours.
  std::vector<Moments> relative() const {
    double floor = 0;
    for (const Moments& m : all_)
      if (std::isfinite(m.mean)) floor += floor_share * m.mean / static_cast<double>(cells());
    std::vector<Moments> pooled(cells());
    for (int y = 0; y < height_px_; ++y)
      for (int x = 0; x < width_px_; ++x)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            Moments m = all_[place(x + dx, y + dy)];
            const double scale = 1 / (m.mean * m.mean + floor * floor);
            if (!std::isfinite(m.variance * scale)) continue;
            m.variance *= scale, m.near_variance *= scale;
            pooled[place(x, y)].add(m, 1.0 / 9);
          }
    return pooled;
  }

 private:
  int width_px_, height_px_;
  std::vector<Moments> all_;
};

double best_onward(const Moments& m) {
  const auto cost = [&](double onward) { return m.variance_of(onward) * m.work_of(onward); };
  return cost(several) < 0.95 * cost(1) ? several : 1;  // what hardly pays is left alone
}

struct Wish {  // of a pixel
  double wanted = 0, work = 0;
  double dither = 0;  // about a half: pixels of equal wishes do not all change at once
  double allotted(double scale) const {
    return std::clamp(std::exp2(std::floor(std::log2(std::max(wanted * scale, 1e-30)) + dither)), least, most);
  }
};

// The scale at which the whole is the work of a plain pass.
double balance(const std::vector<Wish>& wishes, double budget) {
  double low = -60, high = 60;
  for (int step = 0; step < 30; ++step) {
    const double middle = (low + high) / 2, scale = std::exp2(middle);
    double sum = 0;
    for (const Wish& wish : wishes) sum += wish.allotted(scale) * wish.work;
    (sum < budget ? low : high) = middle;
  }
  return std::exp2(low);
}

}  // namespace

SampleMap::SampleMap(const Integrator& integrator, int width_px, int height_px, int preset)
    : width_px_(width_px), height_px_(height_px) {
  Grid grid(width_px, height_px);
  grid.survey(integrator, std::clamp(preset / 2, 1, most_pilot_samples));
  const std::vector<Moments> moments = grid.relative();
  pixels_.assign(moments.size(), {static_cast<std::uint16_t>(preset), 1});
  std::vector<Wish> wishes(moments.size());
  double budget = 0, largest = 0, everywhere = 0;
  for (const Moments& m : moments) everywhere += defence * m.variance / static_cast<double>(moments.size());
  for (std::size_t i = 0; i < wishes.size(); ++i) {
    const double onward = best_onward(moments[i]), work = moments[i].work_of(onward);
    pixels_[i].onward = static_cast<float>(onward);
    wishes[i] = {work > 0 ? std::sqrt((moments[i].variance_of(onward) + everywhere) / work) : 0, work,
                 0.35 + 0.3 * static_cast<double>(split_mix(i) >> 11) * 0x1p-53};
    budget += moments[i].work_of(1);
    largest = std::max(largest, wishes[i].wanted);
  }
  if (!(largest > 0)) return;
  for (Wish& wish : wishes) wish.wanted /= largest;  // the search for the balance has a bounded range
  const double scale = balance(wishes, budget);
  for (std::size_t i = 0; i < pixels_.size(); ++i)
    pixels_[i].samples = static_cast<std::uint16_t>(std::max(1.0, wishes[i].allotted(scale) * preset));
}

}  // namespace gonio::render
