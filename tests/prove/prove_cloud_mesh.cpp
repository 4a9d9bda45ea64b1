// Meshes from twelve simulated views of a camera and a projector: the bunny, and a folded cloth close before a
// backdrop. What the mesh states of its error against its distance from the truth, and what grew together; the thesis's
// chain beside ours.
//   prove-cloud-mesh BUNNY.obj   prints one claim a line
#include <cmath>
#include <cstdio>

#include "base/text.h"
#include "mesh/adjacency.h"
#include "mesh/obj_file.h"
#include "mesh/seen_world.h"

namespace {

using namespace gonio;
using tests::read_obj;
using tests::SeenFrom;

constexpr double touch_m = 1e-3;  // a part that comes as near as this to both things has joined them

struct World {
  const char* name;
  std::vector<io::TriangleMesh> things;  // each in one piece
  std::vector<SeenFrom> views;
};

template <class Position>
io::TriangleMesh sheet(int across, int down, const Position& position) {
  io::TriangleMesh mesh;
  for (int j = 0; j <= down; ++j)
    for (int i = 0; i <= across; ++i) mesh.positions_m.push_back(position(double(i) / across, double(j) / down));
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (across + 1) + i), b = a + 1,
                 c = a + static_cast<std::uint32_t>(across) + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

// Folds 6 cm apart that lean over, 5 mm before the backdrop where they are lowest.
World cloth_world() {
  constexpr double k = 2 * pi / 0.06, deep = 0.014, lean = 0.011, gap = 0.005;
  World w{.name = "cloth", .things = {}, .views = {}};
  w.things.push_back(sheet(480, 240, [](double u, double v) {
    const double x = 0.24 * (u - 0.5), y = 0.18 * (v - 0.5), phase = k * x + 1.5 * std::sin(20 * y);
    return Vec3{x + lean * std::cos(phase), y, deep * std::sin(phase) + deep + gap};
  }));
  w.things.push_back(sheet(2, 2, [](double u, double v) { return Vec3{0.4 * (u - 0.5), 0.3 * (v - 0.5), 0}; }));
  for (int i = 0; i < 12; ++i) {
    const double azimuth = 2 * pi * i / 6 + (i < 6 ? 0 : 0.5), tilt = i < 6 ? 0.35 : 0.8;
    w.views.push_back(
        {.camera = Vec3{std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt)} * 0.6});
  }
  return w;
}

