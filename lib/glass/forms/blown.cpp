// Blown forms: closed hollow bodies, star-shaped about their middle, dented and bulged by a few long waves; the wall's
// thickness varies with the direction.
#include <algorithm>
#include <array>
#include <cmath>

#include "glass/any_direction.h"
#include "glass/form.h"
#include "mesh/mesh.h"

namespace gonio::glass {
namespace {

// A smooth function on the sphere: waves of space, read on it. Between -1 and 1.
class Waves {
 public:
  Waves(Random& random, double slowest, double fastest) {
    for (Wave& w : waves_) {
      const Vec3 direction = any_direction(random);  // one draw a statement: operands have no order
      w.k = direction * random.uniform(slowest, fastest);
      w.phase = random.uniform(0, 2 * pi), w.share = random.uniform(0.2, 1);
      sum_ += w.share;
    }
  }
  double operator()(Vec3 d) const {
    double sum = 0;
    for (const Wave& w : waves_) sum += w.share * std::cos(dot(w.k, d) + w.phase);
    return sum / sum_;
  }

 private:
  struct Wave {
    Vec3 k;
    double phase, share;
  };
  std::array<Wave, 5> waves_{};
  double sum_ = 0;
};

// The surface radius(direction) * direction, seen from outside.
template <class Radius>
io::TriangleMesh star(const Radius& radius) {
  constexpr std::uint32_t around = 96, down = 48;
  io::TriangleMesh mesh;
  const auto place = [&](double theta, double phi) {
    const Vec3 d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    return radius(d);
  };
  mesh.positions_m.push_back(place(0, 0));
  for (std::uint32_t j = 1; j < down; ++j)
    for (std::uint32_t i = 0; i < around; ++i) mesh.positions_m.push_back(place(pi * j / down, 2 * pi * i / around));
  mesh.positions_m.push_back(place(pi, 0));
  const auto at = [&](std::uint32_t j, std::uint32_t i) { return 1 + (j - 1) * around + i % around; };
  const auto last = static_cast<std::uint32_t>(mesh.positions_m.size() - 1);
  for (std::uint32_t i = 0; i < around; ++i) {
    mesh.triangles.push_back({0, at(1, i), at(1, i + 1)});
    for (std::uint32_t j = 1; j + 1 < down; ++j) {
      mesh.triangles.push_back({at(j, i), at(j + 1, i), at(j + 1, i + 1)});
      mesh.triangles.push_back({at(j, i), at(j + 1, i + 1), at(j, i + 1)});
    }
    mesh.triangles.push_back({last, at(down - 1, i + 1), at(down - 1, i)});
  }
  mesh.normals = mesh::averaged_normals(mesh.positions_m, mesh.triangles);
  return mesh;
}

class Blown final : public Form {
 public:
  const char* id() const override { return "blown"; }
  const char* sentence() const override {
    return "closed hollow bodies, bulged and dented, with walls of varying thickness";
  }
  Body made(Random& random) const override {
    const Vec3 axes{random.uniform(0.3, 0.5), random.uniform(0.3, 0.5), random.uniform(0.35, 0.5)};
    const Waves shape(random, 1, 5), thickness(random, 1, 4);
    const double bulges = random.uniform(0.05, 0.3), thin = random.uniform(0.03, 0.1), thick = random.uniform(0.1, 0.4);
    const auto outer = [&](Vec3 d) { return axes * d * (1 + bulges * shape(d)); };
    const auto wall = [&](Vec3 d) {
      return thin + (thick - thin) * (0.5 + 0.5 * thickness(d));
    };  // share of the radius
    Body body;
    body.mesh = star(outer);
    const io::TriangleMesh inside = star([&](Vec3 d) { return outer(d) * (1 - wall(d)); });
    const auto first = static_cast<std::uint32_t>(body.mesh.positions_m.size());
    for (std::size_t i = 0; i < inside.positions_m.size(); ++i) {
      body.mesh.positions_m.push_back(inside.positions_m[i]);
      body.mesh.normals.push_back(-inside.normals[i]);
      const double here = norm(body.mesh.positions_m[i] - inside.positions_m[i]);  // along the radius
      body.wall_low = i == 0 ? here : std::min(body.wall_low, here), body.wall_high = std::max(body.wall_high, here);
    }
    for (const auto& [a, b, c] : inside.triangles) body.mesh.triangles.push_back({first + a, first + c, first + b});
    return body;
  }
};

}  // namespace

namespace forms {
const Form& blown() {
  static const Blown form;
  return form;
}
}  // namespace forms

}  // namespace gonio::glass
