// Field tables of the section about colour corrections.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/colour_correction.h"

namespace gonio::manifest {

const std::vector<Field<ColourPatch>>& colour_patch_fields() {
  static const std::vector<Field<ColourPatch>> table{
      field("name", &ColourPatch::name, "", "as the chart calls it").needed(),
      field("read", &ColourPatch::read, "", "R, G, B over `white`, before anything was taken off"),
      field("sigma", &ColourPatch::sigma, "", "one standard deviation of them").range(0, infinite),
      field("reference", &ColourPatch::reference, "", "L*, a*, b* under D50 that it should have").needed(),
      field("fitted_de00", &ColourPatch::fitted_de00, "", "colour difference (CIEDE2000) of the fit")
          .range(0, infinite),
      field("held_out_de00", &ColourPatch::held_out_de00, "", "the same of a fit that has not seen this patch")
          .range(0, infinite),
      field("left_out", &ColourPatch::left_out, "", "why it does not count")
          .one_of({"clipped", "masked", "not-finite"})};
  return table;
}

const std::vector<Field<ColourAlternative>>& colour_alternative_fields() {
  static const std::vector<Field<ColourAlternative>> table{
      field("model", &ColourAlternative::model, "", "that was tried").needed(),
      field("fitted_de00", &ColourAlternative::fitted_de00, "", "mean over patches").range(0, infinite),
      field("held_out_de00", &ColourAlternative::held_out_de00, "", "mean over patches").range(0, infinite),
      field("refused", &ColourAlternative::refused, "", "why it was not fitted")};
  return table;
}

const std::vector<Field<ColourCorrection>>& colour_correction_fields() {
  static const std::vector<Field<ColourCorrection>> table{
      field("model", &ColourCorrection::model, "", "which terms of R, G, B the matrix takes")
          .one_of({"linear", "white-preserving", "homography", "root-polynomial-2", "root-polynomial-3",
                   "root-polynomial-4", "polynomial-2", "polynomial-3", "polynomial-4"})
          .needed(),
      field("matrix", &ColourCorrection::matrix, "", "three rows, one column a term, in the order of color-calib(1)")
          .needed(),
      field("white", &ColourCorrection::white, "", "R, G, B of a perfect white; the terms take pixels over these")
          .positive()
          .needed(),
      field("to", &ColourCorrection::to, "", "what comes out; white is 1, 1, 1 (xyz-d50: the white of D50)")
          .one_of({"cie-rgb", "srgb", "xyz-d50"})
          .needed(),
      field("covariance", &ColourCorrection::covariance, "", "of the matrix, row by row; jackknife over the patches"),
      field("fitted_de00", &ColourCorrection::fitted_de00, "", "colour difference (CIEDE2000), mean over the patches")
          .range(0, infinite),
      field("fitted_sd_de00", &ColourCorrection::fitted_sd_de00, "", "its standard deviation over the patches")
          .range(0, infinite),
      field("fitted_most_de00", &ColourCorrection::fitted_most_de00, "", "of the worst patch").range(0, infinite),
      field("held_out_de00", &ColourCorrection::held_out_de00, "", "mean where each patch was left out of its fit")
          .range(0, infinite),
      field("held_out_sd_de00", &ColourCorrection::held_out_sd_de00, "", "its standard deviation over the patches")
          .range(0, infinite),
      field("held_out_most_de00", &ColourCorrection::held_out_most_de00, "", "of the worst patch").range(0, infinite),
      field("exposure_de00", &ColourCorrection::exposure_de00, "",
            "largest mean change of colour where pixels are 0.1 to 10 times as bright, scaled back after")
          .range(0, infinite),
      field("noise_gain", &ColourCorrection::noise_gain, "",
            "root mean square noise that comes out over equal noise that goes in, both over white")
          .range(0, infinite),
      field("metamerism_de00", &ColourCorrection::metamerism_de00, "",
            "root mean square over smooth reflectances that no correction can mend, of a sensor that is known")
          .range(0, infinite),
      field("offset", &ColourCorrection::offset, "",
            "R, G, B over white that was taken off the chart's patches: glare, or black that was left"),
      field("gradient", &ColourCorrection::gradient, "",
            "of the light that was divided out: relative change along the chart's width and its height"),
      field("curve", &ColourCorrection::curve, "", "the same to second order: width^2, width height, height^2"),
      sigma_field(&ColourCorrection::sigma),
      field("chart", &ColourCorrection::chart, "", "that was photographed"),
      field("edition", &ColourCorrection::edition, "", "of its reference values"),
      field("light", &ColourCorrection::light, "", "under which the reference values hold"),
      field("image", &ColourCorrection::image, "", "id of the image that shows the chart"),
      field("camera", &ColourCorrection::camera, "", "name of the camera whose pixels it corrects"),
      field("corners_px", &ColourCorrection::corners_px, "px",
            "outer corners of the chart's corner patches: x, y of the first, then clockwise as the chart is read"),
      field("patches", &ColourCorrection::patches, "", "as they were read"),
      field("alternatives", &ColourCorrection::alternatives, "", "models that were tried")};
  return table;
}

GONIO_RECORD(ColourPatch, colour_patch_fields);
GONIO_RECORD(ColourAlternative, colour_alternative_fields);
GONIO_RECORD(ColourCorrection, colour_correction_fields);

}  // namespace gonio::manifest
