// A correction's matrix from patches whose colours are known.
//
// First weighted least squares: the difference of a patch's colour from its reference, in the metric that CIEDE2000 has
// about the reference, summed over patches. Then BFGS on the mean CIEDE2000 itself from there (Finlayson et al. 2015
// and others do either; squares alone let the worst patch rule). A patch whose readings are noisy counts for less: by
// 1 / (1 + n^2), n its noise as a CIEDE2000.
// Terms of degree 3 and 4 would follow the patches' noise, and are restrained: squares of their coefficients are added,
// at a weight for numbers of about one. Those of degree 1 and 2 are free.
//   white-preserving   the matrix takes white to white exactly: two numbers a row are fitted (Finlayson & Drew 1997,
//                      "White-point preserving color correction")
//   homography         the light on each patch is a number of its own: alternating least squares, then BFGS on the
//                      difference at equal Y (Finlayson, Gong & Fisher 2019, "Color homography: theory and
//                      applications"); one number for all, brightness, follows in the end
#pragma once
#include <span>
#include <string>
#include <vector>

#include "colour/correction.h"

namespace gonio::colour {

struct Sample {
  Rgb rgb;          // as the camera gave it
  Mat3 covariance;  // of that
  optics::Lab lab;  // reference, about D50's white
};

struct FitRequest {
  Model model = Model::linear;
  Target target = Target::cie_rgb;
  Rgb white{1, 1, 1};  // what a perfect white reads
  bool refine = true;  // BFGS after least squares
};

// CIEDE2000 about a colour as a metric: R with d = |R s| for small steps s in L*a*b*, found by differences.
Mat3 difference_root(optics::Lab at);
// Patches that a model needs: one more than it has free terms, so that one can be left out.
std::size_t patches_needed(Model model);
// Error(data) at `place` for fewer patches than the model has free terms, or patches that do not determine it.
Correction fit_correction(std::span<const Sample> samples, const FitRequest& request, const std::string& place);

}  // namespace gonio::colour
