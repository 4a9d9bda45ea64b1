// Pixels of a stack of exposures that gather more in the dark than others do (sensor.hot-pixel).
//
// A hot pixel reads more than all eight neighbours of its filter, by more than these differ (it lies at no edge), and
// what it reads beyond them grows with the exposure. It stands alone: a lens draws no point that leaves the pixels
// right beside it, whatever their filters, as dark as before, and where pixels have three channels it is hot in one. A
// scene has points that are darker than all eight neighbours as often as brighter ones: how many of these stand out as
// far is the control. Those count from where one in ten, at most, is the scene's ((1 + dark ones) / bright ones <= 0.1:
// Barber & Candes 2015, Controlling the false discovery rate via knockoffs, Annals of Statistics 43(5)); fewer than ten
// are not found.
#pragma once
#include <string>
#include <vector>

#include "explain/engine.h"
#include "explain/stacks/stack_sites.h"

namespace gonio::explain::stacks {

struct HotPixels {
  struct Pixel {
    int x = 0, y = 0, channel = 0;
    double rate = 0, sigma = 0;  // linear readings in a second beyond the middle of its neighbours
  };
  std::vector<Pixel> pixels;          // the hottest first
  double share = 0, share_sigma = 0;  // of those that were looked at
  double rate = 0, rate_sigma = 0;    // mean of theirs
  double p = 1;                       // chance that as many bright points stand out among as many in all
  double with = 0, without = 0;       // relative RMSE of their readings about their neighbours', and about their own in
                                      // the other pictures
  double effect = 0;                  // root mean square of what they gather over that of all readings
};
HotPixels find_hot_pixels(const Stack& stack, const ReadingNoise& noise);

void conclude_hot_pixels(const Problem& problem, const HotPixels& hot, std::size_t candidate, Explanation& e);
std::string hot_pixels_remark(const HotPixels& hot);

}  // namespace gonio::explain::stacks
