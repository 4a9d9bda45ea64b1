// See stage.h. The screen is one of 27 inches, 0.35 m behind the turntable's axis (Doest et al. 2021, 3.1); its light
// is polarized along a direction that monitors have: upright, level or at 45 degrees.
#include "glass/stage.h"

#include <cmath>

#include "base/atomic_file.h"
#include "base/hash.h"
#include "base/text.h"
#include "camera/intrinsics.h"
#include "glass/patterns.h"
#include "io/encode_ply.h"
#include "io/exr.h"
#include "io/picture.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "render/looking_at.h"

namespace gonio::glass {
namespace {

namespace fs = std::filesystem;

constexpr double screen_width_m = 0.598, screen_height_m = 0.336, screen_y_m = 0.35, screen_lift_m = -0.2;
constexpr double table_m = 0.3, above_table_m = 2e-4;
// 10,500 electrons at full scale, 2.4 of read noise (data sheet of the IMX250MZR); full scale is 1.3 times the screen.
constexpr manifest::Noise sensor_noise{.gain = 8000, .read = 3e-4};

// A file under a name by content, written below the set's folder unless it is there; its id in the scene.
class SharedFiles {
 public:
  SharedFiles(manifest::Document& scene, fs::path folder) : scene_(scene), folder_(std::move(folder)) {}
  std::string add(const std::string& id, const char* kind, const char* ending, const std::string& bytes) {
    const fs::path path = folder_ / kind / (sha256(bytes).substr(0, 16) + ending);
    if (!fs::exists(path)) {
      make_folder(path.parent_path());
      write_file(path, bytes);
    }
    return manifest::add_file(scene_, path, id);
  }

