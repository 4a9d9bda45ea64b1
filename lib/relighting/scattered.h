// What a surface sends on: of one lamp's light, split into what grows with the albedo and what does not; and of light
// that comes from everywhere.
#pragma once
#include <memory>
#include <mutex>
#include <vector>

#include "relighting/scene_state.h"
#include "surface/surface.h"

namespace gonio::relighting {

struct Scattered {
  Rgb base, gloss;
};

// The surface without and with a white base.
struct Extremes {
  surface::Values black, white;
  bool has_base = false, proportional = true;
  Rgb colour;  // the present albedo, where the base does not grow in proportion to it
  // Where nothing but the albedo has a colour, a band sees the albedo of its own alone: one evaluation with a base that
  // is black in red and white in green yields both.
  bool at_once = false;
  explicit Extremes(const SurfaceState& surface);
  // F: Values -> Rgb, affine in the albedo, else as if it were so about the present one
  template <class F>
  Scattered split(const F& f) const {
    if (at_once) {
      const Rgb both = f(white);
      const double gloss = both.x, base = both.y - both.x;
      return {{base, base, base}, {gloss, gloss, gloss}};
    }
    const Rgb gloss = f(black);
    if (!proportional) {
      const Rgb all = f(white);
      const auto of = [&](int c) { return colour[c] > 1e-9 ? (all[c] - gloss[c]) / colour[c] : 0.0; };
      return {{of(0), of(1), of(2)}, gloss};
    }
    const double base = has_base ? mean(f(white) - gloss) : 0;
    return {{base, base, base}, gloss};
  }
};

// What a surface sends on towards one direction (in the frame of its normal) of light that comes from everywhere.
Scattered scattered_towards(const SurfaceState& surface, Vec3 wo);

// The same of a metal that is alike all round its normal, which is a quadrature each time: by the cosine, linear
// between nodes that lie closer towards the horizon.
class ScatteredBy {
 public:
  static constexpr std::size_t nodes = 24;
  explicit ScatteredBy(const SurfaceState& surface);
  Scattered operator()(Vec3 wo) const;

 private:
  std::vector<Scattered> table_;
};

// The last few of them: all pictures of a scene ask for the same ones. Safe for several threads.
class ScatteredMemo {
 public:
  // Null where a table does not pay, or could not hold it.
  std::shared_ptr<const ScatteredBy> of(const SurfaceState& surface, std::size_t facets);

 private:
  struct Entry {
    std::vector<double> key;
    std::shared_ptr<const ScatteredBy> table;
  };
  std::vector<Entry> entries_;  // the last one first
  std::mutex mutex_;
};

}  // namespace gonio::relighting
