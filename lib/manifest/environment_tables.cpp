// The field table of the surroundings.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/environment.h"

namespace gonio::manifest {

const std::vector<Field<Environment>>& environment_fields() {
  static const std::vector<Field<Environment>> table{
      field("file", &Environment::file, "", "file id of the picture, linear radiance").needed(),
      field("projection", &Environment::projection, "", "how the sphere lies on it").one_of({"lat-long"}),
      field("blind_sr", &Environment::blind_sr, "sr", "solid angle that no photograph showed")
          .range(0, 12.566370614359173),
      field("scale", &Environment::scale, "W/(m^2 sr)", "radiance of a picture value of one").positive(),
      sigma_field(&Environment::sigma)};
  return table;
}

GONIO_RECORD(Environment, environment_fields);

}  // namespace gonio::manifest
