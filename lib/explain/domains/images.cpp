// Linear images of a scene whose geometry is known.
#include "explain/domain.h"
#include "explain/images/images_problem.h"
#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/mesh.h"

namespace gonio::explain::domains {

const Domain& images() {
  static const Domain domain{
      .name = "images",
      .sentence = "linear images with file and camera, of objects that render can simulate",
      .order = 2,
      .after = "boards",
      .needs_it = true,
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
            const std::size_t images = names_in(document, "images").size();
            for (std::size_t i = 0; i < images; ++i)
              for (auto& file : manifest::files_of_image(document, i)) files.push_back(file);
            for (const auto& [name, mesh] : document.meshes)
              if (!mesh.file.empty())
                files.push_back(manifest::resolve(document, mesh.file, "/meshes/" + name + "/file"));
            return files;
          }};
  return domain;
}

}  // namespace gonio::explain::domains
