// Field tables of the section about printing by light.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/print.h"

namespace gonio::manifest {

const std::vector<Field<PrintGrowth>>& print_growth_fields() {
  static const std::vector<Field<PrintGrowth>> table{
      field("alpha_m", &PrintGrowth::alpha_m, "m", "height at grey 1 + gamma").needed(),
      field("beta_m", &PrintGrowth::beta_m, "m", "height for each factor e of light: the resin's depth of penetration")
          .positive()
          .needed(),
      field("gamma", &PrintGrowth::gamma, "", "grey that does nothing; negative: light that black lets through")
          .range(-1, 1),
      sigma_field(&PrintGrowth::sigma),
      field("covariance", &PrintGrowth::covariance, "", "3 x 3, its rows: of alpha_m, beta_m, gamma"),
      field("greys", &PrintGrowth::greys, "", "where the law fails: grey values, ascending").range(0, 1),
      field("heights_m", &PrintGrowth::heights_m, "m", "and how high they grow, cubic between").range(0, infinite),
      field("lack_of_fit_p", &PrintGrowth::lack_of_fit_p, "", "chance of such a misfit where the law is right")
          .range(0, 1),
      field("rms_m", &PrintGrowth::rms_m, "m", "of the means about the law").range(0, infinite),
      field("repetitions", &PrintGrowth::repetitions, "", "of the gradient that it was fitted to").range(0, infinite)};
  return table;
}

const std::vector<Field<PrintBleed>>& print_bleed_fields() {
  static const std::vector<Field<PrintBleed>> table{
      field("sigma_m", &PrintBleed::sigma_m, "m", "standard deviation of the core").range(0, infinite).needed(),
      field("tail_share", &PrintBleed::tail_share, "", "of the light that lies in the tail").range(0, 0.9),
      field("tail_m", &PrintBleed::tail_m, "m", "width of the tail: falls with (1 + r^2 / tail_m^2)^(-3/2)").positive(),
      sigma_field(&PrintBleed::sigma)};
  return table;
}

const std::vector<Field<PrintedPart>>& printed_part_fields() {
  static const std::vector<Field<PrintedPart>> table{
      field("mesh", &PrintedPart::mesh, "", "name in meshes").needed(),
      field("at_m", &PrintedPart::at_m, "m", "where the mesh's own origin stands on the platform [x, y, z]"),
      field("turn_rad", &PrintedPart::turn_rad, "rad", "about z, before it is set down"),
      field("microstructure", &PrintedPart::microstructure, "", "of its front faces: name in microstructures"),
      field("labels", &PrintedPart::labels, "", "micro-structures by the label of the mesh's faces"),
      field("repaired", &PrintedPart::repaired, "", "what was done to the mesh before"),
      field("volume_m3", &PrintedPart::volume_m3, "m^3", "of the mesh").range(0, infinite),
      field("facing_m2", &PrintedPart::facing_m2, "m^2", "area that faces the projector").range(0, infinite),
      field("hidden_m2", &PrintedPart::hidden_m2, "m^2", "area that faces away from it").range(0, infinite),
      field("hidden_printed_m2", &PrintedPart::hidden_printed_m2, "m^2", "of that, patterned all the same")
          .range(0, infinite)};
  return table;
}

const std::vector<Field<MeasuredPrint>>& measured_print_fields() {
  static const std::vector<Field<MeasuredPrint>> table{
      field("relief", &MeasuredPrint::relief, "", "the map: name in reliefs").needed(),
      field("at_m", &MeasuredPrint::at_m, "m",
            "where its first point, of the uppermost row, lies on the platform [x, y]")
          .needed(),
      field("turn_rad", &MeasuredPrint::turn_rad, "rad", "of its rows about z, on the platform")};
  return table;
}

const std::vector<Field<Print>>& print_fields() {
  static const std::vector<Field<Print>> table{
      field("pixel_m", &Print::pixel_m, "m", "size of a pixel on the platform [x, y]").positive().needed(),
      field("width_px", &Print::width_px, "px", "pixels along x").range(1, 1 << 16).needed(),
      field("height_px", &Print::height_px, "px", "pixels along y").range(1, 1 << 16).needed(),
      field("layer_m", &Print::layer_m, "m", "thickness of a layer").positive().needed(),
      field("layers_m", &Print::layers_m, "m", "thickness of each, where they differ").positive(),
      field("growth", &Print::growth, "", "height of a voxel by its grey value; left out: in proportion"),
      field("bleed", &Print::bleed, "", "light that reaches neighbours; left out: none"),
      field("overcure_m", &Print::overcure_m, "m", "depth in which light falls to 1/e, below what is printed")
          .positive(),
      field("ground", &Print::ground, "", "what the printer adds to all surfaces: name in ground_noises"),
      field("microstructures", &Print::microstructures, "", "patterns of surfaces, by a name of their own"),
      field("parts", &Print::parts, "", "what stands on the platform"),
      field("layers", &Print::layers, "", "file id of what is sent"),
      field("process", &Print::process, "", "of the machine, by name; units end the names"),
      field("figures", &Print::figures, "", "of the job, by name; units end the names"),
      field("relief", &Print::relief, "", "the predicted surface, seen from the projector: name in reliefs"),
      field("mesh", &Print::mesh, "", "the predicted part: name in meshes"),
      field("measured", &Print::measured, "",
            "maps of what was printed, heights from any plane; explain(1) asks them")};
  return table;
}

GONIO_RECORD(PrintGrowth, print_growth_fields);
GONIO_RECORD(PrintBleed, print_bleed_fields);
GONIO_RECORD(PrintedPart, printed_part_fields);
GONIO_RECORD(MeasuredPrint, measured_print_fields);
GONIO_RECORD(Print, print_fields);

}  // namespace gonio::manifest
