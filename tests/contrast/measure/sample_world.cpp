#include "sample_world.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/random.h"
#include "base/text.h"
#include "camera/camera_model.h"
#include "camera/intrinsics.h"
#include "contrast/measure/matrix_code.h"
#include "io/picture.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/pattern.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/table.h"
#include "render/path_tracer.h"
#include "render/ray_caster.h"
#include "render/sensor_chain.h"
#include "scene/scene.h"
#include "surface/surface.h"

namespace gonio::tests {
namespace {

constexpr double ridge_rad = 5 * pi / 180, alpha_u = 0.2, alpha_v = 0.2;
const Vec3 lamp_m{0.02, 0.085, 0.49};
constexpr double lamp_watt_per_sr = 1;

struct CellSurface {
  double azimuth_rad, alpha_u, alpha_v;
};

CellSurface nominal(bool bit) {
  return {bit ? 0 : pi / 2, alpha_u, alpha_v};
}

std::vector<CellSurface> cell_surfaces(const SampleWorld& world) {
  Random random(world.seed, 11);
  std::vector<CellSurface> cells;
  for (std::size_t cell = 0; cell < world.pattern.cells(); ++cell) {
    CellSurface c = nominal(world.pattern.bits[cell]);
    c.azimuth_rad += world.cell_spread * random.normal();
    c.alpha_u *= 1 + world.cell_spread * random.normal();
    c.alpha_v *= 1 + world.cell_spread * random.normal();
    cells.push_back(c);
  }
  for (std::size_t i = 0; i < world.defects.size(); ++i) {
    CellSurface& c = cells[world.defects[i]];
    if (i % 2 == 0)
      c.alpha_u = c.alpha_v = 0.35;  // worn
    else
      c.azimuth_rad += 35 * pi / 180;  // scratched askew
  }
  return cells;
}

// The object's frame: x along the columns, y up the rows, z the normal; the pattern's middle is its origin.
io::TriangleMesh plate(const contrast::CellPattern& pattern) {
  io::TriangleMesh mesh;
  const Vec2 size = pattern.size_m();
  for (std::size_t cell = 0; cell < pattern.cells(); ++cell) {
    const Vec2 m = pattern.middle_m(cell);
    const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
    for (const Vec2 d : {Vec2{-0.5, 0.5}, Vec2{0.5, 0.5}, Vec2{0.5, -0.5}, Vec2{-0.5, -0.5}})
      mesh.positions_m.push_back(
          {m.x + d.x * pattern.cell_m.x - size.x / 2, size.y / 2 - m.y - d.y * pattern.cell_m.y, 0});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    mesh.labels.insert(mesh.labels.end(), 2, static_cast<std::int32_t>(cell));
  }
  return mesh;
}

Rigid<frame::World, frame::Object> world_from_plate(int placement) {
  return {quaternion_of_rotation_vector({0, 0, placement == 0 ? 0 : -pi / 2}), {}};
}
Rigid<frame::World, frame::Object> world_from_pattern(const SampleWorld& world, int placement) {
  const Vec2 size = world.pattern.size_m();
  const Rigid<frame::Object, frame::Object> plate_from_pattern{quaternion_of_rotation_vector({pi, 0, 0}),
                                                               {-size.x / 2, size.y / 2, 0}};
  return world_from_plate(placement) * plate_from_pattern;
}

Rigid<frame::World, frame::Camera> camera_at(const SampleWorld& world, double tilt_rad) {
  const Vec3 at{world.distance_m * std::sin(tilt_rad), 0, world.distance_m * std::cos(tilt_rad)};
  const Vec3 forward = normalized(-at), down{0, -1, 0}, right = cross(down, forward);
  Mat3 rotation;
  for (int axis = 0; axis < 3; ++axis) {
    rotation(axis, 0) = right[axis];
    rotation(axis, 1) = down[axis];
    rotation(axis, 2) = forward[axis];
  }
  return {quaternion_of(rotation), at};
}

manifest::Surface ridged(const std::vector<CellSurface>& cells) {
  manifest::Surface surface;
  surface.model = "ridged";
  surface.parameters = {{"ridge_rad", ridge_rad}};
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    surface.labels["azimuth_rad"][std::to_string(cell)] = cells[cell].azimuth_rad;
    surface.labels["alpha_u"][std::to_string(cell)] = cells[cell].alpha_u;
    surface.labels["alpha_v"][std::to_string(cell)] = cells[cell].alpha_v;
  }
  return surface;
}

manifest::Document base_document(const SampleWorld& world, const std::filesystem::path& folder) {
  manifest::Document document;
  document.folder = folder;
  camera::enter_pinhole(document, "camera", world.side_px, world.side_px, world.focal_px);
  document.lights["lamp"].parameters = {{"position_m", std::vector<double>{lamp_m.x, lamp_m.y, lamp_m.z}},
                                        {"watt_per_sr", lamp_watt_per_sr}};
  io::write_ply(folder / "plate.ply", plate(world.pattern));
  document.meshes["plate"].file = manifest::add_file(document, folder / "plate.ply", "plate");
  document.surfaces["plate"] = ridged(cell_surfaces(world));
  return document;
}

manifest::ImageEntry image_of(const SampleWorld& world, const std::string& id, int placement, double tilt_rad) {
  manifest::ImageEntry image;
  image.id = id;
  image.camera = "camera";
  image.group = placement == 0 ? "before" : "after";
  static_cast<Rigid<frame::World, frame::Camera>&>(image.world_from_camera.emplace()) = camera_at(world, tilt_rad);
  image.noise = manifest::Noise{world.gain, world.read};
  return image;
}

// The stated pose: the true one moved about the camera's own axes.
void add_robot_error(const SampleWorld& world, Random& random, manifest::ImageEntry& image) {
  const auto error = [&](double sigma) {
    return Vec3{sigma * random.normal(), sigma * random.normal(), sigma * random.normal()};
  };
  auto& pose = *image.world_from_camera;
  const Quaternion turn = quaternion_of_rotation_vector(error(world.robot_rad));
  const Vec3 shift = error(world.robot_m);
  pose.translation_m = pose.translation_m + pose.rotate(shift);
  pose.rotation = normalized(pose.rotation * turn);
  pose.sigma = manifest::PoseSigma{{world.robot_rad}, {world.robot_m}};
}

void render_placement(const SampleWorld& world, int placement, const std::filesystem::path& folder, Random& random,
                      manifest::Document& document) {
  manifest::Document truth = document;
  truth.images.clear();
  truth.objects = {{.id = "plate", .mesh = "plate", .surface = "plate", .world_from_object = {}}};
  static_cast<Rigid<frame::World, frame::Object>&>(truth.objects[0].world_from_object.emplace()) =
      world_from_plate(placement);
  for (std::size_t k = 0; k < world.tilts_rad.size(); ++k)
    truth.images.push_back(
        image_of(world, (placement == 0 ? "before-" : "after-") + std::to_string(k), placement, world.tilts_rad[k]));
  const scene::Scene scene = scene::build_scene(truth);
  const render::RayCaster caster(scene.instances);
  for (std::size_t k = 0; k < truth.images.size(); ++k) {
    manifest::ImageEntry image = truth.images[k];
    const io::Image rendered =
        render::render(scene, k, caster, {.spp = world.spp, .seed = world.seed, .geometry = false});
    const io::Image picture = render::recorded(rendered, render::sensor_of(truth, k), image.id, world.seed);
    io::write_picture(folder / (image.id + ".exr"), picture);
    image.file = manifest::add_file(document, folder / (image.id + ".exr"), image.id);
    add_robot_error(world, random, image);
    document.images.push_back(image);
  }
}

// Corners as a person marks them in the first, the middle and the last image.
void mark_corners(const SampleWorld& world, Random& random, manifest::Document& document) {
  manifest::Table& table = document.tables["corners"];
  table.columns = {{"image", ""}, {"corner", ""}, {"u_px", "px"}, {"v_px", "px"}, {"sigma_px", "px"}};
  table.rows = manifest::Value::array();
  const std::size_t n = world.tilts_rad.size();
  for (int placement = 0; placement < 2; ++placement)
    for (const std::size_t k : {std::size_t{0}, n / 2, n - 1})
      for (int corner = 0; corner < 4; ++corner) {
        const Vec2 pixel = true_corner_px(world, placement, k, corner);
        table.rows.push_back(
            manifest::Value(manifest::Value::Array{(placement == 0 ? "before-" : "after-") + std::to_string(k), corner,
                                                   pixel.x + world.corner_px * random.normal(),
                                                   pixel.y + world.corner_px * random.normal(), world.corner_px}));
      }
}

}  // namespace

