// Tables of observations that a registered model predicts: grey levels, irradiance, transmittance, reflectance, tracks,
// and whatever an expression describes.
#include "explain/domain.h"
#include "explain/tables/tables_problem.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"

namespace gonio::explain::domains {
namespace {

std::vector<std::filesystem::path> files_of_tables(const manifest::Document& document) {
  std::vector<std::filesystem::path> files;
  for (const auto& [name, table] : document.tables)
    if (explain::tables::find_model(table.model) != nullptr && !table.file.empty())
      files.push_back(manifest::resolve(document, table.file, "/tables/" + name + "/file"));
  return files;
}

}  // namespace

const Domain& tables() {
  static const Domain domain{
      .name = "tables",
      .sentence =
          "tables whose model predicts them (sensor, light, volume, surface, tracks, markers, probe, probe-radiance, "
          "chart, temperature, ellipsometer, polarimeter, tracker, arm, expression)",
      .order = 4,
      .applies = explain::tables::has_tables,
      .problems = explain::tables::table_problems,
      .files = files_of_tables,
      .untouched = {
          {"screen.", "a polarimeter has lamps of its own: what they send is told by its polarizer"},
          {"print.", "a table of readings has no pictures that were sent to a printer"},
          {"projector.", "rows of a table are no codes: points that were decoded from pictures are clouds"},
          {"rig.", "rows of a table are no codes: points that were decoded from pictures are clouds"},
          {"structured-light.", "rows of a table are no codes: points that were decoded from pictures are clouds"},
          {"ground.", "rows have no rims"},
          {"mask.", "rows have no rims"},
          {"board.", "corners of boards are the domain boards"},
          {"lens.",
           "a table's rows have no pixels but those of tracks and markers, to which lens.radial says what so few can "
           "show"},
          {"camera.", "a table of corners with columns of row, time or temperature is the domain boards"},
          {"light.near-environment", "irradiance over a plane knows no directions of the surroundings"},
          {"light.polarization", "no column states a polarizer"},
          {"light.position", "where the lamps stand is the base model's own: mark position_m free"},
          {"light.reflector", "irradiance is measured over a free plane; what stands beside it is light.second-source"},
          {"optics.", "a row has no neighbours in a picture for light to go to"},
          {"sensor.clipped-resampling", "a row has no neighbours in a picture"},
          {"sensor.blooming", "a row has no neighbours in a picture"},
          {"sensor.hot-pixel", "a row names no pixel"},
          {"sensor.crosstalk", "a row has no neighbours in a picture, and its channels are measured apart"},
          {"sensor.prnu", "a row names no pixel"},
          {"sensor.exposure", "a reading states its own exposure: sensor.shutter is what all of them have in common"},
          {"scene.", "a row has no neighbours in a picture that could move"},
          {"transport.", "rows know of no other bodies"},
          {"volume.fog", "a row knows no way through the air; what lies on the way is volume.absorption"},
          {"surface.coat", "samples of a reflectance are those of one place: surface.interface"},
          {"surface.translucent", "samples of a reflectance are those of one side"},
          {"surface.spatial-variation", "samples of a reflectance are those of one place"},
          {"surface.roughness", "the roughness of a measured lobe is free, or surface.specular's"},
          {"surface.print-slopes", "samples of a reflectance are those of one place"},
          {"surface.print-layers", "samples of a reflectance are those of one place"},
          {"surface.polish", "samples of a reflectance are those of one place"},
          {"surface.directional-subsurface", "samples of a reflectance do not say where the light went in"},
          {"surface.subsurface", "samples of a reflectance do not say where the light went in"},
          {"geometry.", "rows know of no body but the plane or the sample that they were measured on"},
          {"robot.",
           "joint angles with poses of boards are the domain robot; the models tracker and arm have places alone, "
           "and temperature what warms"},
          {"tracks.", "a table of tracks holds points against a known shape: their scale is that shape's"},
          {"ct.", "a table has lengths measured in a volume, which ct.scale alone changes in proportion"}}};
  return domain;
}

}  // namespace gonio::explain::domains
