// Stacks of pictures of one static scene without geometry.
#include "explain/domain.h"
#include "explain/stacks/exposures_problem.h"
#include "explain/stacks/photometric_problem.h"
#include "manifest/document.h"
#include "manifest/image_list.h"

namespace gonio::explain::domains {

namespace {

std::vector<Untouched> reasons_one_by_one() {
  return {
      {"print.", "heights of a voxel are below what pictures show"},
      {"projector.", "exposures of a still scene are no codes: points that were decoded from them are clouds"},
      {"rig.", "exposures of a still scene are no codes: points that were decoded from them are clouds"},
      {"structured-light.", "exposures of a still scene are no codes: points that were decoded from them are clouds"},
      {"lens.", "camera and scene stand still: where a pixel looks cancels"},
      {"camera.", "camera and scene stand still while and between pictures are taken"},
      {"ground.", "a stack has no geometry, and no rims"},
      {"mask.", "a stack has no geometry, and no rims"},
      {"board.", "camera and scene stand still: where a pixel looks cancels"},
      {"light.finite-size", "its penumbrae need what casts the shadow, and a stack has no geometry"},
      {"light.lobe", "the lamps are distant, and their strengths and slopes across the picture are free"},
      {"light.position", "the lamps are distant: light.direction, and light.inverse-square where they are not"},
      {"light.near-environment", "needs places, and a stack has no geometry"},
      {"light.polarization", "no polarizer is stated"},
      {"light.reflector", "needs places, and a stack has no geometry"},
      {"light.second-source",
       "a second lamp beside each would need its own direction in every picture, as many numbers as a patch has "
       "readings; what all have in common is light.ambient"},
      {"light.spectrum", "strength in each channel is the tint of every patch"},
      {"optics.bloom", "sites lie where their neighbours are even: a halo there is the veil of optics.veiling-glare"},
      {"optics.defocus",
       "every pixel is fitted alone: what its neighbours send it is the same in all pictures but where shadows "
       "end"},
      {"optics.ghost", "needs a bright source in the picture; readings of sites are even about them"},
      {"sensor.clipped-resampling", "sites lie where their neighbours are even"},
      {"sensor.dark-current", "grows with the exposure as light does: one with the radiances, which are free"},
      {"sensor.crosstalk", "sites lie where their neighbours are even, and the tint of each is free"},
      {"sensor.prnu", "a pixel's gain is its patch's albedo, which is free"},
      {"sensor.row-pattern", "readings of a patch share a row, and lamps strengths that are free in every picture"},
      {"transport.", "needs what lies around a patch, and a stack has no geometry"},
      {"geometry.", "a stack has no geometry: the normal of every patch is free"},
      {"surface.anisotropy", "a patch has no tangent, and too few readings to find one beside its normal"},
      {"surface.coat", "a patch is all there is: surface.interface is asked of all of them alike"},
      {"surface.translucent", "needs the far side, and a stack has no geometry"},
      {"surface.fluorescence", "no picture states the band that excites"},
      {"surface.micro-ridges", "a patch has no tangent, and too few readings to find one beside its normal"},
      {"surface.roughness", "the roughness of a gloss is surface.interface's own"},
      {"surface.print-slopes", "needs the shape, and a stack has no geometry"},
      {"surface.print-layers", "needs the shape, and a stack has no geometry"},
      {"surface.polish", "needs the shape, and a stack has no geometry"},
      {"surface.directional-subsurface", "needs the distance to where light enters, and a stack has no geometry"},
      {"surface.residue", "reliefs are measured on samples that turn: tables of reflectance"},
      {"surface.walls", "reliefs are measured on samples that turn: tables of reflectance"},
      {"surface.spatial-variation", "albedo and tint are free at every patch"},
      {"surface.specular", "so few lamps find a lobe at most once or twice: too coarse a scan to part two"},
      {"surface.subsurface", "needs the distance to where light enters, and a stack has no geometry"},
      {"surface.coating", "three channels under few lamps show one phase in ten: tables of a polarimeter"},
      {"surface.thin-film", "three channels under few lamps show one phase in ten: tables of reflectance"},
      {"volume.", "nothing is known to be transparent"},
      {"reference.", "a stack has no white tile beside it"},
      {"robot.", "no robot is known"},
      {"tracks.", "nothing moves"},
      {"marker.", "markers are tables of the model markers"},
      {"ct.", "no X-rays"},
      {"colour.",
       "a stack knows no reference colours: glare on it is optics.veiling-glare, on a chart tables of the model chart"},
      {"probe.", "mirror balls beside a stack are read by light-probe(1), which leaves tables of the model probe"}};
}

std::vector<Untouched> stack_reasons() {
  std::vector<Untouched> all = reasons_one_by_one();
  for (const char* ids : {"polarizer.", "screen.", "retarder."})
    all.push_back({ids, "a stack has no geometry to tell how its light swings"});
  return all;
}

}  // namespace

const Domain& stacks() {
  static const Domain domain{
      .name = "stacks",
      .sentence =
          "pictures of one static scene without objects: three exposures with exposure_s, or six under distant "
          "lamps",
      .order = 4,
      .applies =
          [](const manifest::Document& document) {
            using namespace explain::stacks;
            return !stacks_of(document, Kind::exposures).empty() || !stacks_of(document, Kind::lights).empty();
          },
      .problems =
          [](const manifest::Document& document, const ProblemOptions&) {
            std::vector<std::unique_ptr<Problem>> problems = explain::stacks::exposures_problems(document);
            for (std::unique_ptr<Problem>& p : explain::stacks::photometric_problems(document))
              problems.push_back(std::move(p));
            return problems;
          },
      .files =
          [](const manifest::Document& document) {
            std::vector<std::filesystem::path> files;
            for (const explain::stacks::Kind kind : {explain::stacks::Kind::exposures, explain::stacks::Kind::lights})
              for (const std::vector<std::size_t>& entries : explain::stacks::stacks_of(document, kind))
                for (const std::size_t i : entries)
                  for (auto& file : manifest::files_of_image(document, i)) files.push_back(file);
            return files;
          },
      .untouched = stack_reasons()};
  return domain;
}

}  // namespace gonio::explain::domains
