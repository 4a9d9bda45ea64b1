// Tables of observations that a registered model predicts: grey levels, irradiance, transmittance, reflectance, tracks,
// and whatever an expression describes.
#include "explain/domain.h"
#include "explain/tables/tables_problem.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"

namespace gonio::explain::domains {

const Domain& tables() {
  static const Domain domain{
      .name = "tables",
      .sentence = "tables whose model predicts them (sensor, light, volume, surface, tracks, markers, temperature, expression)",
      .order = 4,
      .applies = explain::tables::has_tables,
      .problems = explain::tables::table_problems,
      .files = [](const manifest::Document& document) {
        std::vector<std::filesystem::path> files;
        for (const auto& [name, table] : document.tables)
          if (explain::tables::find_model(table.model) != nullptr && !table.file.empty())
            files.push_back(manifest::resolve(document, table.file, "/tables/" + name + "/file"));
        return files;
      }};
  return domain;
}

}  // namespace gonio::explain::domains
