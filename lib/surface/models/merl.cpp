// A measured isotropic BRDF from a table in the format of the MERL database (io/merl.h), times `scale`.
//   f = scale T(theta_h, theta_d, phi_d)    Rusinkiewicz 1998; Matusik et al. 2003
// Interpolation, sampling and reflectance: surface/merl_table.h. Reciprocal; energy is the measurement's.
#include "base/error.h"
#include "surface/merl_table.h"
#include "surface/surface.h"

namespace gonio::surface {
namespace {

const MeasuredTable& table_of(const Values& values) {
  return static_cast<const MeasuredTable&>(*values.prepared);
}

class Merl final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::surface,
        .id = "merl",
        .sentence = "A measured isotropic material from a table in MERL format.",
        .source = "Matusik et al. 2003; Rusinkiewicz 1998",
        .parameters = {{.name = "scale",
                        .unit = "1",
                        .components = 3,
                        .rgb = true,
                        .preset = 1,
                        .lower = 0,
                        .upper = 1,
                        .meaning = "factor on the table's red, green and blue"}},
        .attachment = manifest::Attachment::table,
        .attachment_meaning = "the measured table, a .binary file of the MERL database's format",
    };
    return info;
  }

  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override {
    return values.rgb(0) * table_of(values).evaluate(wo, wi);
  }
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override {
    if (wo.z <= 0) return {};
    const auto [wi, density] = table_of(values).sample(wo, u, u_lobe);
    if (!(density > 0)) return {};
    return {wi, evaluate(values, wo, wi) * (wi.z / density), density};
  }
  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override { return table_of(values).pdf(wo, wi); }
  Rgb albedo(const Values& values, Vec3 wo) const override { return values.rgb(0) * table_of(values).albedo(wo); }

  std::shared_ptr<const Prepared> prepare(const Values&, const std::filesystem::path& file,
                                          const std::string& place) const override {
    if (file.empty())
      throw Error(Exit::data, place, "model \"merl\" needs a table", "name a file in MERL format as `file`");
    return measured_table(file);
  }
};

}  // namespace

const Model& merl() {
  static const Merl model;
  return model;
}

}  // namespace gonio::surface
