// colour.metamerism: a camera that is no mixture of the eye's three functions sees two inks of one colour apart.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& colour_metamerism() {
  static const Mechanism declaration{
      .id = "colour.metamerism",
      .sentence =
          "The camera's filters are no mixture of the eye's: inks that look as stated are read off by what their "
          "spectra, the filters and the light make of them, and no matrix mends it.",
      .typical = "0.5 to 5 % of a reading",
      .equation =
          "v += share (s - M x): s what the stated sensitivities read of the patch's reflectance under the stated "
          "light, x its XYZ, M the matrix that comes closest to s over all patches; share 1: all of it",
      .source = "Luther 1927; ISO 17321-1:2012, sensitivity metamerism index",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"tables"},
      .parameters = {{.name = "share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -1,
                      .upper = 3,
                      .start = 0.5,
                      .typical = 1,
                      .meaning = "share of what the stated sensitivities and light predict; far from 1: they are those "
                                 "of another camera "
                                 "or lamp"}},
      .conditions = {"image.hue"},
      .mistaken_for = {{.with = "sensor.crosstalk",
                        .told_apart = "a matrix takes crosstalk up; what spectra do is left whatever the matrix"},
                       {.with = "light.spectrum",
                        .told_apart = "measure the lamp's spectrum, or photograph the chart under two lamps"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
