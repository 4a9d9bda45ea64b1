// glTF: what the specification demands of a file, points on their pixels, and export then import as the same scene.
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "exchange_cases.h"
#include "manifest/image_list.h"
#include "manifest/sections/file.h"
#include "manifest/sections/light.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "manifest/value.h"
#include "scene/exchange/geometry.h"

namespace gonio::scene {
namespace {

using manifest::Value;

Value json_of(const Exported& exported) {
  return manifest::parse_json(content_of(exported, "scene.gltf"), "scene.gltf");
}
const Value& entry(const Value& root, const char* list, std::int64_t i) {
  return root.find(list)->as_array().at(static_cast<std::size_t>(i));
}
double number(const Value& v, const char* key) {
  return v.find(key)->as_number();
}
std::vector<double> numbers(const Value& v) {
  std::vector<double> all;
  for (const Value& n : v.as_array()) all.push_back(n.as_number());
  return all;
}

// Sizes, alignments, targets and bounds: sections 3.6.2 and 3.7.2 of the specification.
void expect_sound_accessors(const Value& root, const std::string& bytes) {
  EXPECT_EQ(number(entry(root, "buffers", 0), "byteLength"), bytes.size());
  double covered = 0;
  for (const Value& accessor : root.find("accessors")->as_array()) {
    const Value& view = entry(root, "bufferViews", accessor.find("bufferView")->as_integer());
    const std::string type = accessor.find("type")->as_string();
    const double columns = type == "SCALAR" ? 1 : type == "VEC2" ? 2 : 3, count = number(accessor, "count");
    EXPECT_EQ(number(view, "byteLength"), 4 * columns * count);
    EXPECT_EQ(std::fmod(number(view, "byteOffset"), 4), 0);
    EXPECT_LE(number(view, "byteOffset") + number(view, "byteLength"), bytes.size());
    EXPECT_EQ(number(view, "target"), type == "SCALAR" ? 34963 : 34962);
    covered += number(view, "byteLength");
  }
  EXPECT_EQ(covered, bytes.size());
}

void expect_bounds(const Value& root, const std::string& bytes, const Value& accessor) {
  const Value& view = entry(root, "bufferViews", accessor.find("bufferView")->as_integer());
  std::vector<double> low(3, std::numeric_limits<double>::infinity()), high(3, -low[0]);
  for (std::size_t i = 0; i < 3 * static_cast<std::size_t>(number(accessor, "count")); ++i) {
    float v = 0;
    std::memcpy(&v, bytes.data() + static_cast<std::size_t>(number(view, "byteOffset")) + 4 * i, 4);
    low[i % 3] = std::min<double>(low[i % 3], v);
    high[i % 3] = std::max<double>(high[i % 3], v);
  }
  EXPECT_EQ(numbers(*accessor.find("min")), low);
  EXPECT_EQ(numbers(*accessor.find("max")), high);
}

TEST(ExchangeGltf, FilesAreAsTheSpecificationDemands) {
  const Exported exported = Letter().exported("gltf");
  const Value root = json_of(exported);
  const std::string& bytes = content_of(exported, "scene.bin");
  EXPECT_EQ(root.find("asset")->find("version")->as_string(), "2.0");
  expect_sound_accessors(root, bytes);
  for (const Value& mesh : root.find("meshes")->as_array())
    for (const Value& primitive : mesh.find("primitives")->as_array()) {
      expect_bounds(root, bytes,
                    entry(root, "accessors", primitive.find("attributes")->find("POSITION")->as_integer()));
      EXPECT_NE(entry(root, "materials", primitive.find("material")->as_integer()).find("name"), nullptr);
    }
  std::set<std::int64_t> children;  // of no two parents
  for (const Value& node : root.find("nodes")->as_array()) {
    if (const Value* q = node.find("rotation")) {
      const auto v = numbers(*q);
      EXPECT_NEAR(std::hypot(std::hypot(v[0], v[1]), std::hypot(v[2], v[3])), 1, 1e-12);
    }
    if (const Value* list = node.find("children")) {
      for (const Value& child : list->as_array()) EXPECT_TRUE(children.insert(child.as_integer()).second);
    }
  }
  for (const Value& scene : root.find("scenes")->as_array())
    for (const Value& node : scene.find("nodes")->as_array()) EXPECT_FALSE(children.contains(node.as_integer()));
  for (const Value& light : root.find("extensions")->find("KHR_lights_punctual")->find("lights")->as_array())
    for (const double c : numbers(*light.find("color"))) EXPECT_LE(c, 1);
  for (const Value& name : root.find("extensionsUsed")->as_array()) EXPECT_TRUE(name.as_string().starts_with("KHR_"));
}

Mat3 turn_of(const Value& node) {
  const auto q = numbers(*node.find("rotation"));
  return matrix_of(Quaternion{q[3], q[0], q[1], q[2]});
}

// Appendix C of the specification: projection by yfov and aspectRatio, or by xmag and ymag, in the frame of the
// camera's node below the node that turns the world.
Vec2 gltf_pixel(const Value& root, const Value& scene, Vec3 p) {
  const Value& above = entry(root, "nodes", scene.find("nodes")->as_array().at(1).as_integer());
  const Value& node = entry(root, "nodes", above.find("children")->as_array().at(0).as_integer());
  const Value& camera = entry(root, "cameras", node.find("camera")->as_integer());
  const auto t = numbers(*node.find("translation"));
  const Vec3 v = transposed(turn_of(node)) * (p - Vec3{t[0], t[1], t[2]});  // the world's turn cancels
  EXPECT_LT(v.z, 0);
  const Value& ours = *camera.find("extras")->find("gonio");
  const double width = number(ours, "width_px"), height = number(ours, "height_px");
  if (const Value* lens = camera.find("orthographic"))
    return {(v.x / number(*lens, "xmag") + 1) * width / 2 - 0.5, (1 - v.y / number(*lens, "ymag")) * height / 2 - 0.5};
  const Value& lens = *camera.find("perspective");
  const double tangent = std::tan(number(lens, "yfov") / 2);
  const Vec2 middle{(v.x / -v.z / (tangent * number(lens, "aspectRatio")) + 1) * width / 2 - 0.5,
                    (1 - v.y / -v.z / tangent) * height / 2 - 0.5};
  return middle + Vec2{number(ours, "cx_px") - (width - 1) / 2, number(ours, "cy_px") - (height - 1) / 2};
}

TEST(ExchangeGltf, PointsLandOnTheirPixels) {
  for (const double fy : {62.0, 58.5}) {
    const Letter letter(fy);
    const Value root = json_of(letter.exported("gltf"));
    for (const std::size_t i : {0u, 1u})
      expect_same_pixels(letter.scene, i,
                         [&](Vec3 p) { return gltf_pixel(root, entry(root, "scenes", std::int64_t(i)), p); });
  }
}

TEST(ExchangeGltf, TheWorldStandsUprightWithYUp) {
  const Value root = json_of(Letter().exported("gltf"));
  for (const std::int64_t i : {0, 1}) {
    const Value& above = entry(root, "nodes", entry(root, "scenes", 0).find("nodes")->as_array().at(i).as_integer());
    const Vec3 up = turn_of(above) * Vec3{0, 0, 1}, ahead = turn_of(above) * Vec3{0, 1, 0};
    EXPECT_NEAR(norm(up - Vec3{0, 1, 0}), 0, 1e-15);
    EXPECT_NEAR(norm(ahead - Vec3{0, 0, -1}), 0, 1e-15);
  }
}

// The folder as `scene import` leaves it, and the scene in it.
struct Imprint {
  explicit Imprint(const Exported& exported) { restore(exported); }
  void restore(const Exported& exported) {
    for (const ExchangedFile& file : exported.files) put(folder / "out", file);
    Imported imported = find_exchange("gltf")->read(folder / "out/scene.gltf");
    losses = imported.losses;
    document = std::move(imported.document);
    document.folder = folder / "in";
    for (const ExchangedFile& file : imported.files) {
      put(folder / "in", file);
      manifest::add_file(document, folder / "in" / file.name, file.name);
    }
    // As text and back: what is written must be a manifest.
    document = manifest::parse_document(manifest::print_document(document, folder / "in"), "in", folder / "in");
    Reading reading;
    reading.allow_open = true;
    scene = build_scene(document, reading);
  }
  static void put(const std::filesystem::path& at, const ExchangedFile& file) {
    make_folder((at / file.name).parent_path());
    write_file(at / file.name, file.content);
  }
  tests::ScratchFolder folder;
  manifest::Document document;
  Scene scene;
  std::vector<Loss> losses;
};

double difference(const Rigid<frame::World, frame::Object>& a, const Rigid<frame::World, frame::Object>& b) {
  double worst = norm(a.translation_m - b.translation_m);
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    worst = std::max(worst, norm(a.rotate(axis) - b.rotate(axis)));
  return worst;
}

TEST(ExchangeGltf, GeometryComesBack) {
  const Letter letter;
  const Imprint back(letter.exported("gltf"));
  ASSERT_EQ(back.scene.instances.size(), letter.scene.instances.size());
  for (std::size_t i = 0; i < back.scene.instances.size(); ++i) {
    const Instance &before = letter.scene.instances[i], &after = back.scene.instances[i];
    EXPECT_EQ(after.id, before.id);
    EXPECT_LT(difference(after.world_from_object, before.world_from_object), 1e-12);
    const io::TriangleMesh mesh = triangles_of(before.shape);
    const mesh::Mesh& there = *std::get<std::shared_ptr<const mesh::Mesh>>(after.shape);
    ASSERT_EQ(there.triangles, mesh.triangles);
    for (std::size_t k = 0; k < mesh.positions_m.size(); ++k) {
      EXPECT_LT(norm(there.positions_m[k] - mesh.positions_m[k]), 1e-7);
      EXPECT_LT(norm(Vec3{there.texture[k].x - mesh.texture[k].x, there.texture[k].y - mesh.texture[k].y, 0}), 2e-7);
      EXPECT_TRUE(mesh.normals.empty() || norm(there.normals[k] - mesh.normals[k]) < 1e-6);
    }
  }
}

TEST(ExchangeGltf, CamerasComeBack) {
  for (const double fy : {62.0, 58.5}) {
    const Letter letter(fy);
    const Imprint back(letter.exported("gltf"));
    ASSERT_EQ(back.scene.views.size(), letter.scene.views.size());
    for (std::size_t i = 0; i < back.scene.views.size(); ++i) {
      const View &before = letter.scene.views[i], &after = back.scene.views[i];
      EXPECT_EQ(after.image, before.image);
      for (const Vec2 pixel : {Vec2{0, 0}, Vec2{63, 0}, Vec2{12.5, 31}, Vec2{63, 39}}) {
        const camera::Ray a = before.camera.ray(pixel), b = after.camera.ray(pixel);
        const Vec3 from = before.world_from_camera * a.origin_m, to = after.world_from_camera * b.origin_m;
        EXPECT_LT(norm(from - to), 1e-12);
        EXPECT_LT(norm(before.world_from_camera.rotate(a.direction) - after.world_from_camera.rotate(b.direction)),
                  1e-12);
      }
    }
  }
}

// One lamp of every kind that the format knows, each by the light that it throws onto points of the letter.
TEST(ExchangeGltf, LampsComeBack) {
  const Letter letter;
  manifest::Document document = letter.document;
  const manifest::Parameter at(std::vector<double>{0.1, -0.3, 0.9}), down(std::vector<double>{0.1, 0.3, -1}),
      white(std::vector<double>{1, 2, 0.5});
  document.lights = {
      {"point", {"point", {{"position_m", at}, {"watt_per_sr", white}}}},
      {"ball", {"sphere", {{"position_m", at}, {"watt_per_sr", white}, {"radius_m", 0.02}}}},
      {"disc", {"disc", {{"position_m", at}, {"direction", down}, {"watt_per_sr", white}, {"radius_m", 0.1}}}},
      {"panel",
       {"rectangle",
        {{"position_m", at},
         {"direction", down},
         {"up", std::vector<double>{1, 2, 0}},
         {"width_m", 0.3},
         {"height_m", 0.1},
         {"watt_per_sr", white}}}},
      {"stage", {"spot", {{"position_m", at}, {"direction", down}, {"watt_per_sr", white}, {"outer_rad", 0.5}}}},
      {"sun", {"directional", {{"towards", std::vector<double>{0.3, 0.2, 1}}, {"watt_per_m2", white}}}}};
  keep_images(document, {"lamp", "sun"});
  light_image(document, "lamp", {"point", "disc", "stage", "sun"});
  light_image(document, "sun", {"point", "ball", "panel"});
  const Scene scene = build_scene(document);
  const Imprint back(export_scene(scene, *find_exchange("gltf")));
  ASSERT_EQ(back.scene.appearance.lights.size(), scene.appearance.lights.size());
  for (std::size_t i = 0; i < scene.appearance.lights.size(); ++i) {
    const Light &before = scene.appearance.lights[i], &after = back.scene.appearance.lights[i];
    EXPECT_EQ(after.id, before.id);
    EXPECT_EQ(after.model, before.model);
    for (const Vec3 p : letter_points())
      for (const Vec2 u : {Vec2{0.2, 0.7}, Vec2{0.9, 0.4}}) {
        const light::Sample a = before.emitter->sample(p, u), b = after.emitter->sample(p, u);
        EXPECT_EQ(a.valid, b.valid) << before.id;
        EXPECT_LT(norm(a.weight - b.weight), 1e-9 * (1 + norm(a.weight))) << before.id;
        EXPECT_LT(norm(a.direction - b.direction), 1e-9) << before.id;
      }
  }
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(back.scene.views[i].lights, scene.views[i].lights);
}

TEST(ExchangeGltf, SurfacesComeBack) {
  const Letter letter;
  manifest::Document document = letter.document;
  const std::vector<double> red{0.8, 0.3, 0.2}, glow{0.9, 0.7, 0.3}, sigma{3, 40, 0};
  document.surfaces = {
      {"paint", {"diffuse", {{"albedo", red}}}},
      {"wood", {"coated-diffuse", {{"albedo", red}, {"f0", 0.05}, {"alpha", 0.2}}}},
      {"gold", {"metal", {{"f0", glow}, {"alpha", 0.3}}}},
      {"glaze",
       {"dielectric",
        {{"eta", 1.4}, {"alpha", 0.3}, {"anisotropy", 0.5}, {"azimuth_rad", 0.4}, {"sigma_a_per_m", sigma}}}}};
  const Scene scene = build_scene(document);
  const Imprint back(export_scene(scene, *find_exchange("gltf")));
  for (const auto& [name, before] : document.surfaces) {
    const manifest::Surface& after = back.document.surfaces.at(name);
    EXPECT_EQ(after.model, before.model);
    for (const auto& [parameter, value] : before.parameters) {
      const Rgb a = value.rgb(), b = after.parameters.at(parameter).rgb();
      EXPECT_LT(norm(a - b), 1e-9) << name << " " << parameter;
    }
  }
}

TEST(ExchangeGltf, ACoatOverMetalComesBack) {
  manifest::Document document = Letter().document;
  document.lights.erase("sky");
  keep_images(document, {"lamp"});
  document.surfaces["lacquer"] = {"rough-coat", {{"eta", 1.5}, {"alpha", 0.04}}};
  document.surfaces["lacquer"].base = "gold";
  document.objects.back().surface = "lacquer";
  const Imprint back(export_scene(build_scene(document), *find_exchange("gltf")));
  const manifest::Surface& coat = back.document.surfaces.at(back.document.objects.back().surface);
  EXPECT_EQ(coat.model, "rough-coat");
  EXPECT_NEAR(coat.parameters.at("alpha").scalar(), 0.04, 1e-12);
  EXPECT_EQ(back.document.surfaces.at(coat.base).model, "metal");
}

TEST(ExchangeGltf, TexturesComeBackToTheirCodes) {
  const Letter letter;
  manifest::Document document = letter.document;
  io::Image stripes(4, 2, {"R", "G", "B"}), polish(2, 1, {"Y"});
  for (std::size_t i = 0; i < stripes.data.size(); ++i) stripes.data[i] = 0.04f * static_cast<float>(i);
  polish.data = {0.02f * 1.000001f, 0.5f};
  io::write_picture(letter.folder() / "stripes.exr", stripes);
  io::write_picture(letter.folder() / "polish.exr", polish);
  document.files["stripes"].path = "stripes.exr";
  document.files["polish"].path = "polish.exr";
  document.surfaces["gold"].textures = {{"f0", "stripes"}, {"alpha", "polish"}};
  const Imprint back(export_scene(build_scene(document), *find_exchange("gltf")));
  const auto& surfaces = back.scene.appearance.surfaces;
  const auto gold = std::ranges::find_if(surfaces, [](const Surface& s) { return s.id == "gold"; });
  ASSERT_NE(gold, surfaces.end());
  for (const Texture& texture : gold->textures) {
    const io::Image& expected = texture.name == "alpha" ? polish : stripes;
    ASSERT_EQ(texture.picture->data.size(), expected.data.size());
    for (std::size_t i = 0; i < expected.data.size(); ++i)
      EXPECT_NEAR(texture.picture->data[i], expected.data[i], 5e-5) << texture.name;
  }
  EXPECT_EQ(gold->textures.size(), 2u);
}

}  // namespace
}  // namespace gonio::scene
