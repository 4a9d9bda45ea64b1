// Photographs of a polarization camera.
#include "explain/domain.h"
#include "explain/polarization/polarization_problem.h"

namespace gonio::explain::domains {

const Domain& polarization() {
  static const Domain domain{
      .name = "polarization",
      .sentence = "mosaic photographs of a polarization camera, of objects that render can simulate",
      .order = 2,
      .after = "boards",
      .needs_it = true,
      .applies = has_mosaics,
      .within_reach = check_mosaics,
      .problems = polarization_problems,
      .files = mosaic_files,
      .untouched = {
          {"print.", "heights of a voxel are below what pictures show"},
          {"projector.", "pictures of a scene are no codes: points that were decoded from them are clouds"},
          {"rig.", "pictures of a scene are no codes: points that were decoded from them are clouds"},
          {"structured-light.", "pictures of a scene are no codes: points that were decoded from them are clouds"},
          {"board.", "a board in a scene is an object like others; what its corners tell is the domain boards"},
          {"robot.", "where the camera stands is known here; how a robot missed that place is a hand-eye set (robot)"},
          {"tracks.", "no point is followed: samples are compared where they are"},
          {"marker.", "markers are tables of the model markers"},
          {"ct.", "no X-rays"},
          {"scene.", "each picture is held against its own simulation, and must show what it says"},
          {"reference.", "pictures are held against a simulation, and no white tile"},
          {"probe.", "what a mirror ball shows is measured before anything is rendered: light-probe(1)"},
          {"colour.", "behind polarizers there are no colours"},
          {"camera.",
           "samples lie where the light is even: where the camera looks is told by boards, and by pictures without "
           "polarizers"},
          {"lens.", "samples lie where the light is even: where rays go is told by boards"},
          {"optics.",
           "what a lens does to light whatever way it swings is asked of pictures without polarizers (images)"},
          {"sensor.",
           "what a sensor does to a reading whatever way light swings is asked of pictures without polarizers (images, "
           "stacks)"},
          {"ground.", "rims of shadows tell what is not flat (align, and explain of its outlines)"},
          {"mask.", "pictures are asked sample by sample, without masks of shadows"},
          {"geometry.",
           "samples lie where the light is even: rims tell shapes and sizes (align, and explain of its outlines)"},
          {"light.", "lamps are asked of pictures without polarizers (images); of screens, how their light swings"},
          {"light.polarization",
           "a lamp that states no polarization is one of pictures without polarizers; screens state theirs: "
           "screen.leak and screen.angle"},
          {"surface.",
           "what surfaces send back whatever way light swings is asked of pictures without polarizers (images, "
           "traced)"},
          {"transport.", "the path tracer has light between surfaces and caustics"},
          {"volume.", "the way of light through glass is asked of pictures without polarizers (traced)"},
          {"retarder.", "no retarder stands before the camera; a lens that is one is lens.birefringence"}}};
  return domain;
}

}  // namespace gonio::explain::domains