SampleWorld data_matrix_world(const std::string& text, std::size_t defects, std::uint64_t seed) {
  SampleWorld world;
  const contrast::MatrixCode code = contrast::write_matrix(text, 0, 0, "text");
  world.pattern = {code.modules.rows, code.modules.columns, {0.001, 0.001}, code.modules.bits};
  world.seed = seed;
  for (int k = -4; k <= 4; ++k) world.tilts_rad.push_back(k * 7.5 * pi / 180);
  Random random(seed, 3);
  while (world.defects.size() < defects) {
    const std::size_t cell = random.below(static_cast<std::uint32_t>(world.pattern.cells()));
    if (std::ranges::find(world.defects, cell) == world.defects.end()) world.defects.push_back(cell);
  }
  return world;
}

manifest::Document photographed(const SampleWorld& world, const std::filesystem::path& folder, bool with_text) {
  manifest::Document document = base_document(world, folder);
  Random random(world.seed, 7);
  for (int placement = 0; placement < 2; ++placement) render_placement(world, placement, folder, random, document);
  mark_corners(world, random, document);
  manifest::Pattern& pattern = document.patterns["sample"];
  pattern.kind = "data-matrix";
  pattern.rows = world.pattern.rows;
  pattern.columns = world.pattern.columns;
  pattern.cell_m = {world.pattern.cell_m.x};
  pattern.corners = "corners";
  pattern.placements = {{"before", {}, {}}, {"after", {}, {}}};
  if (with_text) {
    std::string bits;
    for (std::size_t cell = 0; cell < world.pattern.cells(); ++cell) {
      bits += world.pattern.bits[cell] ? '#' : '.';
      if ((cell + 1) % static_cast<std::size_t>(world.pattern.columns) == 0) bits += '\n';
    }
    write_file(folder / "pattern.txt", bits);
    pattern.file = manifest::add_file(document, folder / "pattern.txt", "pattern");
  }
  return document;
}

