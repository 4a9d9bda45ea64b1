// The user's own formula (base/expression.h) over u_m, v_m along the surface and x_m, y_m, z_m on the platform; what
// leaves 0 to 1 is cut.
#include "base/expression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "relief/microstructure.h"

namespace gonio::relief {
namespace {

class OwnStructure final : public Microstructure {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{.family = manifest::Family::microstructure,
                                          .id = "expression",
                                          .sentence = "A formula over places, 0 to 1: its `expression`.",
                                          .source = "",
                                          .parameters = {},
                                          .takes_expression = true};
    return info;
  }
  ShareAt made(std::span<const double>, double, const MicrostructureFiles& files,
               const std::string& place) const override {
    const std::string at = place + "/expression";
    if (files.expression.empty())
      throw Error(Exit::data, at, "is missing", "write a formula: 0.5+0.5*sin(2*pi*u_m/1e-4)");
    const auto formula = std::make_shared<const Expression>(files.expression, at);
    static constexpr std::array<const char*, 5> names{"u_m", "v_m", "x_m", "y_m", "z_m"};
    std::vector<std::size_t> used;
    for (const std::string& name : formula->names()) {
      const auto found = std::ranges::find(names, name);
      if (found == names.end())
        throw Error(Exit::data, at, "names \"" + name + "\"", "known are u_m, v_m, x_m, y_m, z_m and pi");
      used.push_back(static_cast<std::size_t>(found - names.begin()));
    }
    return [formula, used, at](const SurfacePlace& p) {
      const std::array<double, 5> all{p.along_m.x, p.along_m.y, p.body_m.x, p.body_m.y, p.body_m.z};
      std::array<const double*, 5> columns{};
      std::array<double, 5> constants{};
      for (std::size_t k = 0; k < used.size(); ++k) constants[k] = all[used[k]];
      double value = 0;
      formula->evaluate(std::span(columns).first(used.size()), std::span(constants).first(used.size()), 0, {&value, 1});
      if (!std::isfinite(value))
        throw Error(Exit::data, at, "is no number at a place of the surface", "mend the formula");
      return std::clamp(value, 0.0, 1.0);
    };
  }
};

}  // namespace

namespace microstructures {
const Microstructure& expression() {
  static const OwnStructure structure;
  return structure;
}
}  // namespace microstructures

}  // namespace gonio::relief
