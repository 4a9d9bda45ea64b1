// ct.blur: edges wider than voxels warrant.
#include "volume/mechanisms/ct_blur.h"

namespace gonio::mechanism {

const Mechanism& ct_blur() {
  static const Mechanism declaration{
      .id = "ct.blur",
      .sentence =
          "Edges are wider than the voxels warrant: the focal spot, the detector or the object's motion spreads them.",
      .typical = "0.5 to 2 voxels",
      .equation =
          "p' = L(G * T(p)) for the line integrals p of the believed shape: G a Gaussian of spread_voxels over the "
          "detector, T = (1 + v p)^(-1/v) the intensity, L its inverse, v the spectrum's relative variance of "
          "attenuation (v = 0: "
          "exp(-p) and -ln); readings: those of the filtered back-projection of p'; to first order w = sqrt(w0^2 + "
          "spread_voxels^2) "
          "for the standard deviation w of an edge, w0 that of a tomograph that resolves its voxels (at most 0.8 of "
          "them), and walls that bulge move inwards",
      .source =
          "Kak & Slaney, Principles of Computerized Tomographic Imaging, 1988, section 5.1; Glover & Pelc, Medical "
          "Physics 7 (1980) 238-248: logarithms of mean intensities; Alvarez & Macovski, Physics in Medicine and "
          "Biology 21 (1976) 733-744: attenuation over a spectrum, here by a gamma distribution",
      .stage = "tomograph",
      .target = Target::scene,
      .domains = {"volumes"},
      .parameters = {{.name = "spread_voxels",
                      .unit = "1",
                      .lower = 0,
                      .upper = 6,
                      .start = 0.8,
                      .typical = 1,
                      .meaning = "standard deviation of the spread, in voxels of the smallest spacing"}},
      .conditions = {"volume.edge-width", "volume.edge-tilt"},
      .mistaken_for = {{.with = "ct.axis-tilt", .told_apart = "look at edges near and far from the middle slice"},
                       {.with = "a smoothed reconstruction", .told_apart = "reconstruct with the plain ramp filter"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
