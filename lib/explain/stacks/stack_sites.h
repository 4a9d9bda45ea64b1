// Which readings of a stack are looked at: sites, one pixel in one channel each, spread over the whole range of
// brightness and over the picture, where their neighbourhood is flat, so that scans which are not quite registered
// still show the same spot. And the noise of a reading there.
#pragma once
#include <cstdint>
#include <vector>

#include "explain/stacks/stack_input.h"

namespace gonio::explain::stacks {

struct Site {
  int x = 0, y = 0, channel = 0;
  double level = 0;               // mean reading over the stack: rises with the radiance whatever the response
  double roughness = 0;           // spread of the neighbours over the mean reading
  std::vector<std::size_t> seen;  // images in which it counts, ascending
  std::uint32_t tile = 0;         // compact part of the picture that it lies in
};

struct SiteOptions {
  std::size_t sites = 150;  // over all channels together
  std::size_t tiles = 16;   // parts of the picture within which noise may be correlated
  std::size_t fewest = 3;   // images in which a site must count
  bool flat = true;         // prefer flat neighbourhoods
};

// One standard deviation of single readings as a function of the reading, image by image: what is stated, or measured
// from second differences between neighbours of the same filter, whose median does not see edges (Rousseeuw & Croux
// 1993), in bins of equal counts. Never below the noise of rounding, quantum / sqrt(12).
class ReadingNoise {
 public:
  explicit ReadingNoise(const Stack& stack);
  double sigma(std::size_t image, double reading) const;
  bool stated() const { return stated_; }

 private:
  const Stack& stack_;
  bool stated_ = true;
  std::vector<double> level_, sigma_;  // of the measured curve, over all images together
};

// Of integer files, a reading counts where the mean of its eight neighbours of the same filter stays three standard
// deviations away from the lowest and the highest code: choosing by the reading itself would leave, of a brightness
// near a limit, the readings that noise drew away from it. Tiles are cuts of the Z-order curve (Morton 1966) with equal
// numbers of sites. Deterministic. Error(data) where hardly any site counts in enough images.
std::vector<Site> choose_sites(const Stack& stack, const ReadingNoise& noise, const SiteOptions& options,
                               const std::string& place);

}  // namespace gonio::explain::stacks
