// colour.glare: light that lies on all patches of a chart. Equation: render/mechanisms/optics_veiling_glare.h, the
// share by channel.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& colour_glare() {
  static const Mechanism declaration{
      .id = "colour.glare",
      .sentence =
          "Light that strays in the lens, or that the room sends over the chart's gloss, lies on all patches alike.",
      .typical = "0.2 to 5 % of the mean of what the camera sees",
      .equation =
          "v += (share + c) mean(v), the mean over picture or chart, channel by channel; c is red or blue in these "
          "channels and 0 in green",
      .source = "ISO 9358:1994, veiling glare index; ISO 18844:2017, flare measured on a chart's black",
      .stage = "optics",
      .target = Target::camera,
      .domains = {"tables"},
      .parameters = {{.name = "share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.5,
                      .start = 0.01,
                      .typical = 0.02,
                      .meaning = "share of the mean that lies on every patch"},
                     {.name = "red",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.5,
                      .upper = 0.5,
                      .start = 0.002,
                      .typical = 0.01,
                      .meaning =
                          "by which the share is larger in R: what shines on it has another colour than the mean"},
                     {.name = "blue",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.5,
                      .upper = 0.5,
                      .start = 0.002,
                      .typical = 0.01,
                      .meaning = "the same in B"}},
      .conditions = {"image.radiance"},
      .mistaken_for = {{.with = "sensor.black-offset",
                        .told_apart = "the same chart at a quarter of the exposure: glare falls with the light, an "
                                      "offset stays"},
                       {.with = "sensor.non-linearity",
                        .told_apart =
                            "mask what is bright beside the chart, or lay black velvet about it: glare falls"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
