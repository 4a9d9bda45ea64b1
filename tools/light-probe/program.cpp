// light-probe: the surroundings and the lights that a mirror ball shows; projections of the sphere (lib/probe).
#include "tools/light-probe/convert.h"
#include "tools/light-probe/unwrap.h"

namespace gonio::tools::light_probe {
namespace {

void check(cli::Invocation& call) {
  call.given("convert") ? check_convert(call) : check_unwrap(call);
}

Exit run(cli::Invocation& call) {
  return call.given("convert") ? convert(call) : unwrap(call);
}

std::vector<cli::Option> options() {
  std::vector<cli::Option> all = unwrap_options(), more = convert_options();
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace

const cli::Program& gonio_program() {
  static const cli::Program program{
      .name = "light-probe",
      .sentence = "the surroundings and the lights that a mirror ball shows",
      .synopsis = {"--radius LENGTH --out DIR [OPTION]... [recordings.json]",
                   "--radius LENGTH --out DIR [OPTION]... -i camera.json PICTURE",
                   "--orthographic --out DIR [OPTION]... PICTURE...",
                   "--convert PROJECTION --to PROJECTION [--height N] OLD.exr NEW.exr"},
      .options = options(),
      .operands = {{.name = "PICTURE",
                    .type = cli::Type::text,
                    .help =
                        "Photographs by the manifest's camera; else all images with a file. With --convert: the old "
                        "picture and the new one.",
                    .repeat = true}},
      .standalone = {"convert", "orthographic"},
      .takes_out = true,
      .sections_read = {"files", "cameras", "images", "goniometer"},
      .sections_written = {"files", "environments", "lights", "images", "tables"},
      .files = {{"NAME.exr", "the surroundings: latitude-longitude, linear radiance, the light lat-long of render(1)"},
                {"NAME-weight.exr",
                 "Y: share of the texel that some photograph shows, 0 where it was filled; footprint: width of the "
                 "finest pixel that shows it, rad"},
                {"NAME-balls.csv", "where the balls are, and their outlines"},
                {"NAME-lights.csv", "directions, positions, irradiances and sizes of the lights, with uncertainties"},
                {"NAME-highlights.csv",
                 "where two views or more show the same lamps: a table of the model probe, for explain(1)"},
                {"NAME-reflected.csv",
                 "what the ball reflects of these lamps at which incidence: a table of the model probe-radiance"}},
      .references = {"Debevec, Rendering synthetic objects into real scenes, SIGGRAPH 1998.",
                     "Johnson & Christy, Optical constants of transition metals, Phys. Rev. B 9, 1974.",
                     "Jones, First- and second-order conservative remapping schemes, Monthly Weather Review 127, 1999.",
                     "Gortler, Grzeszczuk, Szeliski & Cohen, The Lumigraph, SIGGRAPH 1996."},
      .see_also = {"develop(1)", "render(1)", "explain(1)", "calib-charuco(1)", "gonio-conventions(7)",
                   "gonio-manifest(5)"},
      .check = check,
      .run = run};
  return program;
}

}  // namespace gonio::tools::light_probe
