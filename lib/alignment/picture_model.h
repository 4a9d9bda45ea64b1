// What photographs show inside the objects and of the ground, by the fast image model (relighting/image_model.h), for
// settings near the one that it was set up at.
//
//   L(s) = L(s0) + M(s) - M(s0)
// L(s0): with all that the manifest has switched on; M: direct light and shading alone, the sampled pixels' rays and
// those to the lamps cast anew where bodies, cameras, lamps and ground stand in s. Light by way of other surfaces is
// that of s0. The same sub-samples are drawn in every setting, so that differences are smooth.
//
// A row is one pixel of one photograph: a place about which, `margin_px` around, nothing but one body or the ground is
// seen, lit or unlit by each lamp as a whole: rims of objects and shadows are asked elsewhere (fit.h).
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "alignment/alignment_input.h"

namespace gonio::alignment {

struct PictureRow {
  std::size_t image = 0;  // place in images()
  std::size_t view = 0;
  std::uint32_t pixel = 0;  // among the view's sampled ones
  int x = 0, y = 0;
  std::size_t surface = 0;  // place in surfaces()
  Rgb observed;             // linear, in the recording's unit
  Rgb variance;             // the recording's noise and the simulation's
};

class PictureModel {
 public:
  static constexpr double margin_px = 2.5;

  // `document`: its objects, cameras and ground stand as in `at`; lamps are those of `at`. `pixels`: rows to aim at.
  // Error(data) where a photograph, a surface or a lamp is not one that the fast model follows.
  PictureModel(const manifest::Document& document, const AlignmentInput& in, const Setting& at, double pixels);
  ~PictureModel();
  PictureModel(const PictureModel&) = delete;

  const std::vector<PictureRow>& rows() const;
  const std::vector<std::string>& images() const;
  const std::vector<std::string>& surfaces() const;
  // Of each image: which of the unknown brightnesses it has (lamps whose intensities are free, gains); they are counted
  // from 0, and images alike in all that is free share one.
  const std::vector<std::size_t>& brightness() const;
  // Radiance, three values for each row.
  std::vector<double> predict(const Setting& setting) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Refuses what the fast model does not follow, in one line: Error(data).
void check_pictures(const manifest::Document& document, const AlignmentInput& in);

}  // namespace gonio::alignment
