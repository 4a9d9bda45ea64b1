// Blocks, cylinders and balls joined and cut by each other (constructive solid geometry): edges, flat faces, bores.
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "glass/form.h"
#include "glass/implicit.h"

namespace gonio::glass {
namespace {

class Solid final : public Form {
 public:
  const char* id() const override { return "solid"; }
  const char* sentence() const override {
    return "blocks, cylinders and balls joined and cut by each other, with bores";
  }
  Body made(Random& random) const override {
    struct Part {
      std::function<double(Vec3)> distance;
      bool cut;
    };
    static constexpr Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    std::vector<Part> parts;
    const auto somewhere = [&](double reach) {
      return Vec3{random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
    };
    const auto piece = [&](Vec3 at, double least, double most) -> std::function<double(Vec3)> {
      const Vec3 half{random.uniform(least, most), random.uniform(least, most), random.uniform(least, most)};
      const Vec3 axis = axes[random.below(3)];
      switch (random.below(3)) {
        case 0: return [=](Vec3 p) { return distance_to_box(p - at, half, 0.01); };
        case 1: return [=](Vec3 p) { return distance_to_cylinder(p - at, axis, half.x, half.y); };
        default: return [=](Vec3 p) { return norm(p - at) - half.x; };
      }
    };
    parts.push_back({piece({}, 0.2, 0.4), false});
    for (std::uint32_t i = random.below(3); i > 0; --i) parts.push_back({piece(somewhere(0.2), 0.1, 0.25), false});
    for (std::uint32_t i = random.below(3); i > 0; --i) parts.push_back({piece(somewhere(0.35), 0.08, 0.2), true});
    for (std::uint32_t i = random.below(4); i > 0; --i) {  // bores right through
      const Vec3 at = somewhere(0.15), axis = axes[random.below(3)];
      const double radius = random.uniform(0.04, 0.08);
      parts.push_back({[=](Vec3 p) { return distance_to_cylinder(p - at, axis, radius, 2); }, true});
    }
    Body body;
    body.mesh = body_of(
        [&](Vec3 p) {
          double d = parts.front().distance(p);
          for (std::size_t i = 1; i < parts.size(); ++i) {
            const double other = parts[i].distance(p);
            d = parts[i].cut ? std::max(d, -other) : std::min(d, other);
          }
          return -d;
        },
        0.64, 80, 20000, false);
    return body;
  }
};

}  // namespace

namespace forms {
const Form& solid() {
  static const Solid form;
  return form;
}
}  // namespace forms

}  // namespace gonio::glass
