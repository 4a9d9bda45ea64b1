// The last step of an alignment: refined by the pictures themselves, and whether that is taken.
//
// The pictures' answer is one optimum of rims and pictures (picture_fit.h). It may not move rims by more than these
// state: d' C^-1 d, d the change from the rims' answer and C its covariance, has to stay below the 99 % point of
// chi-square of as many numbers. Beyond that the two contradict each other, and the rims, which ask no surface, keep
// their answer; so they do where the model misses too much of what the photographs show. Directions that rims leave
// open cost nothing there, and are the pictures' to say; so is the turn of a body that looks alike by any angle about
// an axis: all turns are looked at, and what facets hold of them counts for nothing.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "alignment/align.h"
#include "alignment/picture_fit.h"

namespace gonio::alignment {

struct PictureAnswer {
  Fitted fitted;  // of rims and pictures, measured at its rims
  bool taken = false;
  std::string why;  // where it was not
  std::size_t photographs = 0, pixels = 0;
  double independent = 0;      // values that pixels amount to
  double correlation_px = 0;   // PictureNoise's
  double relative_error = 0;   // rms of what is left over rms of what is seen, after
  double relative_before = 0;  // the same at the rims' answer
  double chi2 = 0, chi2_limit = 0;
  std::size_t numbers = 0;
  double move_px = 0, sigma_px = 0;  // rms over the rims' points: how far they move, and what rims state of them
  struct Photograph {
    std::string image;
    double before = 0, after = 0;
  };
  std::vector<Photograph> each{};
};

struct PictureWish {
  double pixels = 4000;              // of all photographs together
  double most_relative_error = 0.3;  // what is left beyond that says that the surfaces are others
};

// Refines what stands; where it is taken, all of `all` that stand have its fit, rivals that pictures contradict are
// gone, and the verdict is that of rims and pictures. Nothing happens where nothing stands. `document`: as it was read.
// Error(data) as check_pictures() says (picture_model.h).
void refine_by_pictures(const manifest::Document& document, const AlignmentInput& in, const AlignWish& wish,
                        const PictureWish& pictures, std::vector<Aligned>& all);

// "by the pictures: ..." in words, with the numbers.
std::string words_of(const PictureAnswer& answer);

}  // namespace gonio::alignment