 private:
  manifest::Document& scene_;
  fs::path folder_;
};

struct Turn {
  double rad = 0;
  Vec3 operator()(Vec3 p) const {
    return {std::cos(rad) * p.x - std::sin(rad) * p.y, std::sin(rad) * p.x + std::cos(rad) * p.y, p.z};
  }
};

void add_object(manifest::Document& scene, const std::string& id, const std::string& mesh, const std::string& surface,
                double turn_rad, Vec3 at_m, std::optional<int> priority) {
  manifest::Object object{.id = id, .mesh = mesh, .surface = surface, .world_from_object = {}, .priority = priority};
  auto& pose = object.world_from_object.emplace();
  pose.rotation = {std::cos(turn_rad / 2), 0, 0, std::sin(turn_rad / 2)};
  pose.translation_m = at_m;
  scene.objects.push_back(std::move(object));
}

void add_clear(manifest::Document& scene, SharedFiles& files, const std::string& name, const Glass& kind, Rgb sigma_a,
               double alpha) {
  manifest::Surface& surface = scene.surfaces[name];
  surface.model = "dielectric";
  surface.spectra["eta"] = files.add("spectrum-" + name, "files", ".csv", spectrum_csv(kind));
  surface.parameters["sigma_a_per_m"] = std::vector<double>{sigma_a.x, sigma_a.y, sigma_a.z};
  if (alpha > 0) surface.parameters["alpha"] = alpha;
}

// Where overlap: air in bubbles before glass, glass before what stands in it.
void add_glass(manifest::Document& scene, SharedFiles& files, const MadeObject& made, double turn_rad) {
  manifest::Mesh& mesh = scene.meshes["object"];
  mesh.file = files.add("object", "meshes", ".ply", io::encode_ply(made.mesh));
  if (made.flat) mesh.normals = "flat";
  add_clear(scene, files, "glass", *made.glass, made.sigma_a_per_m, made.alpha);
  add_object(scene, "object", "object", "glass", turn_rad, {0, 0, above_table_m}, 1);
  if (!made.filling.triangles.empty()) {
    scene.meshes["filling"].file = files.add("filling", "meshes", ".ply", io::encode_ply(made.filling));
    scene.meshes["filling"].normals = "flat";
    add_clear(scene, files, "liquid", *find_glass("water"), made.liquid_per_m, 0);
    add_object(scene, "filling", "filling", "liquid", turn_rad, {0, 0, above_table_m}, 0);
  }
  if (made.bubbles.empty()) return;
  scene.surfaces["air"].model = "dielectric";
  scene.surfaces["air"].parameters["eta"] = 1.0;
  for (std::size_t i = 0; i < made.bubbles.size(); ++i) {
    const std::string id = format("bubble-%zu", i + 1);
    scene.meshes[id].sphere_radius_m = made.bubbles[i].radius_m;
    const Vec3 at = Turn{turn_rad}(made.bubbles[i].centre_m) + Vec3{0, 0, above_table_m};
    add_object(scene, id, id, "air", 0, at, 2);
  }
}

void add_table(Cell& cell, Random& random) {
  manifest::Document& scene = cell.scene;
  scene.meshes["table"].plane_size_m = {table_m, table_m};
  const Rgb hue{random.uniform(0.5, 1), random.uniform(0.5, 1), random.uniform(0.5, 1)};
  const Rgb colour = hue * random.uniform(0.1, 0.7);
  scene.surfaces["table"].parameters["albedo"] = std::vector<double>{colour.x, colour.y, colour.z};
  add_object(scene, "table", "table", "table", 0, {}, {});
}

void add_screen(Cell& cell, SharedFiles& files, Random& random) {
  const auto patterns = pattern_names();
  const std::string pattern = patterns[random.below(static_cast<std::uint32_t>(patterns.size()))];
  static constexpr double axes[] = {0, pi / 4, pi / 2, 3 * pi / 4};
  const double axis = axes[random.below(4)], degree = random.uniform(0.97, 1);
  manifest::Light& screen = cell.scene.lights["screen"];
  screen.model = "screen";
  screen.file = files.add("screen", "files", ".exr", io::encode_exr(screen_picture(pattern, random)));
  screen.parameters = {{"position_m", std::vector<double>{0, screen_y_m, screen_lift_m + screen_height_m / 2}},
                       {"direction", std::vector<double>{0, -1, 0}},
                       {"up", std::vector<double>{0, 0, 1}},
                       {"width_m", screen_width_m},
                       {"height_m", screen_height_m},
                       {"polarization_rad", axis},
                       {"polarization_degree", degree}};
  cell.facts["pattern"] = pattern;
  cell.facts["screen_axis_deg"] = format("%.0f", axis * 180 / pi);
}

void add_room(Cell& cell, SharedFiles& files, const SetWish& wish, Random& random) {
  manifest::Light& light = cell.scene.lights["room"];
  light.model = "lat-long";
  const double rotation = random.uniform(-pi, pi), scale = random.uniform(0.1, 0.4);
  if (wish.surroundings.empty()) {
    light.file = files.add("room", "files", ".exr", io::encode_exr(room(random)));
    cell.facts["room"] = "drawn";
  } else {
    const fs::path& path = wish.surroundings[random.below(static_cast<std::uint32_t>(wish.surroundings.size()))];
    light.file = files.add("room", "files", path.extension().c_str(), read_file(path));
    cell.facts["room"] = path.stem();
  }
  light.parameters = {{"scale", scale}, {"rotation_rad", rotation}};
}

// On an arc about the object, which fills half to three quarters of the picture.
void add_camera(Cell& cell, const MadeObject& made, const SetWish& wish, Random& random) {
  const double azimuth = random.uniform(-35, 35) * pi / 180, elevation = random.uniform(3, 28) * pi / 180;
  const double distance = random.uniform(0.45, 0.65);
  const Vec3 middle{0, 0, made.height_m / 2};
  const Vec3 aside{random.uniform(-0.1, 0.1) * made.radius_m, 0, random.uniform(-0.1, 0.1) * made.height_m};
  const Vec3 eye = middle + Vec3{std::sin(azimuth) * std::cos(elevation), -std::cos(azimuth) * std::cos(elevation),
                                 std::sin(elevation)} *
                                distance;
  const double reach = std::hypot(made.height_m / 2, made.radius_m);
  const double focal = random.uniform(0.5, 0.75) * std::min(wish.width_px, wish.height_px) / 2 * distance / reach;
  camera::enter_pinhole(cell.scene, "camera", wish.width_px, wish.height_px, focal);
  cell.scene.cameras.at("camera").mosaic = "polarizers";
  for (const bool lit : {false, true}) {
    manifest::PlannedImage view{.id = lit ? "lit" : "bare", .camera = "camera"};
    view.world_from_camera = {render::looking_at(eye, middle + aside), {}};
    view.light = lit ? std::vector<std::string>{"screen", "room"} : std::vector<std::string>{"screen"};
    view.noise = sensor_noise;
    manifest::enter_image(cell.scene, view);
  }
  cell.facts["azimuth_deg"] = format("%.2f", azimuth * 180 / pi);
  cell.facts["elevation_deg"] = format("%.2f", elevation * 180 / pi);
  cell.facts["distance_m"] = format("%.4f", distance);
}

}  // namespace

void set_the_stage(Cell& cell, const MadeObject& made, const SetWish& wish, const fs::path& folder, Random& random) {
  cell.scene.folder = folder;
  SharedFiles files(cell.scene, folder);
  add_table(cell, random);
  add_glass(cell.scene, files, made, random.uniform(0, 2 * pi));
  add_screen(cell, files, random);
  add_room(cell, files, wish, random);
  add_camera(cell, made, wish, random);
}

}  // namespace gonio::glass
