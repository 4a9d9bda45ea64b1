// The built-in data matrix of ridges (render/specimen_matrix.h).
#include "render/specimen_matrix.h"

#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "base/atomic_file.h"
#include "base/random.h"
#include "camera/intrinsics.h"
#include "geom/angle.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/pattern.h"
#include "manifest/sections/surface.h"
#include "render/specimen_camera.h"

namespace gonio::render {
namespace {

constexpr int side = 12;
constexpr std::array<std::string_view, side> modules{                 // ISO/IEC 16022, "GONIO"
                                                     "#.#.#.#.#.#.",  //
                                                     "#.####..#.##",  //
                                                     "#.#..#.#....",  //
                                                     "#....#.#...#",  //
                                                     "####...###..",  //
                                                     "#.#.#.#.#..#",  //
                                                     "#.####..#...",  //
                                                     "#..#.####..#",  //
                                                     "##.#...##.#.",  //
                                                     "#.#.#.##.#.#",  //
                                                     "#..#.#.#..#.",  //
                                                     "############"};
constexpr std::size_t worn = 4 * side + 8, scratched = 7 * side + 3;

constexpr double cell_m = 0.001, apart_m = 0.2, distance_m = 0.3;
constexpr double ridge_rad = 5 * degree, alpha = 0.2, spread = 0.02, quarter_rad = -90 * degree;
constexpr double robot_m = 5e-5, robot_rad = 1e-4;

// x along the columns, y up the rows, z the normal; the pattern's middle is the origin.
io::TriangleMesh plate() {
  io::TriangleMesh mesh;
  for (int cell = 0; cell < side * side; ++cell) {
    const double x = (cell % side - side / 2) * cell_m, y = (side / 2 - cell / side) * cell_m;
    const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
    for (const Vec2 d : {Vec2{0, 0}, Vec2{cell_m, 0}, Vec2{cell_m, -cell_m}, Vec2{0, -cell_m}})
      mesh.positions_m.push_back({x + d.x, y + d.y, 0});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    mesh.labels.insert(mesh.labels.end(), 2, cell);
  }
  return mesh;
}

manifest::Surface ridges() {
  manifest::Surface surface;
  surface.model = "ridged";
  surface.parameters = {{"ridge_rad", ridge_rad}};
  Random random(16022);
  for (std::size_t cell = 0; cell < side * side; ++cell) {
    const bool bit = modules[cell / side][cell % side] == '#';
    double azimuth_rad = (bit ? 0 : pi / 2) + spread * random.normal();
    double along = alpha * (1 + spread * random.normal()), across = alpha * (1 + spread * random.normal());
    if (cell == worn) along = across = 0.35;
    if (cell == scratched) azimuth_rad += 35 * degree;
    const std::string label = std::to_string(cell);
    surface.labels["azimuth_rad"][label] = azimuth_rad;
    surface.labels["alpha_u"][label] = along;
    surface.labels["alpha_v"][label] = across;
  }
  return surface;
}

// Tilted in the plane y = 0 about the plate's middle; the world's y is up in the picture.
Rigid<frame::World, frame::Camera> tilted(double tilt_rad, Vec3 middle_m) {
  const Quaternion down{0, 1, 0, 0};  // camera z to world -z, camera y to world -y
  const Quaternion rotation = normalized(quaternion_of_rotation_vector({0, tilt_rad, 0}) * down);
  return {rotation, middle_m - matrix_of(rotation) * Vec3{0, 0, distance_m}};
}

// What lies at `middle_m`, turned about its normal, and its photographs.
void add_placement(manifest::Document& document, const std::string& name, double turn_rad, Vec3 middle_m) {
  manifest::Object object{.id = name, .mesh = "plate", .surface = "plate", .world_from_object = {}};
  const Rigid<frame::World, frame::Object> placed{quaternion_of_rotation_vector({0, 0, turn_rad}), middle_m};
  static_cast<Rigid<frame::World, frame::Object>&>(object.world_from_object.emplace()) = placed;
  document.objects.push_back(object);
  const Rigid<frame::Object, frame::Object> plate_from_pattern{quaternion_of_rotation_vector({pi, 0, 0}),
                                                               {-side / 2 * cell_m, side / 2 * cell_m, 0}};
  manifest::PatternPlacement& placement = document.patterns["sample"].placements.emplace_back();
  placement.name = name;
  static_cast<Rigid<frame::World, frame::Object>&>(placement.world_from_pattern.emplace()) =
      placed * plate_from_pattern;
  for (int k = -2; k <= 2; ++k) {
    const auto pose = tilted(k * 10 * degree, middle_m);
    add_view(document, {.id = name + "-" + std::to_string(k + 2),
                        .world_from_camera = {pose, manifest::PoseSigma{{robot_rad}, {robot_m}}},
                        .group = name});
  }
}

}  // namespace

manifest::Document matrix_specimen(const std::filesystem::path& out) {
  manifest::Document document;
  make_folder(out);
  io::write_ply(out / "plate.ply", plate());
  document.meshes["plate"].file = manifest::add_file(document, out / "plate.ply", "plate");
  document.surfaces["plate"] = ridges();
  manifest::Light& lamp = document.lights["lamp"];
  lamp.model = "directional";
  lamp.parameters = {{"towards", std::vector<double>{0.04, 0.17, 0.98}}, {"watt_per_m2", 4.0}};
  camera::enter_pinhole(document, "camera", 150, 150, 2400);
  manifest::Pattern& pattern = document.patterns["sample"];
  pattern.kind = "data-matrix";
  pattern.rows = pattern.columns = side;
  pattern.cell_m = {cell_m};
  add_placement(document, "before", 0, {});
  add_placement(document, "after", quarter_rad, {apart_m, 0, 0});
  return document;
}

}  // namespace gonio::render
