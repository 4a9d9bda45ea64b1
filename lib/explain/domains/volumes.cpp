// CT volumes against the shape that the user believes in.
#include "explain/domain.h"
#include "explain/volumes/volumes_problem.h"

namespace gonio::explain::domains {

const Domain& volumes() {
  static const Domain domain{
      .name = "volumes",
      .sentence = "CT volumes whose \"reference\" names the shape that you believe in (a CAD model, a measured part)",
      .order = 7,
      .applies = has_volumes,
      .problems =
          [](const manifest::Document& document, const ProblemOptions&) {
            std::vector<std::unique_ptr<Problem>> problems;
            for (VolumesInput& input : volumes_inputs(document)) problems.push_back(volumes_problem(std::move(input)));
            return problems;
          },
      .files = volumes_files,
      .untouched = {
          {"polarizer.", "no X-ray is polarized by what is here"},
          {"screen.", "no X-ray is polarized by what is here"},
          {"retarder.", "no X-ray is polarized by what is here"},
          {"print.", "what was sent to a printer is not known of a scanned part"},
          {"projector.", "no projector shows codes"},
          {"rig.", "no projector shows codes"},
          {"structured-light.", "no projector shows codes"},
          {"light.", "X-rays: no lamp"},
          {"optics.", "X-rays: no lens"},
          {"lens.", "X-rays: no lens"},
          {"camera.", "X-rays: no camera; the detector's faults are ct.ring and ct.blur"},
          {"sensor.",
           "the detector's readings have been reconstructed: its faults show as ct.ring, ct.cupping and ct.streak"},
          {"surface.", "X-rays pass the surface as they find it"},
          {"scene.", "a scan has no pictures that could be held against each other"},
          {"transport.", "what light does between bodies is ct.scatter for X-rays"},
          {"volume.", "the index of refraction of X-rays is one; what they lose on their way is the volume itself"},
          {"reference.", "the reference is a shape, and no white tile"},
          {"ground.", "a volume has no rims: what bounds a body there is ct.threshold"},
          {"mask.", "a volume has no rims: what bounds a body there is ct.threshold"},
          {"geometry.",
           "what a volume shows of it has the names ct.threshold (offset), ct.scale (scale) and ct.axis-tilt (pose)"},
          {"board.", "a scanned part is no board of corners"},
          {"robot.", "a tomograph turns its part by no robot"},
          {"tracks.", "nothing moves"},
          {"marker.", "markers are tables of the model markers"},
          {"colour.", "X-rays see no colours"},
          {"probe.", "X-rays see no mirror"}}};
  return domain;
}

}  // namespace gonio::explain::domains
