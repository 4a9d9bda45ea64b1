// Linear images of what the path tracer alone can simulate.
#include "explain/domain.h"
#include "explain/polarization/polarization_problem.h"
#include "explain/traced/takes.h"
#include "explain/traced/traced_problem.h"
#include "manifest/document.h"

namespace gonio::explain::domains {
namespace {

std::vector<Untouched> traced_reasons() {
  const char* camera =
      "cameras and sensors are asked of pictures that the fast model can follow (images), of boards and of stacks";
  return {
      {"print.", "heights of a voxel are below what pictures show"},
      {"projector.", "pictures of a scene are no codes: points that were decoded from them are clouds"},
      {"rig.", "pictures of a scene are no codes: points that were decoded from them are clouds"},
      {"structured-light.", "pictures of a scene are no codes: points that were decoded from them are clouds"},
      {"board.", "a board in a scene is an object like others; what its corners tell is the domain boards"},
      {"polarizer.", "pictures without polarizers see the sum alone (polarization)"},
      {"screen.", "pictures without polarizers see the sum alone (polarization)"},
      {"retarder.", "pictures without polarizers see the sum alone (polarization)"},
      {"robot.", "where the cameras stand is known here; how a robot missed that place is a hand-eye set (robot)"},
      {"tracks.", "no point is followed: pixels are compared where they are"},
      {"marker.", "markers are tables of the model markers"},
      {"ct.", "no X-rays"},
      {"scene.", "each picture is held against its own simulation: what stands elsewhere is geometry.pose"},
      {"reference.", "pictures are held against a simulation, and no white tile"},
      {"probe.", "what a mirror ball shows is measured before anything is rendered: light-probe(1)"},
      {"colour.", camera},
      {"camera.", camera},
      {"lens.", camera},
      {"optics.", camera},
      {"sensor.", camera},
      {"ground.", "rims of shadows tell what is not flat (align, and explain of its outlines)"},
      {"mask.", "pictures are asked pixel by pixel, without masks"},
      {"geometry.", "rims tell shapes and sizes (align, and explain of its outlines)"},
      {"light.", "lamps are asked of matte things, whose pictures the fast model can follow (images)"},
      {"surface.", "what a matte or coated surface does is asked of pictures that the fast model can follow (images)"},
      {"transport.", "the path tracer has light between surfaces and caustics"},
      {"volume.dispersion", "three channels average over it: tables of narrow bands"},
      {"volume.fog", "air that scatters is asked of pictures that the fast model can follow (images)"}};
}

}  // namespace

const Domain& images();
const Domain& traced() {
  static const Domain domain{
      .name = "traced",
      .sentence = "linear images of glass, metal and translucent bodies, and of roughness that varies",
      .order = 10,
      .after = "images",
      .objects = explain::traced::traced_objection,
      .applies = [](const manifest::Document& d) { return explain::traced::wants_tracing(d) && !has_mosaics(d); },
      .within_reach = explain::traced::check_reach,
      .problems =
          [](const manifest::Document& document, const ProblemOptions& options) {
            std::vector<std::unique_ptr<Problem>> problems;
            problems.push_back(explain::traced::traced_problem(document, {.repeats = options.repeats}));
            return problems;
          },
      .files = images().files,
      .untouched = traced_reasons()};
  return domain;
}

}  // namespace gonio::explain::domains
