// Vessels after profiles: bottles, jars, vases, tumblers and goblets, open above, with a wall whose thickness varies
// with the height and a thick bottom.
#include <cmath>

#include "glass/form.h"
#include "glass/turned_curve.h"
#include "mesh/revolve.h"

namespace gonio::glass {
namespace {

constexpr int sectors = 60;

// Knots (z, r) of the outside.
std::vector<Vec2> outside(Random& random) {
  const double body = random.uniform(0.2, 0.38);
  switch (random.below(4)) {
    case 0: {  // bottle: body, shoulder, neck, lip
      const double shoulder = random.uniform(0.45, 0.7), neck = random.uniform(0.07, 0.12);
      return {{0, body * random.uniform(0.85, 1)},
              {0.08, body},
              {shoulder, body},
              {shoulder + random.uniform(0.1, 0.2), neck},
              {0.94, neck},
              {0.97, neck * 1.2},
              {1, neck * 1.15}};
    }
    case 1:  // vase
      return {{0, body * 0.7},
              {0.3, body * random.uniform(1, 1.3)},
              {0.75, body * random.uniform(0.35, 0.6)},
              {1, body * random.uniform(0.7, 1.1)}};
    case 2:  // tumbler
      return {{0, body * random.uniform(0.75, 0.95)}, {1, body * random.uniform(0.95, 1.15)}};
    default:  // jar
      return {{0, body * 0.9}, {0.1, body}, {0.7, body}, {0.82, body * 0.8}, {1, body * 0.82}};
  }
}

class Vessel {
 public:
  explicit Vessel(Random& random)
      : outer_(outside(random)),
        bottom_(random.uniform(0.03, 0.12)),
        round_(random.uniform(0.05, 0.2)),
        wall_(std::vector<Vec2>{{0, random.uniform(0.015, 0.05)},
                                {random.uniform(0.3, 0.7), random.uniform(0.012, 0.045)},
                                {1, random.uniform(0.012, 0.03)}}) {}
  double outer(double z) const { return outer_(z); }
  // The wall is measured across, not along r; its inside is round above the bottom.
  double inner(double z) const {
    const double slope = outer_.slope(z);
    const double r = std::max(0.3 * outer_(z), outer_(z) - wall_(z) * std::sqrt(1 + slope * slope));
    const double up = (z - bottom_) / round_;
    return up >= 1 ? r : r * std::sqrt(std::max(0.0, 1 - (1 - up) * (1 - up)));
  }
  double bottom() const { return bottom_; }
  double round() const { return round_; }
  double rim_thickness() const { return outer(1) - inner(1); }
  double wall(double z) const { return outer(z) - inner(z); }

 private:
  TurnedCurve outer_;
  double bottom_, round_;
  TurnedCurve wall_;
};

// Heights of the inside from the bottom's middle up to `top`: evenly spread angles where it is round.
std::vector<double> inner_heights(const Vessel& vessel, double top) {
  std::vector<double> all;
  for (int i = 1; i <= 16; ++i) all.push_back(vessel.bottom() + vessel.round() * (1 - std::cos(pi / 2 * i / 16)));
  for (int i = 1; i <= 56; ++i)
    all.push_back(vessel.bottom() + vessel.round() + (top - vessel.bottom() - vessel.round()) * i / 56);
  return all;
}

class Bottle final : public Form {
 public:
  const char* id() const override { return "bottle"; }
  const char* sentence() const override {
    return "vessels after profiles, open above: bottles, jars, vases, tumblers; a liquid can stand in them";
  }
  Body made(Random& random) const override {
    const Vessel vessel(random);
    std::vector<Vec2> places;
    for (int i = 1; i <= 6; ++i) places.push_back({vessel.outer(0) * i / 6, 0});
    for (int i = 1; i <= 72; ++i) places.push_back({vessel.outer(i / 72.0), i / 72.0});
    const double half = vessel.rim_thickness() / 2, middle = vessel.outer(1) - half;
    for (int i = 1; i < 10; ++i)
      places.push_back({middle + half * std::cos(pi * i / 10), 1 + half * std::sin(pi * i / 10)});
    const std::vector<double> inside = inner_heights(vessel, 1);
    for (auto z = inside.rbegin(); z != inside.rend(); ++z) places.push_back({vessel.inner(*z), *z});
    Body body;
    body.mesh = mesh::revolved(mesh::profile_through(places), sectors);
    body.wall_low = 1, body.wall_high = vessel.bottom();
    for (const double z : inside) {
      if (z < vessel.bottom() + vessel.round()) continue;
      body.wall_low = std::min(body.wall_low, vessel.wall(z)),
      body.wall_high = std::max(body.wall_high, vessel.wall(z));
    }
    body.filling = filling(vessel, random.uniform(0.35, 0.9), body.wall_low / 3);
    return body;
  }

 private:
  // Up to the height `level`, `into` deep in the wall.
  static io::TriangleMesh filling(const Vessel& vessel, double level, double into) {
    const double top = vessel.bottom() + vessel.round() + (0.97 - vessel.bottom() - vessel.round()) * level;
    std::vector<Vec2> places;
    for (const double z : inner_heights(vessel, top)) places.push_back({vessel.inner(z) + into, z - into});
    const double edge = places.back().x;
    for (int i = 5; i >= 1; --i) places.push_back({edge * i / 6, places.back().y});
    io::TriangleMesh mesh = mesh::revolved(mesh::profile_through(places), sectors);
    mesh.normals.clear();  // its side is the vessel's, its top is level: a fold between
    return mesh;
  }
};

}  // namespace

namespace forms {
const Form& bottle() {
  static const Bottle form;
  return form;
}
}  // namespace forms

}  // namespace gonio::glass
