// Solid bodies of revolution: knobs, chessmen, candlesticks, stoppers.
#include <cmath>

#include "glass/form.h"
#include "glass/turned_curve.h"
#include "mesh/revolve.h"

namespace gonio::glass {
namespace {

class Lathe final : public Form {
 public:
  const char* id() const override { return "lathe"; }
  const char* sentence() const override { return "solid bodies of revolution: knobs, stoppers, chessmen"; }
  Body made(Random& random) const override {
    const int knots = 4 + static_cast<int>(random.below(5));
    std::vector<Vec2> turned;
    for (int i = 0; i < knots; ++i) {
      const double off = i == 0 || i + 1 == knots ? 0 : random.uniform(-0.3, 0.3);
      turned.push_back({(i + off) / (knots - 1), random.uniform(0.12, 0.45)});
    }
    const TurnedCurve radius(turned);
    // A flat foot, a round edge above it, and a dome that closes the top as an ellipse does.
    const double foot = 0.03, dome = random.uniform(0.08, 0.3);
    const auto rounded = [&](double z) {
      const double below = z < foot ? 1 - (1 - z / foot) * (1 - z / foot) : 1;
      const double above = z > 1 - dome ? 1 - std::pow((z - 1 + dome) / dome, 2) : 1;
      return radius(z) * (0.85 + 0.15 * std::sqrt(std::max(0.0, below))) * std::sqrt(std::max(0.0, above));
    };
    constexpr int steps = 96, sectors = 96;
    std::vector<Vec2> places;
    for (int i = 1; i < 6; ++i) places.push_back({rounded(0) * i / 6, 0});
    for (int i = 0; i < steps; ++i) {
      // Nearer together towards the top, where the dome turns.
      const double t = static_cast<double>(i) / steps,
                   z = t < 1 - dome ? t : 1 - dome + dome * std::sin((t - 1 + dome) / dome * pi / 2);
      places.push_back({rounded(std::min(z, 1.0)), z});
    }
    Body body;
    body.mesh = mesh::revolved(mesh::profile_through(places), sectors);
    return body;
  }
};

}  // namespace

namespace forms {
const Form& lathe() {
  static const Lathe form;
  return form;
}
}  // namespace forms

}  // namespace gonio::glass
