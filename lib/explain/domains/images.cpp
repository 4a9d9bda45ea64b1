// Linear images of a scene whose geometry is known.
#include "explain/domain.h"
#include "explain/images/images_problem.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"

namespace gonio::explain::domains {

const Domain& images() {
  static const Domain domain{.name = "images",
                             .sentence = "linear images with file and camera, of objects that render can simulate",
                             .order = 2,
                             .applies = explain::images::has_recordings,
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
                                   const auto add = [&](const std::string& id, const std::string& pointer) {
                                     if (!id.empty()) files.push_back(manifest::resolve(document, id, pointer));
                                   };
                                   for (std::size_t i = 0; i < document.images.size(); ++i) {
                                     add(document.images[i].file, "/images/" + std::to_string(i) + "/file");
                                     add(document.images[i].mask, "/images/" + std::to_string(i) + "/mask");
                                   }
                                   for (const auto& [name, mesh] : document.meshes)
                                     add(mesh.file, "/meshes/" + name + "/file");
                                   return files;
                                 }};
  return domain;
}

}  // namespace gonio::explain::domains
