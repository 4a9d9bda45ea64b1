// Field tables of the sections about reflectance: samples before a goniometer, fits of surfaces.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/flat_patch.h"
#include "manifest/sections/surface_fit.h"

namespace gonio::manifest {

const std::vector<Field<FlatPatch>>& flat_patch_fields() {
  static const std::vector<Field<FlatPatch>> table{
      field("world_from_sample", &FlatPatch::world_from_sample, "",
            "takes sample to world coordinates; z is its normal, azimuths count from x")
          .needed(),
      field("polygon_m", &FlatPatch::polygon_m, "m", "corners [x, y] of what counts, in its frame"),
      field("radius_m", &FlatPatch::radius_m, "m", "instead of polygon_m: a disc").positive(),
      field("centre_m", &FlatPatch::centre_m, "m", "of the disc, [x, y]; left out: the origin"),
      field("images", &FlatPatch::images, "", "ids of the images that show it; left out: all"),
      field("tile", &FlatPatch::tile, "", "of a sample: name of the white tile to which its readings refer"),
      field("reflectance", &FlatPatch::reflectance, "",
            "of a tile: pi times its reflectance distribution at normal incidence, one number or one per band")
          .range(0, 1.5),
      field("surface", &FlatPatch::surface, "", "of a tile that is not Lambertian: the surface that it is"),
      field("relative_sigma", &FlatPatch::relative_sigma, "",
            "of a tile: one standard deviation of what it reflects over that, common to all readings")
          .range(0, 1),
      field("values", &FlatPatch::values, "",
            "of its images: radiance (left out), or exposure: radiance times exposure_s")
          .one_of({"radiance", "exposure"})};
  return table;
}

const std::vector<Field<AlternativeFit>>& alternative_fit_fields() {
  static const std::vector<Field<AlternativeFit>> table{
      field("model", &AlternativeFit::model, "", "what was fitted").needed(),
      field("parameters", &AlternativeFit::parameters, "", "how many numbers it has"),
      field("rms", &AlternativeFit::rms, "", "of the fit, as below").range(0, infinite),
      field("held_out_rms", &AlternativeFit::held_out_rms, "", "on directions that the fit did not see")
          .range(0, infinite),
      field("reason", &AlternativeFit::reason, "", "why it was not chosen")};
  return table;
}

const std::vector<Field<DroppedRows>>& dropped_rows_fields() {
  static const std::vector<Field<DroppedRows>> table{
      field("reason", &DroppedRows::reason, "", "why they do not count").needed(),
      field("first", &DroppedRows::first, "", "where the first of them stands"),
      field("rows", &DroppedRows::rows, "", "how many")};
  return table;
}

const std::vector<Field<SurfaceFit>>& surface_fit_fields() {
  static const std::vector<Field<SurfaceFit>> table{
      field("model", &SurfaceFit::model, "", "of surfaces/NAME").needed(),
      field("verdict", &SurfaceFit::verdict, "", "whether it may be used as it stands")
          .one_of({"good", "doubtful", "refused"}),
      field("sentence", &SurfaceFit::sentence, "", "the verdict with its reason"),
      field("parameters", &SurfaceFit::parameters, "", "by name: one number, or one for each band"),
      sigma_field(&SurfaceFit::sigma),
      field("covariance", &SurfaceFit::covariance, "",
            "of the fit, zero where a number is at its bound: {\"order\": [names], \"values\": [[...]]}; beyond 200 "
            "numbers that of what all bands share and of written_bands"),
      field("bands", &SurfaceFit::bands, "", "of the measurement"),
      field("wavelengths_m", &SurfaceFit::wavelengths_m, "m", "of the bands, where they are known").positive(),
      field("written_bands", &SurfaceFit::written_bands, "", "bands that surfaces/NAME takes for red, green, blue"),
      field("rows", &SurfaceFit::rows, "", "pairs of directions that counted"),
      field("dropped", &SurfaceFit::dropped, "", "pairs of directions that did not"),
      field("rms", &SurfaceFit::rms, "", "root mean square of the difference in log(1 + 100 f cos theta_i cos theta_o)")
          .range(0, infinite),
      field("held_out_rms", &SurfaceFit::held_out_rms, "", "the same on directions that the fit did not see")
          .range(0, infinite),
      field("rms_decades", &SurfaceFit::rms_decades, "", "root mean square of the difference in log10 f")
          .range(0, infinite),
      field("energy", &SurfaceFit::energy, "", "largest share of light that it reflects, over incidence and bands")
          .range(0, infinite),
      field("reciprocity", &SurfaceFit::reciprocity, "",
            "largest relative change of f when light and eye change places")
          .range(0, infinite),
      field("converged", &SurfaceFit::converged, "", "false: the fit ended before it stood still"),
      field("alternatives", &SurfaceFit::alternatives, "", "models that were fitted and not chosen"),
      field("refusals", &SurfaceFit::refusals, "", "what these samples cannot tell, one sentence each"),
      field("notes", &SurfaceFit::notes, "", "what a reader of the numbers has to know"),
      field("mirror", &SurfaceFit::mirror, "", "azimuth of the mirror direction in the file")
          .one_of({"phi_i + pi", "phi_i"}),
      field("mirror_ratio", &SurfaceFit::mirror_ratio, "", "brightness at phi_i + pi over that at phi_i")
          .range(0, infinite),
      field("source", &SurfaceFit::source, "", "file, table or goniometer sample that was measured"),
      field("basis", &SurfaceFit::basis, "", "what a reconstruction rests on"),
      field("files", &SurfaceFit::files, "", "written beside it: merl, csv, page, sphere, ...; file ids")};
  return table;
}

GONIO_RECORD(FlatPatch, flat_patch_fields);
GONIO_RECORD(AlternativeFit, alternative_fit_fields);
GONIO_RECORD(DroppedRows, dropped_rows_fields);
GONIO_RECORD(SurfaceFit, surface_fit_fields);

}  // namespace gonio::manifest
