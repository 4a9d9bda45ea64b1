// Field tables of the sections about heights: maps, their roughness and lobes, ground noises.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/ground_noise.h"
#include "manifest/sections/relief.h"

namespace gonio::manifest {

const std::vector<Field<ReliefTreatment>>& relief_treatment_fields() {
  static const std::vector<Field<ReliefTreatment>> table{
      field("levelling", &ReliefTreatment::levelling, "", "what was fitted and taken off; the mean always is")
          .one_of({"none", "plane", "quadratic"})
          .needed(),
      field("tilt", &ReliefTreatment::tilt, "", "slopes [x, y] of the plane that was taken off"),
      field("s_filter_m", &ReliefTreatment::s_filter_m, "m", "nesting index of the filter that smooths").positive(),
      field("l_filter_m", &ReliefTreatment::l_filter_m, "m", "nesting index of the filter that takes longer waves away")
          .positive()};
  return table;
}

const std::vector<Field<RoughnessFigure>>& roughness_figure_fields() {
  static const std::vector<Field<RoughnessFigure>> table{
      field("value", &RoughnessFigure::value, "", "in the unit").needed(),
      field("unit", &RoughnessFigure::unit, "", "m, or 1").one_of({"m", "1"}).needed(),
      field("sigma", &RoughnessFigure::sigma, "", "one standard deviation; extremes of a map have none")
          .range(0, infinite)};
  return table;
}

const std::vector<Field<NormalsFit>>& normals_fit_fields() {
  static const std::vector<Field<NormalsFit>> table{
      field("distribution", &NormalsFit::distribution, "", "ggx or beckmann").one_of({"ggx", "beckmann"}).needed(),
      field("alpha_u", &NormalsFit::alpha_u, "", "roughness along the axis of the largest slopes")
          .range(0, infinite)
          .needed(),
      field("alpha_v", &NormalsFit::alpha_v, "", "roughness across it").range(0, infinite).needed(),
      field("azimuth_rad", &NormalsFit::azimuth_rad, "rad", "of that axis, counter-clockwise from the rows"),
      sigma_field(&NormalsFit::sigma),
      field("log_likelihood", &NormalsFit::log_likelihood, "", "per slope; larger is better")};
  return table;
}

const std::vector<Field<ReliefLobe>>& relief_lobe_fields() {
  static const std::vector<Field<ReliefLobe>> table{
      field("incidence_rad", &ReliefLobe::incidence_rad, "rad", "of the light, from the normal").needed(),
      field("azimuth_rad", &ReliefLobe::azimuth_rad, "rad", "from which it comes"),
      field("treatment", &ReliefLobe::treatment, "", "what was taken off the heights before"),
      field("tiling", &ReliefLobe::tiling, "", "how the map goes on: mirrored or repeated")
          .one_of({"mirrored", "repeated"}),
      field("facets", &ReliefLobe::facets, "", "surface model of the facets"),
      field("parameters", &ReliefLobe::parameters, "", "of the facets' model"),
      field("reflected", &ReliefLobe::reflected, "", "share of the light: red, green, blue"),
      field("lost", &ReliefLobe::lost, "", "share that facets absorbed or let through"),
      field("cut", &ReliefLobe::cut, "", "share that was left when a path was ended"),
      field("by_facets", &ReliefLobe::by_facets, "", "of what is reflected: met 1, 2, 3, more facets").range(0, 1),
      field("peak", &ReliefLobe::peak, "1/sr", "largest cell of the table: red, green, blue"),
      field("peak_theta_rad", &ReliefLobe::peak_theta_rad, "rad", "where it lies, from the normal"),
      field("peak_phi_rad", &ReliefLobe::peak_phi_rad, "rad", "its azimuth"),
      sigma_field(&ReliefLobe::sigma),
      field("paths", &ReliefLobe::paths, "", "that were traced"),
      field("picture", &ReliefLobe::picture, "", "file id: the hemisphere from above in false colours")};
  return table;
}

const std::vector<Field<ReliefMap>>& relief_map_fields() {
  static const std::vector<Field<ReliefMap>> table{
      field("file", &ReliefMap::file, "", "file id of the height map").needed(),
      field("width", &ReliefMap::width, "", "points along its rows").range(1, 1 << 20),
      field("height", &ReliefMap::height, "", "points along its columns").range(1, 1 << 20),
      field("step_m", &ReliefMap::step_m, "m", "distance of neighbouring points [x, y]").positive(),
      field("unit_m", &ReliefMap::unit_m, "m", "of pictures: what a height of 1 means").positive(),
      field("channel", &ReliefMap::channel, "", "of an OpenEXR: the channel of the heights"),
      field("kind", &ReliefMap::kind, "", "of a map that was made; left out: measured")
          .one_of({"noise", "ridges", "sinusoid"}),
      field("design", &ReliefMap::design, "", "what it was made from, by name; one number, or one for each part"),
      field("missing", &ReliefMap::missing, "", "points without a height").range(0, infinite),
      field("treatment", &ReliefMap::treatment, "", "of the parameters and normals: what was taken off before"),
      field("parameters", &ReliefMap::parameters, "", "areal parameters of ISO 25178-2: Sa, Sq, Sz, ..."),
      field("independent_areas", &ReliefMap::independent_areas, "", "that know nothing of each other")
          .range(0, infinite),
      field("long_waves", &ReliefMap::long_waves, "", "true: structure as long as the map, sigmas are too small"),
      field("normals", &ReliefMap::normals, "", "distributions of its normals, the likelier first"),
      field("lobes", &ReliefMap::lobes, "", "how it reflects light, one entry a direction"),
      field("table", &ReliefMap::table, "", "of the lobes: name in tables"),
      field("surface", &ReliefMap::surface, "", "what its normals make of the facets: name in surfaces")};
  return table;
}

const std::vector<Field<GroundNoisePart>>& ground_noise_part_fields() {
  static const std::vector<Field<GroundNoisePart>> table{
      field("sq_m", &GroundNoisePart::sq_m, "m", "root mean square height").range(0, infinite).needed(),
      field("cell_m", &GroundNoisePart::cell_m, "m", "size of its cells").positive().needed(),
      sigma_field(&GroundNoisePart::sigma),
      field("weight", &GroundNoisePart::weight, "", "of the published form, over the thickness of a layer")
          .range(0, infinite)};
  return table;
}

const std::vector<Field<GroundNoiseFit>>& ground_noise_fields() {
  static const std::vector<Field<GroundNoiseFit>> table{
      field("reliefs", &GroundNoiseFit::reliefs, "", "that it was fitted to: names in reliefs"),
      field("parts", &GroundNoiseFit::parts, "", "of the sum, coarse to fine"),
      field("white_m", &GroundNoiseFit::white_m, "m", "the instrument's own noise, root mean square")
          .range(0, infinite),
      sigma_field(&GroundNoiseFit::sigma),
      field("layer_m", &GroundNoiseFit::layer_m, "m", "thickness of a printed layer, of the weights").positive(),
      field("misfit", &GroundNoiseFit::misfit, "", "scatter of the spectrum about the model; 1 where the form is right")
          .range(0, infinite),
      field("log_rms", &GroundNoiseFit::log_rms, "", "of the logarithm of measured over modelled bands of frequency")
          .range(0, infinite),
      field("tiles", &GroundNoiseFit::tiles, "", "that were looked at").range(0, infinite),
      field("criterion", &GroundNoiseFit::criterion, "", "Schwarz's, for 1, 2, ... parts, less the least"),
      field("example", &GroundNoiseFit::example, "", "name in reliefs of a map made with it")};
  return table;
}

GONIO_RECORD(ReliefTreatment, relief_treatment_fields);
GONIO_RECORD(RoughnessFigure, roughness_figure_fields);
GONIO_RECORD(NormalsFit, normals_fit_fields);
GONIO_RECORD(ReliefLobe, relief_lobe_fields);
GONIO_RECORD(ReliefMap, relief_map_fields);
GONIO_RECORD(GroundNoisePart, ground_noise_part_fields);
GONIO_RECORD(GroundNoiseFit, ground_noise_fields);

}  // namespace gonio::manifest