World bunny_world(const char* path) {
  World w{.name = "bunny", .things = {read_obj(path)}, .views = {}};
  Vec3 low{1, 1, 1}, high{-1, -1, -1};
  for (const Vec3 p : w.things[0].positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 middle = 0.5 * (low + high);
  for (int i = 0; i < 12; ++i) {  // a spiral over the sphere, all sides of it
    const double z = 1 - (2 * i + 1) / 12.0, azimuth = 2.399963 * i, r = std::sqrt(1 - z * z);
    w.views.push_back({.camera = middle + Vec3{r * std::cos(azimuth), z, r * std::sin(azimuth)} * 0.5,
                       .target = middle,
                       .width = 240,
                       .height = 240,
                       .f_px = 600});
  }
  return w;
}

struct Judged {
  double rms_m = 0, stated_m = 0, vertices = 0;
  std::vector<std::size_t> parts_of;  // by thing: parts that touch it
  std::size_t bridges = 0;            // parts that touch more than one
};

std::vector<std::uint32_t> parts_of(const io::TriangleMesh& mesh) {
  std::vector<std::uint32_t> part(mesh.positions_m.size());
  for (std::uint32_t v = 0; v < part.size(); ++v) part[v] = v;
  const auto root = [&](std::uint32_t v) {
    while (part[v] != v) v = part[v] = part[part[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (int k = 1; k < 3; ++k) part[root(t[k])] = root(t[0]);
  for (std::uint32_t v = 0; v < part.size(); ++v) part[v] = root(v);
  return part;
}

// Distances along the truth's normal; what lies beside its rim has none.
Judged judge(const World& world, const mesh::Reconstruction& made) {
  Judged j;
  j.parts_of.assign(world.things.size(), 0);
  std::vector<std::vector<char>> rims;
  std::vector<mesh::TriangleTree> trees;
  trees.reserve(world.things.size());
  for (const auto& thing : world.things)
    rims.push_back(mesh::rim_vertices(thing.triangles, thing.positions_m.size())),
        trees.emplace_back(thing.positions_m, thing.triangles);
  const std::vector<std::uint32_t> part = parts_of(made.mesh);
  std::vector<unsigned> touched(part.size(), 0);
  double squares = 0, stated = 0;
  for (std::size_t v = 0; v < part.size(); ++v) {
    const Vec3 p = made.mesh.positions_m[v];
    mesh::TriangleTree::Nearest best;
    std::size_t nearest = 0;
    for (std::size_t k = 0; k < trees.size(); ++k) {
      const auto foot = trees[k].nearest(p);
      if (foot.distance_m < touch_m) touched[part[v]] |= 1u << k;
      if (foot.distance_m < best.distance_m) best = foot, nearest = k;
    }
    const auto& t = world.things[nearest].triangles[best.triangle];
    bool beside = false;
    for (int k = 0; k < 3; ++k) beside = beside || (best.at.weights[k] > 0 && rims[nearest][t[k]] != 0);
    if (beside) continue;
    squares += best.distance_m * best.distance_m, stated += double(made.sigma_m[v]) * made.sigma_m[v], ++j.vertices;
  }
  j.rms_m = std::sqrt(squares / j.vertices), j.stated_m = std::sqrt(stated / j.vertices);
  for (const unsigned t : touched) {
    for (std::size_t k = 0; k < trees.size(); ++k) j.parts_of[k] += (t >> k) & 1u;
    j.bridges += (t & (t - 1)) != 0;
  }
  return j;
}

void prove(const World& world, std::uint64_t seed) {
  io::TriangleMesh truth;
  for (const auto& thing : world.things) {
    const auto first = static_cast<std::uint32_t>(truth.positions_m.size());
    truth.positions_m.insert(truth.positions_m.end(), thing.positions_m.begin(), thing.positions_m.end());
    for (const auto& t : thing.triangles) truth.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  const mesh::TriangleTree tree(truth.positions_m, truth.triangles);
  mesh::MeasuredPoints points;
  for (const SeenFrom& view : world.views) tests::see(tree, truth, view, seed, points);
  for (const mesh::Chain chain : {mesh::Chain::gonio, mesh::Chain::thesis}) {
    const mesh::Reconstruction made = mesh::reconstruct(points, {.chain = chain});
    const Judged j = judge(world, made);
    const bool ours = chain == mesh::Chain::gonio;
    const std::string who = format("cloud-mesh %s, seed %llu, %s", world.name, static_cast<unsigned long long>(seed),
                                   ours ? "gonio" : "thesis's chain");
    std::printf("%s, distance from the truth over what is stated: measured %.3f %s (%.4f mm, %.0f vertices)\n",
                who.c_str(), j.rms_m / j.stated_m, ours ? "required 0.8 to 1.2" : "beside", 1e3 * j.rms_m, j.vertices);
    for (std::size_t k = 0; k < world.things.size(); ++k)
      std::printf("%s, parts of thing %zu: measured %zu %s\n", who.c_str(), k + 1, j.parts_of[k],
                  ours ? "required 1" : "beside");
    if (world.things.size() > 1)
      std::printf("%s, parts that join two things: measured %zu %s\n", who.c_str(), j.bridges,
                  ours ? "required 0" : "beside");
    std::printf(
        "%s: %zu points, %.3f mm apart, whitened %.3f, points off by %.4f mm rms, %zu bare; cut %zu sparse, %zu "
        "seen through, %zu contradicting, of %zu; %zu parts dropped\n",
        who.c_str(), points.positions_m.size(), 1e3 * made.spacing_m, made.deviation.whitened,
        1e3 * made.deviation.rms_m, made.deviation.bare, made.sparse, made.seen_through, made.contradicting,
        made.poisson_vertices, made.dropped_components);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int count, char** words) {
  if (count < 3) return std::fprintf(stderr, "usage: prove-cloud-mesh BUNNY.obj SEED...\n"), 64;
  for (int k = 2; k < count; ++k) {
    const auto seed = static_cast<std::uint64_t>(std::atoi(words[k]));
    prove(cloth_world(), seed);
    prove(bunny_world(words[1]), seed);
  }
  return 0;
}
