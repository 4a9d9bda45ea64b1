// The lamp that `point` and `sphere` share: a sphere of uniform radiance whose intensity on axis is I, or at radius 0 a
// point.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "light/light.h"

namespace gonio::light {

std::unique_ptr<Emitter> sphere_emitter(Vec3 position_m, Rgb watt_per_sr, double radius_m);

// A model with the parameters position_m, watt_per_sr and radius_m, which may have a preset.
class SphereLamp : public Model {
 public:
  SphereLamp(std::string id, std::string sentence, std::string source, std::string position_meaning,
             std::optional<double> radius_preset, std::string radius_meaning);
  const manifest::ModelInfo& info() const final { return info_; }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment& file,
                                   const std::string& place) const final;

 private:
  manifest::ModelInfo info_;
};

}  // namespace gonio::light
