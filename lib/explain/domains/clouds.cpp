// Clouds of structured light against shapes that are known, or against each other.
#include "explain/clouds/clouds_problem.h"
#include "explain/domain.h"
#include "manifest/document.h"
#include "manifest/sections/cloud.h"
#include "manifest/sections/mesh.h"

namespace gonio::explain::domains {
namespace {

std::vector<std::filesystem::path> files_of_clouds(const manifest::Document& document) {
  std::vector<std::filesystem::path> files;
  for (const auto& [name, cloud] : document.clouds) {
    files.push_back(manifest::resolve(document, cloud.file, "/clouds/" + name + "/file"));
    if (!cloud.shape || cloud.shape->mesh.empty()) continue;
    const std::string& file = document.meshes.at(cloud.shape->mesh).file;
    if (!file.empty()) files.push_back(manifest::resolve(document, file, "/meshes/" + cloud.shape->mesh + "/file"));
  }
  return files;
}

}  // namespace

const Domain& clouds() {
  static const Domain domain{
      .name = "clouds",
      .sentence =
          "clouds (structured-light) that state the shape their points lie on: planes, spheres, meshes; or, where "
          "they were placed in the world, clouds that overlap, against each other",
      .order = 8,
      .applies = has_clouds_to_ask,
      .problems =
          [](const manifest::Document& document, const ProblemOptions&) {
            std::vector<std::unique_ptr<Problem>> problems;
            for (CloudsInput& input : clouds_inputs(document)) problems.push_back(clouds_problem(std::move(input)));
            return problems;
          },
      .files = files_of_clouds,
      .untouched = {
          {"polarizer.", "points say nothing of how light swings"},
          {"screen.", "points say nothing of how light swings"},
          {"retarder.", "points say nothing of how light swings"},
          {"print.", "what was sent to a printer is not known of a cloud"},
          {"surface.",
           "points are places, and keep no brightness; what a surface does to where they lie is "
           "structured-light.subsurface"},
          {"light.", "points are places, and keep no brightness; what the projector does to them is projector.*"},
          {"optics.", "points are places, and keep no brightness"},
          {"sensor.",
           "patterns are told by differences of brightness between frames, which what a sensor adds leaves as they "
           "are"},
          {"volume.", "points are places, and keep no brightness"},
          {"scene.", "what moves while patterns are shown is structured-light.motion"},
          {"transport.", "what light from other parts of the thing does to phases is structured-light.interreflection"},
          {"reference.", "points are held against no tile"},
          {"ground.", "points are places on a surface; rims are outlines"},
          {"mask.", "points are places on a surface; rims are outlines"},
          {"geometry.", "the shape is known, form and size; where it stands is free"},
          {"lens.",
           "three numbers of a lens are asked here (lens.radial, lens.tangential); a camera's finer terms are left to "
           "boards, which has corners"},
          {"camera.", "left to boards, which has corners: codes are read from still pictures in one medium"},
          {"board.", "no board is in the scene"},
          {"robot.", "every cloud's shape stands where it was measured: no arm is asked"},
          {"tracks.", "nothing is tracked"},
          {"marker.", "markers are tables of the model markers"},
          {"ct.", "no X-rays"},
          {"colour.", "points are places, and keep no brightness"},
          {"probe.", "the scene has no mirror ball"}}};
  return domain;
}

}  // namespace gonio::explain::domains
