// See broken_world.h.
#include "alignment/broken_world.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonio::alignment::testing {
namespace {

// The places of the rim of the object, px, against the ground and its shadow.
std::vector<Vec2> rim_of(const Labels& labels, int n) {
  std::vector<Vec2> rim;
  const auto is = [&](int x, int y) { return labels.of[static_cast<std::size_t>(y * n + x)] == object; };
  for (int y = 1; y < n - 1; ++y)
    for (int x = 1; x < n - 1; ++x)
      if (is(x, y) && !(is(x + 1, y) && is(x - 1, y) && is(x, y + 1) && is(x, y - 1)))
        rim.push_back({1.0 * x, 1.0 * y});
  return rim;
}

Vec2 any_way(std::mt19937_64& random) {
  const double angle = std::uniform_real_distribution<double>(0, 2 * pi)(random);
  return {std::cos(angle), std::sin(angle)};
}

// Beyond a straight line there is no object any more.
void take_piece(Labels& labels, int n, std::mt19937_64& random) {
  const Vec2 way = any_way(random);
  const double share = std::uniform_real_distribution<double>(0.15, 0.30)(random);
  std::vector<double> along;
  for (const Vec2 p : rim_of(labels, n)) along.push_back(dot(p, way));
  if (along.empty()) return;
  const auto at = along.begin() + static_cast<std::ptrdiff_t>((1 - share) * static_cast<double>(along.size()));
  std::nth_element(along.begin(), at, along.end());
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      std::uint8_t& label = labels.of[static_cast<std::size_t>(y * n + x)];
      if (label == object && dot(Vec2{1.0 * x, 1.0 * y}, way) > *at) label = ground;
    }
}

// A disc of a sixth to a third of its extent about a place of its rim.
void add_disc(Labels& labels, int n, std::mt19937_64& random) {
  const std::vector<Vec2> rim = rim_of(labels, n);
  if (rim.empty()) return;
  Vec2 low = rim.front(), high = low;
  for (const Vec2 p : rim)
    low = {std::min(low.x, p.x), std::min(low.y, p.y)}, high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  const double radius = std::uniform_real_distribution<double>(1.0 / 6, 1.0 / 3)(random) * 0.5 * norm(high - low);
  const Vec2 middle = rim[random() % rim.size()];
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      if (norm(Vec2{1.0 * x, 1.0 * y} - middle) < radius) labels.of[static_cast<std::size_t>(y * n + x)] = object;
}

// About its middle, so that what is where it is, is there all the same.
void reshape(World& world, const Solid& solid, Vec3 factor) {
  const Vec3 middle = Shape(solid.positions_m, solid.triangles).centre_m();
  std::vector<Vec3> positions = solid.positions_m;
  for (Vec3& p : positions) p = middle + factor * (p - middle);
  world.input.shapes.back() = Shape(std::move(positions), solid.triangles);
}

void state(World& world) {  // the question begins where the input does
  world.input.question.stated = world.input.stated;
}

void exchange_views(World& world) {
  auto& sightings = world.input.question.sightings;
  auto& rims = world.input.rims;
  for (std::size_t i = 0; i < sightings.size(); ++i)
    for (std::size_t k = 0; k < sightings.size(); ++k) {
      const RimSubject &a = sightings[i].subject, &b = sightings[k].subject;
      if (a.station != 0 || b.station != 1 || a.lamp != b.lamp) continue;
      std::swap(sightings[i].points, sightings[k].points), std::swap(sightings[i].unseen, sightings[k].unseen);
      std::swap(rims[i], rims[k]);
    }
}

void break_setting(World& world, Breakage breakage, std::size_t solid, std::mt19937_64& random) {
  const auto between = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  Setting& stated = world.input.stated;
  if (breakage == Breakage::size) {
    const double factor = between(1.02, 1.10);
    reshape(world, solids()[solid], {factor, factor, factor});
  }
  if (breakage == Breakage::stretch) {
    std::array<double, 3> factor{1, 1, 1};
    factor[random() % 3] = between(1.03, 1.10);
    reshape(world, solids()[solid], {factor[0], factor[1], factor[2]});
  }
  if (breakage == Breakage::focal) {
    Lens& lens = stated.lenses[0];
    lens.fx_px *= 1.03, lens.fy_px *= 1.03;
    const camera::CameraModel& model = world.input.models[0];
    world.input.models[0] = camera::CameraModel(camera::Intrinsics{lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, {}},
                                                model.width_px(), model.height_px());
  }
  if (breakage == Breakage::lamp) {
    stated.lamps_m = world.truth.lamps_m;
    for (Vec3& lamp : stated.lamps_m) lamp.z *= 1.05;
    std::erase_if(world.input.question.freedoms, [](const Freedom& f) { return f.block == Block::lamp_shift; });
  }
  if (breakage == Breakage::ground) stated.ground->offset_m += 0.005;
  if (breakage == Breakage::other) reshape(world, solids()[3 + (solid + 1) % 5], {1, 1, 1});
  if (breakage == Breakage::exchanged) exchange_views(world);
  if (breakage == Breakage::start) {
    std::normal_distribution<double> normal;
    const Vec3 axis = normalized(Vec3{normal(random), normal(random), normal(random)});
    auto& pose = stated.bodies[0].world_from_object;
    const Vec3 middle = stated.bodies[0].centre_m();
    pose.rotation = normalized(quaternion_of_rotation_vector(axis * (2 * pi / 3)) * pose.rotation);
    pose.translation_m += middle - stated.bodies[0].centre_m();
  }
  state(world);
}

}  // namespace

const std::vector<Breakage>& breakages() {
  static const std::vector<Breakage> all{Breakage::size,      Breakage::stretch, Breakage::focal,  Breakage::missing,
                                         Breakage::foreign,   Breakage::lamp,    Breakage::ground, Breakage::other,
                                         Breakage::exchanged, Breakage::start};
  return all;
}

std::string name_of(Breakage breakage) {
  switch (breakage) {
    case Breakage::size: return "mesh 2 to 10 % too large";
    case Breakage::stretch: return "mesh 3 to 10 % too long along one axis";
    case Breakage::focal: return "focal length 3 % too long";
    case Breakage::missing: return "a piece of one mask missing";
    case Breakage::foreign: return "something joined to one mask";
    case Breakage::lamp: return "lamps held 5 % too high";
    case Breakage::ground: return "ground 5 mm too high";
    case Breakage::other: return "another mesh";
    case Breakage::exchanged: return "two views' masks exchanged";
    default: return "from 120 degrees off";
  }
}

World broken_world(Breakage breakage, std::size_t number, std::uint64_t seed) {
  constexpr std::array<std::size_t, 6> plain{0, 3, 4, 5, 6, 7};  // of solids()
  const std::size_t solid = plain[number % plain.size()];
  std::mt19937_64 random(seed + 77);
  WorldWish wish{.solid = solid,
                 .views = 1 + static_cast<int>(number / 2 % 4),
                 .lamps = 1 + static_cast<int>(number / 3 % 3),
                 .seed = seed};
  if (breakage == Breakage::exchanged) wish.views = std::max(wish.views, 2);
  if (breakage == Breakage::missing || breakage == Breakage::foreign)
    wish.spoil = [&, n = wish.size_px](Labels& labels, std::size_t station, std::mt19937_64& of_masks) {
      if (station == 0) (breakage == Breakage::missing ? take_piece : add_disc)(labels, n, of_masks);
    };
  World world = world_of(wish);
  break_setting(world, breakage, solid, random);
  return world;
}

}  // namespace gonio::alignment::testing
