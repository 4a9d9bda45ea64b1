// Balls, rods and rings that flow into each other: genus 0 to many.
#include <cmath>
#include <functional>
#include <vector>

#include "glass/any_direction.h"
#include "glass/form.h"
#include "glass/implicit.h"

namespace gonio::glass {
namespace {

class Blend final : public Form {
 public:
  const char* id() const override { return "blend"; }
  const char* sentence() const override { return "balls, rods and rings that flow into each other, with many holes"; }
  Body made(Random& random) const override {
    std::vector<std::function<double(Vec3)>> parts;
    const int count = 3 + static_cast<int>(random.below(6));
    Vec3 last{};
    for (int i = 0; i < count; ++i) {
      const Vec3 aside = any_direction(random);
      const Vec3 at = i == 0 ? Vec3{} : aside * random.uniform(0.1, 0.27);
      const double size = random.uniform(0.08, 0.16);
      parts.push_back([=](Vec3 p) { return norm(p - at) - size; });
      if (i > 0) {  // hangs together
        const double thick = random.uniform(0.03, 0.07);
        parts.push_back([=](Vec3 p) { return distance_to_capsule(p, last, at, thick); });
      }
      if (random.uniform() < 0.6) {
        const Vec3 axis = any_direction(random);
        const double ring = random.uniform(0.1, 0.2), tube = random.uniform(0.03, 0.06);
        parts.push_back([=](Vec3 p) { return distance_to_torus(p - at, axis, ring, tube); });
      }
      last = at;
    }
    const double width = random.uniform(0.03, 0.12);
    Body body;
    body.mesh = body_of(
        [&](Vec3 p) {
          double d = parts.front()(p);
          for (std::size_t i = 1; i < parts.size(); ++i) d = blended(d, parts[i](p), width);
          return -d;
        },
        0.62, 72, 16000, true);
    return body;
  }
};

}  // namespace

namespace forms {
const Form& blend() {
  static const Blend form;
  return form;
}
}  // namespace forms

}  // namespace gonio::glass
