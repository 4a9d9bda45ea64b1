// Grey values by which the print comes out as it was asked for, although light spreads and goes through layers: the
// inverse of print/cure.h.
//
// The light of a voxel, G, is linear in the grey values I: spread within its layer, and carried down from later ones,
//   G_k = K I_k + c_(k+1) G_(k+1).
// A voxel that is to be solid by a share between 0 and 1 needs the light G* of that height; one that is to stay empty
// needs no more than where growth begins; one that is to be full needs white's light or more. So
//   sum over voxels of w (G - G*)^2, of empty ones only above, of full ones only below G*,    0 <= I <= 1,
// is least: convex, by projected gradients with Nesterov's momentum (Beck & Teboulle 2009), which a change of sign
// restarts (O'Donoghue & Candes 2015). w: how much height a change of light makes, over what it makes at white.
//
// Light of a layer reaches earlier ones, as far as exp(-depth / d) counts (1/100). Layers are therefore solved in
// blocks, together with those that follow, before what came earlier is already sent: memory holds one block, whatever
// the height of the print. What cannot be reached (white is too dark, gaps narrower than the spread) stays as a
// residual, which is stated, after rounding to whole grey values.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "print/slicer.h"

namespace gonio::print {

struct Misfit {  // of heights, over the voxels that are neither empty nor full as they ought to be, or ought to be
                 // neither
  double sum_m2 = 0;
  std::size_t voxels = 0;
  double rms_m() const;
};
struct CompensatedLayer {
  std::size_t index = 0;
  double bottom_m = 0, top_m = 0;
  PixelBox box{};
  std::vector<std::uint8_t> greys;  // of the box
  Misfit before{}, after{};         // predicted: without compensation, with it
};

class Compensation {
 public:
  using Source = std::function<bool(LayerPicture&)>;  // the next layer from the platform on; false after the last
  // Every layer's box lies within `box`, about which so much is added as light is to be kept away from.
  Compensation(const Printer& printer, const PixelBox& box, Source source, int iterations = 60);
  ~Compensation();
  bool next(CompensatedLayer& layer);

 private:
  struct Voxels;
  using Lights = std::vector<std::vector<float>>;
  bool draw();  // one more layer into the window
  void solve();
  Lights total(const Lights& own) const;      // G of the window's layers
  Lights misfit(const Lights& total) const;   // w (G - G*), where it counts
  Lights slopes(const Lights& misfit) const;  // of half the sum, by the lights
  Misfit judged(const Voxels& voxels, const std::vector<float>& total) const;
  double kept(std::size_t k) const;  // of layer k's light in the layer below it
  Printer printer_;
  PixelBox box_;
  Source source_;
  int iterations_;
  Spread spread_;
  std::size_t reach_ = 0;  // layers that a layer's light counts in, below it
  bool ended_ = false;
  std::deque<Voxels> window_;          // sent ones that light still reaches, then the block and those that follow
  std::size_t sent_ = 0, solved_ = 0;  // of the window
};

}  // namespace gonio::print