Vec2 true_corner_px(const SampleWorld& world, int placement, std::size_t tilt, int corner) {
  const double middle_px = (world.side_px - 1) / 2.0;
  const camera::CameraModel camera({world.focal_px, world.focal_px, middle_px, middle_px, {}}, world.side_px,
                                   world.side_px);
  const Vec2 p = world.pattern.corner_m(corner);
  return *camera.project(inverse(camera_at(world, world.tilts_rad[tilt])) *
                         (world_from_pattern(world, placement) * Vec3{p.x, p.y, 0}));
}

double true_michelson(const SampleWorld& world, int placement, std::size_t tilt) {
  const surface::Model& model = *surface::find("ridged");
  const Vec3 eye = camera_at(world, world.tilts_rad[tilt]).translation_m;
  const auto plate = world_from_plate(placement);
  double sum[2] = {0, 0};
  for (int bit = 0; bit < 2; ++bit) {
    const CellSurface c = nominal(bit == 1);
    const surface::Values values = surface::values_of(
        model,
        {{"ridge_rad", ridge_rad}, {"alpha_u", c.alpha_u}, {"alpha_v", c.alpha_v}, {"azimuth_rad", c.azimuth_rad}},
        "truth");
    for (std::size_t cell = 0; cell < world.pattern.cells(); ++cell) {
      const Vec2 m = world.pattern.middle_m(cell);
      const Vec3 at = world_from_pattern(world, placement) * Vec3{m.x, m.y, 0};
      const auto local = [&](Vec3 d) { return matrix_of(conjugate(plate.rotation)) * d; };
      const Vec3 wo = local(normalized(eye - at)), wi = local(normalized(lamp_m - at));
      sum[bit] += mean(model.evaluate(values, wo, wi)) * wi.z / dot(lamp_m - at, lamp_m - at);
    }
  }
  return (sum[1] - sum[0]) / (sum[1] + sum[0]);
}

}  // namespace gonio::tests
