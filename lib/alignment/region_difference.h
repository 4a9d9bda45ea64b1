// Where the model's regions in a photograph are not those of the masks, pixel by pixel. Private to alignment/.
#pragma once
#include <string>
#include <vector>

#include "alignment/alignment_input.h"
#include "alignment/mask_regions.h"
#include "io/image.h"

namespace gonio::alignment {

// Of one mask, in pixels; a pixel belongs to whom more than half of it does. What another object hides, and what nobody
// can tell, is not compared.
struct MaskMatch {
  std::string what;  // "wedge", "shadow of wedge"
  std::size_t both = 0, missed = 0, beyond = 0, compared = 0;
  double wrong() const {
    return compared > 0 ? static_cast<double>(missed + beyond) / static_cast<double>(compared) : 0;
  }
  double overlap() const {  // intersection over union
    const std::size_t any = both + missed + beyond;
    return any > 0 ? static_cast<double>(both) / static_cast<double>(any) : 0;
  }
};
// sRGB codes: grey where both agree, blue where the mask has what the model lacks, red where the model has more.
struct RegionDifference {
  io::Image picture;
  std::vector<MaskMatch> masks;
};

// Of one photograph, whose rims are those numbered `rims` and whose masks are `regions`: for each setting; all pictures
// show the same part of it.
std::vector<RegionDifference> region_differences(const AlignmentInput& in, const std::vector<std::size_t>& rims,
                                                 const MaskRegions& regions, const std::vector<Setting>& settings);
// "wedge: 0.12 % of the pixels wrong, IoU 0.998; ...".
std::string words_of(const RegionDifference& difference);

}  // namespace gonio::alignment
