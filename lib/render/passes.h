// What rendering leaves behind before it becomes a picture: exact sums over passes.
//
// A pass is one replicate of the picture: `samples_per_pass` samples (a power of two) of every pixel, low-discrepancy
// among themselves and independent of all other passes (sampler.h). Its pixel means, rounded to float, are summed
// exactly (exact_sum.h); so it does not matter in which order, on how many machines and after how many interruptions
// the passes come together. Pass number k of a picture depends on nothing but the scene, the seed and k.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/progress.h"
#include "geom/vector.h"
#include "render/exact_sum.h"
#include "render/integrator.h"

namespace gonio::render {

inline constexpr std::uint32_t most_passes = 1u << 24;

struct SamplePlan {
  int samples_per_pass = 1;  // a power of two
  int passes = 2;            // at least 2
  int spp() const { return samples_per_pass * passes; }
};
// At least `spp` samples: 16 passes or more where spp allows, of up to 64 samples.
SamplePlan sample_plan(int spp);

// Which samples of which picture: what must agree among shares that are joined.
struct PictureIdentity {
  std::string image, scene;  // id of the image; hash of everything that the picture depends on
  std::uint64_t seed = 1;    // as the user gave it
  int width_px = 0, height_px = 0, samples_per_pass = 1;
  std::vector<std::string> planes;  // as the integrator names them
  std::vector<std::string> lights;  // that are on
  bool operator==(const PictureIdentity&) const = default;
};

// Is the variance of this plane kept? Of the radiance and of Stokes vectors.
bool keeps_variance(const std::string& plane);

class PassSums {
 public:
  explicit PassSums(PictureIdentity identity, std::uint32_t first_pass = 0);

  const PictureIdentity& identity() const { return identity_; }
  std::size_t pixels() const;
  std::uint32_t first_pass() const { return first_pass_; }
  std::uint32_t passes() const { return passes_; }
  std::uint32_t end_pass() const { return first_pass_ + passes_; }
  std::int64_t samples() const { return std::int64_t{passes_} * identity_.samples_per_pass; }

  // The means of one pass in one pixel; from many threads, but one per pixel. count_passes() once all pixels have them.
  void add(std::size_t pixel, std::span<const Rgb> means, const Noticed& noticed);
  void count_passes(std::uint32_t more) { passes_ += more; }
  // Passes of another share of the same picture that continue this one.
  void append(const PassSums& next);

  Rgb mean(std::size_t pixel, std::size_t plane) const;
  Rgb variance(std::size_t pixel, std::size_t plane) const;  // of the mean; of planes that keep it
  double met(std::size_t pixel) const;                       // share of samples that met a surface
  double seen(std::size_t pixel, std::size_t light) const;   // share of those that see the light

  // For files: the bytes of the sums, in a fixed layout.
  std::vector<std::span<std::byte>> parts();
  std::vector<std::span<const std::byte>> parts() const;

 private:
  PictureIdentity identity_;
  std::uint32_t first_pass_, passes_ = 0;
  std::vector<std::size_t> with_variance_;  // place among the squares of each plane; or none
  std::size_t variances_ = 0;
  std::vector<ExactSum> sums_;             // (pixel * planes + plane) * 3 + channel
  std::vector<ExactSquares> squares_;      // (pixel * variances + place) * 3 + channel
  std::vector<std::uint32_t> met_, seen_;  // pixel; pixel * lights + light
};

// Renders `count` further passes into `sums`; `progress` advances by one per pixel and pass. The random numbers of the
// image follow from its seed and id.
void add_passes(const Integrator& integrator, PassSums& sums, std::uint32_t count, Progress* progress);

}  // namespace gonio::render
