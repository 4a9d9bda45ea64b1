// Rims of objects and shadows against the model that align placed.
#include "explain/domain.h"
#include "explain/outlines/outlines_problem.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"

namespace gonio::explain::domains {
namespace {

std::vector<std::filesystem::path> files_of_outlines(const manifest::Document& document) {
  std::vector<std::filesystem::path> files;
  for (std::size_t i = 0; i < document.outlines.size(); ++i) {
    const std::string& mask = document.outlines[i].mask;
    if (!mask.empty()) files.push_back(manifest::resolve(document, mask, "/outlines/" + std::to_string(i) + "/mask"));
  }
  for (const manifest::Alignment& a : document.alignments)
    for (const manifest::Object& object : document.objects) {
      if (object.id != a.object || object.mesh.empty()) continue;
      const std::string& file = document.meshes.at(object.mesh).file;
      if (!file.empty()) files.push_back(manifest::resolve(document, file, "/meshes/" + object.mesh + "/file"));
    }
  return files;
}

}  // namespace

const Domain& outlines() {
  static const Domain domain{
      .name = "outlines",
      .sentence = "rims of objects and of their shadows, which align has found and placed the object by",
      .order = 9,
      .objects = outlines_objection,
      .applies = has_outlines,
      .within_reach = outlines_within_reach,
      .problems =
          [](const manifest::Document& document, const ProblemOptions&) {
            std::vector<std::unique_ptr<Problem>> problems;
            problems.push_back(outlines_problem(outlines_input(document)));
            return problems;
          },
      .files = files_of_outlines,
      .untouched = {
          {"polarizer.", "rims say where things are, not how light swings"},
          {"screen.", "rims say where things are, not how light swings"},
          {"retarder.", "rims say where things are, not how light swings"},
          {"print.", "layers and grey values are below what rims show; geometry.shrinkage is"},
          {"surface.", "rims are places, and keep no brightness"},
          {"light.",
           "rims of shadows tell where a lamp is and how large; what it gives where is seen in pictures, not in rims"},
          {"geometry.contact", "a pose that rims fit says how deep an object lies"},
          {"optics.", "what a lens blurs is free in every edge's width"},
          {"sensor.", "rims are places, and keep no grey levels"},
          {"scene.", "rims of one still scene are asked: what moved between pictures has other rims in each"},
          {"transport.",
           "rims are places, and keep no brightness; what light in a shadow does to masks is mask.caustic"},
          {"volume.", "rims are places, and keep no brightness"},
          {"reference.", "rims are held against no tile"},
          {"lens.", "left to boards, which has corners all over the picture"},
          {"camera.", "left to boards, which has corners; where cameras stand align finds (--free camera)"},
          {"board.", "no board is in the scene"},
          {"robot.", "every view's camera is placed by itself"},
          {"tracks.", "nothing is tracked"},
          {"marker.", "markers are tables of the model markers"},
          {"ct.", "no X-rays"},
          {"colour.", "rims are places, and keep no colour"},
          {"probe.", "the scene has no mirror ball"},
          {"projector.", "a scene with a projector gives clouds"},
          {"rig.", "a scene with a projector gives clouds"},
          {"structured-light.", "a scene with a projector gives clouds"}}};
  return domain;
}

}  // namespace gonio::explain::domains
