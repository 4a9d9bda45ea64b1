#include "explain/explanation.h"
#include "explain/images/images_problem.h"
namespace gonio::explain::images {
Illustration ImagesProblem::illustrate(const Explanation&, const std::filesystem::path&, manifest::Document&) const { return {}; }
}
