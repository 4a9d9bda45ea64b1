// Linear images of a scene whose geometry is known.
#include "explain/domain.h"
#include "explain/images/images_problem.h"
#include "explain/polarization/polarization_problem.h"
#include "explain/traced/takes.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/mesh.h"
#include "relighting/scene_state.h"

namespace gonio::explain::domains {

namespace {

std::vector<Untouched> image_reasons() {
  return {{"print.", "heights of a voxel are below what pictures show"},
          {"projector.", "pictures of a scene are no codes: points that were decoded from them are clouds"},
          {"rig.", "pictures of a scene are no codes: points that were decoded from them are clouds"},
          {"structured-light.", "pictures of a scene are no codes: points that were decoded from them are clouds"},
          {"board.", "a board in a scene is an object like others; what its corners tell is the domain boards"},
          {"polarizer.", "pictures without polarizers see the sum alone (polarization)"},
          {"screen.", "pictures without polarizers see the sum alone (polarization)"},
          {"retarder.", "pictures without polarizers see the sum alone (polarization)"},
          {"lens.birefringence", "pictures without polarizers see the sum alone (polarization)"},
          {"robot.",
           "where the cameras stand is known here or free; how a robot missed that place is a hand-eye set (robot)"},
          {"tracks.", "no point is followed: pixels are compared where they are"},
          {"marker.", "markers are tables of the model markers"},
          {"ct.", "no X-rays"},
          {"scene.", "each picture is held against its own simulation: what stands elsewhere is geometry.pose"},
          {"reference.", "pictures are held against a simulation, and no white tile"},
          {"sensor.blooming", "clipped readings, and how much flows over there, are left out: ask a stack"},
          {"optics.lens-shading",
           "what one aperture shades is optics.vignetting; a stack through several tells them apart"},
          {"sensor.hot-pixel", "dark frames take them off (develop --dark); a stack finds them"},
          {"sensor.dark-current",
           "dark frames take it off (develop --dark); what is left adds the same to all exposures: light.ambient"},
          {"camera.thermal", "pictures of a scene state no temperature; corners with a column of it are boards"},
          {"camera.flat-port",
           "moves the whole picture by more than the fast model looks around a pixel; corners of a board "
           "behind it are boards, and render has it"},
          {"surface.micro-ridges",
           "glints between two and ten pixels wide: the model of a mean lobe holds for tables of a sample alone"},
          {"geometry.bend", "rims tell what is bent (align, and explain of its outlines)"},
          {"ground.", "rims of shadows tell what is not flat (align, and explain of its outlines)"},
          {"mask.", "pictures are asked pixel by pixel, without masks"},
          {"geometry.shrinkage",
           "rims tell sizes along each axis (align --free scale); pictures are asked for one growth, geometry.scale"},
          {"surface.roughness",
           "the roughness of a gloss is free or surface.interface's; that of glass and metal is traced"},
          {"surface.print-slopes", "a roughness that varies over the object is traced"},
          {"surface.print-layers", "a roughness that varies over the object is traced"},
          {"surface.polish", "a roughness that varies over the object is traced"},
          {"surface.directional-subsurface", "the fast model spreads light evenly about where it enters: traced"},
          {"surface.residue", "reliefs turn with the sample, which is measured by tables of reflectance"},
          {"surface.walls", "reliefs turn with the sample, which is measured by tables of reflectance"},
          {"surface.coating", "pictures without polarizers see the sum alone (polarization)"},
          {"surface.thin-film", "three channels average over its fringes: tables of reflectance in narrow bands"},
          {"volume.",
           "what is seen through glass is left out of the fast model: tables of transmittance, or render and "
           "compare"},
          {"colour.",
           "glare on pictures of a scene is optics.veiling-glare; that on a chart is measured before anything is "
           "rendered: color-calib(1) leaves tables of the model chart"},
          {"probe.",
           "what a mirror ball shows is measured before anything is rendered: light-probe(1) leaves tables of the "
           "models probe and probe-radiance"}};
}

}  // namespace

const Domain& images() {
  static const Domain domain{
      .name = "images",
      .sentence = "linear images with file and camera, of objects that render can simulate",
      .order = 2,
      .after = "boards",
      .needs_it = true,
      .applies =
          [](const manifest::Document& d) {
            return explain::images::has_recordings(d) && !explain::traced::beyond_the_fast_model(d) && !has_mosaics(d);
          },
      .within_reach = relighting::check_lights,
      .problems =
          [](const manifest::Document& document, const ProblemOptions& options) {
            std::vector<std::unique_ptr<Problem>> problems;
            explain::images::Options own;
            own.repeats = options.repeats;
            problems.push_back(std::make_unique<explain::images::ImagesProblem>(document, own));
            return problems;
          },
      .files =
          [](const manifest::Document& document) {
            std::vector<std::filesystem::path> files;
            const std::size_t images = names_in(document, "images").size();
            for (std::size_t i = 0; i < images; ++i)
              for (auto& file : manifest::files_of_image(document, i)) files.push_back(file);
            for (const auto& [name, mesh] : document.meshes)
              if (!mesh.file.empty())
                files.push_back(manifest::resolve(document, mesh.file, "/meshes/" + name + "/file"));
            return files;
          },
      .untouched = image_reasons()};
  return domain;
}

}  // namespace gonio::explain::domains
