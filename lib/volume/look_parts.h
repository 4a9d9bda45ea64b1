// Pieces that look() and the corrections are made of: which voxels surely are air or object, slabs to take figures
// from, robust scales, and the volume on a coarse grid with the depth of every cell below the object's surface.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "volume/look.h"
#include "volume/slabs.h"

namespace gonio::volume {

struct Sides {
  double air = 0, object = 0;
  double step() const { return object - air; }
  double half() const { return (air + object) / 2; }
  // Of means over 3 x 3 x 3 voxels, in which noise hardly shows.
  bool surely_air(float mean) const { return mean < air + 0.25 * step(); }
  bool surely_object(float mean) const { return mean > object - 0.25 * step() && mean < object + 0.35 * step(); }
};
// By position in the mixture, as Look says; Error(data) where there is one material only.
struct AirAndObject {
  std::size_t air = 0, object = 0;
};
AirAndObject air_and_object(const Mixture& mixture);
Sides sides_of(const Mixture& mixture);

// Slabs of `count` slices with margins, all of the volume where it has no more than `most` voxels, else spread evenly.
struct ProbeWish {
  std::size_t count = 32, margin = 6, most = 64'000'000;
  float outside = 0;
};
void for_each_probe(io::VolumeSource& source, const ProbeWish& wish, const std::function<void(const Slab&)>& body);

// Arrays as large as the slab with its margins.
std::vector<float> box_means(const Slab& slab);  // over 3 x 3 x 3; borders repeat
using Flags = std::vector<std::uint8_t>;         // 0 or 1
// What is left after a cube of 2 r + 1 voxels has been rolled along inside; nothing within r of the array's ends.
Flags eroded(const Slab& slab, Flags flags, std::size_t r);

// Distances of a slice's pixels from its middle, so that no voxel asks for a root.
std::vector<double> radii_of_slice(const Slab& slab);

// sd of a normal law with foreign values among it: values beyond 3 sd are left out until nothing changes.
double robust_sd(std::span<const double> values);

// Keeps every n-th of what it is offered, n doubling whenever there are `most`.
template <class T>
class Thinned {
 public:
  explicit Thinned(std::size_t most) : most_(most) {}
  bool wants() { return seen_++ % every_ == 0; }  // asked once for each; then add()
  void add(T value) {
    kept_.push_back(std::move(value));
    if (kept_.size() < most_) return;
    std::size_t half = 0;
    for (std::size_t k = 0; k < kept_.size(); k += 2) kept_[half++] = std::move(kept_[k]);
    kept_.resize(half);
    every_ *= 2;
  }
  std::vector<T>& all() { return kept_; }

 private:
  std::size_t most_, every_ = 1, seen_ = 0;
  std::vector<T> kept_;
};

// Cells of f x f x f voxels, no more than about four million.
struct CoarseField {
  std::size_t f = 1;
  std::array<std::size_t, 3> cells{};
  std::vector<float> mean;                    // of the voxels
  std::vector<float> depth;                   // voxels below the surface of what surely is object; 0: not in it
  Vec3 centre_index(std::size_t cell) const;  // index coordinates
};
CoarseField coarse_field(io::VolumeSource& source, const Sides& sides);

// Faces of the volume and the circle beyond which the scanner stored a constant.
std::size_t voxels_at_the_border(io::VolumeSource& source, const Sides& sides);

// A patch of surface: a step smeared by a normal spread function across a plane, fitted to all voxels round a point.
struct PatchPoint {
  Vec3 at;                                   // index coordinates
  std::vector<std::array<float, 4>> voxels;  // offsets from `at`, value
  Vec3 normal;                               // to smaller values, by the gradient
};
struct PatchFit {
  bool good = false;
  double position = 0, width = 0;  // along the normal from `at`, 10 % to 90 %, voxels
  double air = 0, step = 0;
};
// Of voxels at a surface in the slab; needs a margin of 6.
void take_patches(const Slab& slab, const Sides& sides, Thinned<PatchPoint>& into);
// The voxels of a patch that was taken elsewhere, from a slab that holds its middle.
void refill(const Slab& slab, PatchPoint& patch);
PatchFit fitted(const PatchPoint& patch, const Sides& sides, double noise);
std::vector<PatchFit> all_fitted(const std::vector<PatchPoint>& patches, const Sides& sides, double noise);

// Figures of look.h, slab by slab.
class NoiseProbe {
 public:
  NoiseProbe();
  void take(const Slab& slab, const Flags& air, const Flags& object);
  void finish(Look& look);

 private:
  struct Residual {
    float here, along_i, along_j, along_k;
  };
  using Tiers = std::vector<Thinned<Residual>>;
  void take_side(const Slab& slab, const Flags& side, Tiers& tiers);
  Tiers air_, object_;
};

class RingProbe {
 public:
  void take(const Slab& slab, const Flags& air, const Flags& object);
  double variance() const;  // of what a radius has in common, by products of even and odd sectors

 private:
  double products_ = 0, weights_ = 0;
};

class StreakProbe {
 public:
  void take(const Slab& slab, const std::vector<float>& means, const Flags& deep_air, const Sides& sides);
  double sd() const;

 private:
  double within_ = 0, without_ = 0, count_within_ = 0, count_without_ = 0;
};

}  // namespace gonio::volume
