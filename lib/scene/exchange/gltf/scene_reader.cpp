// A scene out of glTF 2.0 (scene/exchange/formats/gltf.cpp): nodes, meshes, cameras, lamps.
#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "scene/exchange/geometry.h"
#include "scene/exchange/gltf/gltf.h"

namespace gonio::scene::gltf2 {
namespace {

struct Motion {  // affine: x -> linear x + offset
  Mat3 linear;
  Vec3 offset;
  Motion operator*(const Motion& o) const { return {linear * o.linear, linear * o.offset + offset}; }
};

double determinant(const Mat3& a) {
  return dot(Vec3{a(0, 0), a(0, 1), a(0, 2)}, cross(Vec3{a(1, 0), a(1, 1), a(1, 2)}, Vec3{a(2, 0), a(2, 1), a(2, 2)}));
}

// Columns perpendicular and of unit length, to what single precision leaves of them?
bool is_rotation(const Mat3& a) {
  const Mat3 product = transposed(a) * a;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (std::abs(product(i, j) - (i == j)) > 1e-5) return false;
  return determinant(a) > 0;
}

Motion motion_of(const Item& node) {
  Motion motion;
  if (node["matrix"].there()) {  // column by column
    const std::vector<double> m = node["matrix"].numbers(16, {});
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t c = 0; c < 3; ++c) motion.linear(static_cast<int>(row), static_cast<int>(c)) = m[4 * c + row];
    motion.offset = {m[12], m[13], m[14]};
    return motion;
  }
  const std::vector<double> q = node["rotation"].numbers(4, {0, 0, 0, 1}), s = node["scale"].numbers(3, {1, 1, 1}),
                            t = node["translation"].numbers(3, {0, 0, 0});
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(length - 1) < 1e-3)) node["rotation"].refuse("is no unit quaternion");
  motion.linear =
      matrix_of(normalized(Quaternion{q[3], q[0], q[1], q[2]})) * Mat3{{s[0], 0, 0, 0, s[1], 0, 0, 0, s[2]}};
  motion.offset = {t[0], t[1], t[2]};
  return motion;
}

Quaternion rotation_of(const Mat3& linear) {
  return normalized(quaternion_of(linear));
}

std::vector<Vec3> vectors(const Numbers& numbers, const Item& at) {
  if (numbers.columns != 3) at.refuse("holds no vectors of three numbers");
  std::vector<Vec3> all;
  for (std::size_t i = 0; i < numbers.rows; ++i)
    all.push_back({numbers.v[3 * i], numbers.v[3 * i + 1], numbers.v[3 * i + 2]});
  return all;
}

// Triangles, strips (every other one turned) and fans.
std::vector<std::array<std::uint32_t, 3>> triangles(const std::vector<std::uint32_t>& v, std::uint64_t mode) {
  std::vector<std::array<std::uint32_t, 3>> all;
  for (std::size_t i = 0; i + 2 < v.size(); i += mode == 4 ? 3 : 1) {
    if (mode == 6)
      all.push_back({v[0], v[i + 1], v[i + 2]});
    else if (mode == 5 && i % 2 == 1)
      all.push_back({v[i + 1], v[i], v[i + 2]});
    else
      all.push_back({v[i], v[i + 1], v[i + 2]});
  }
  return all;
}

void apply(const Mat3& linear, io::TriangleMesh& mesh) {
  // Normals go by the cofactors: perpendicular to what the tangents become, on the side where they were.
  const auto row = [&](int i) { return Vec3{linear(i, 0), linear(i, 1), linear(i, 2)}; };
  const Vec3 a = cross(row(1), row(2)), b = cross(row(2), row(0)), c = cross(row(0), row(1));
  const double sign = determinant(linear) < 0 ? -1 : 1;
  for (Vec3& p : mesh.positions_m) p = linear * p;
  for (Vec3& n : mesh.normals)
    if (const Vec3 turned = Vec3{dot(a, n), dot(b, n), dot(c, n)} * sign; norm(turned) > 0) n = normalized(turned);
  if (sign < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : source_(path), materials_(source_, imported_) {}

  Imported read() {
    refuse_unknown();
    const Item root = source_.root(), scenes = root["scenes"];
    for (std::size_t i = 0; i < scenes.size(); ++i) read_scene(scenes[i]);
    if (scenes.size() == 0) lose(root, "a file without a scene", "nothing");
    for (const char* list : {"animations", "skins"})
      if (root[list].size() > 0) lose(root[list], list, "everything where it is at rest");
    imported_.document.name = source_.name();
    return std::move(imported_);
  }

 private:
  void lose(const Item& at, std::string what, std::string instead) {
    imported_.losses.push_back({at.pointer(), std::move(what), std::move(instead)});
  }

  void refuse_unknown() {
    static const std::set<std::string> known = {
        "KHR_lights_punctual",     "KHR_materials_ior",      "KHR_materials_transmission", "KHR_materials_volume",
        "KHR_materials_clearcoat", "KHR_materials_specular", "KHR_materials_anisotropy",   "KHR_mesh_quantization"};
    const Item required = source_.root()["extensionsRequired"];
    for (std::size_t i = 0; i < required.size(); ++i)
      if (!known.contains(required[i].text()))
        required[i].refuse("is " + required[i].text() + ", which is not read here", "export the file without it");
  }

  void read_scene(const Item& scene) {
    walked_.clear();
    lamps_of_scene_.clear();
    cameras_of_scene_.clear();
    const double half = std::sqrt(0.5);
    const Motion world_from_gltf{matrix_of(Quaternion{half, half, 0, 0}), {}};
    const Item nodes = scene["nodes"];
    for (std::size_t i = 0; i < nodes.size(); ++i) walk(nodes[i], world_from_gltf, 0);
    for (manifest::PlannedImage& image : cameras_of_scene_) {
      image.light = lamps_of_scene_;
      manifest::enter_image(imported_.document, image);
    }
  }

  void walk(const Item& index, const Motion& parent, int depth) {
    const Item node = source_.root().named("nodes", index);
    if (!walked_.insert(node.pointer()).second) index.refuse("names a node that stands elsewhere in the scene already");
    if (depth > 4096) index.refuse("lies more than 4096 nodes deep");
    const Motion motion = parent * motion_of(node);
    if (!is_finite(motion.offset) || !std::isfinite(determinant(motion.linear)))
      node.refuse("leads out of the range of numbers");
    const Item light = node["extensions"]["KHR_lights_punctual"]["light"];
    if ((node["camera"].there() || light.there()) && !(std::abs(determinant(motion.linear)) > 1e-30))
      node.refuse("is scaled to nothing");
    if (node["mesh"].there()) read_objects(node, motion);
    if (node["camera"].there()) read_camera(node, motion);
    if (light.there()) read_lamp(node, light, motion);
    const Item children = node["children"];
    for (std::size_t i = 0; i < children.size(); ++i) walk(children[i], motion, depth + 1);
  }

  // One object for each primitive, once however many scenes show it.
  void read_objects(const Item& node, const Motion& motion) {
    if (!shown_.insert(node.pointer()).second) return;
    const Item mesh = source_.root().named("meshes", node["mesh"]), primitives = mesh["primitives"];
    if (mesh["weights"].there() || node["weights"].there()) lose(mesh, "shapes that morph", "the shape at rest");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const std::uint64_t mode = primitives[i]["mode"].count(4);
      if (mode < 4 || mode > 6) {
        lose(primitives[i], "points and lines", "nothing");
        continue;
      }
      const bool rigid = is_rotation(motion.linear);
      manifest::Object object;
      object.id = unused_id(node["name"].text(mesh["name"].text("")));
      object.mesh = mesh_of(primitives[i], mode, rigid ? Mat3{} : motion.linear, object.id);
      object.surface = materials_.surface_of(primitives[i]["material"]);
      object.world_from_object.emplace();
      if (rigid) object.world_from_object->rotation = rotation_of(motion.linear);
      object.world_from_object->translation_m = motion.offset;
      imported_.document.objects.push_back(std::move(object));
    }
  }

  std::string unused_id(const std::string& wanted) {
    std::string name = wanted.empty() ? "object" : wanted;
    for (int i = 2; !object_names_.insert(name).second; ++i)
      name = (wanted.empty() ? "object" : wanted) + "-" + std::to_string(i);
    return name;
  }

  std::string mesh_of(const Item& primitive, std::uint64_t mode, const Mat3& linear, const std::string& wanted) {
    std::string key = manifest::canonical_json(primitive["attributes"].value()) + std::to_string(mode);
    if (primitive["indices"].there()) key += "/" + std::to_string(primitive["indices"].count());
    for (const double v : linear.m) key += " " + shortest_text(v);
    std::string& name = meshes_[key];
    if (!name.empty()) return name;
    name = unused_name(imported_.document.meshes, wanted, "mesh");
    io::TriangleMesh mesh = geometry(primitive, mode);
    if (linear.m != Mat3{}.m) apply(linear, mesh);
    const std::string file = "meshes/" + std::to_string(meshes_.size()) + "-" + file_stem(name) + ".ply";
    imported_.files.push_back({file, compact_ply(mesh)});
    manifest::Mesh entry;
    entry.file = file;
    if (mesh.normals.empty()) entry.normals = "flat";
    imported_.document.meshes[name] = std::move(entry);
    return name;
  }

  io::TriangleMesh geometry(const Item& primitive, std::uint64_t mode) {
    const Item attributes = primitive["attributes"];
    if (!attributes["POSITION"].there()) attributes.refuse("names no POSITION");
    io::TriangleMesh mesh;
    mesh.positions_m = vectors(source_.accessor(attributes["POSITION"]), attributes["POSITION"]);
    if (attributes["NORMAL"].there())
      mesh.normals = vectors(source_.accessor(attributes["NORMAL"]), attributes["NORMAL"]);
    if (attributes["TEXCOORD_0"].there()) {
      const Numbers uv = source_.accessor(attributes["TEXCOORD_0"]);
      if (uv.columns != 2) attributes["TEXCOORD_0"].refuse("holds no pairs of numbers");
      for (std::size_t i = 0; i < uv.rows; ++i) mesh.texture.push_back({uv.v[2 * i], 1 - uv.v[2 * i + 1]});
    }
    const std::size_t rows = mesh.positions_m.size();
    if ((!mesh.normals.empty() && mesh.normals.size() != rows) ||
        (!mesh.texture.empty() && mesh.texture.size() != rows))
      attributes.refuse("has lists of different lengths");
    std::vector<std::uint32_t> order;
    if (primitive["indices"].there()) {
      const Numbers indices = source_.accessor(primitive["indices"]);
      if (indices.columns != 1) primitive["indices"].refuse("holds vectors");
      for (const double v : indices.v) {
        if (!(v >= 0 && v < static_cast<double>(rows)))
          primitive["indices"].refuse("names vertex " + shortest_text(v) + " of " + std::to_string(rows));
        order.push_back(static_cast<std::uint32_t>(v));
      }
    } else {
      for (std::uint32_t i = 0; i < rows; ++i) order.push_back(i);
    }
    if (mode == 4 && order.size() % 3 != 0)
      primitive.refuse("has " + std::to_string(order.size()) + " corners, no multiple of 3");
    mesh.triangles = triangles(order, mode);
    return mesh;
  }

  void read_camera(const Item& node, const Motion& motion) {
    const Item index = node["camera"], entry = source_.root().named("cameras", index);
    std::string& name = cameras_[index.count()];
    if (name.empty()) {
      name = unused_name(imported_.document.cameras, entry["name"].text(""), "camera");
      imported_.document.cameras[name] = camera_of(entry);
    }
    if (!is_rotation(motion.linear)) lose(node, "a camera that is scaled", "it as it would be without");
    manifest::PlannedImage image;
    image.id = node["name"].text("");
    if (image.id.empty()) image.id = "view";
    for (int i = 2; !image_names_.insert(image.id).second; ++i)
      image.id = node["name"].text("view") + "-" + std::to_string(i);
    image.camera = name;
    image.world_from_camera.rotation = normalized(turn_without_scale(motion.linear) * Quaternion{0, 1, 0, 0});
    image.world_from_camera.translation_m = motion.offset;
    cameras_of_scene_.push_back(std::move(image));
  }

  // By the directions of -z and y alone.
  static Quaternion turn_without_scale(const Mat3& linear) {
    if (is_rotation(linear)) return rotation_of(linear);
    const Vec3 z = normalized(linear * Vec3{0, 0, 1}), x = normalized(cross(linear * Vec3{0, 1, 0}, z)),
               y = cross(z, x);
    return quaternion_of(Mat3{{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}});
  }

  manifest::Camera camera_of(const Item& entry) {
    manifest::Camera camera;
    const bool orthographic = entry["type"].text() == "orthographic";
    const Item lens = entry[orthographic ? "orthographic" : "perspective"], ours = entry["extras"]["gonio"];
    const double tangent = orthographic ? 0 : std::tan(lens["yfov"].number() / 2);
    const double x = orthographic ? lens["xmag"].number() : tangent * lens["aspectRatio"].number(16.0 / 9);
    const double y = orthographic ? lens["ymag"].number() : tangent;
    if (!(x > 1e-9 && x < 1e9) || !(y > 1e-9 && y < 1e9)) lens.refuse("has no field that could be seen");
    if (!ours["height_px"].there()) lose(entry, "a camera without a number of pixels", "a picture 1080 px high");
    const std::uint64_t height = ours["height_px"].count(1080);
    const std::uint64_t width = ours["width_px"].count(
        static_cast<std::uint64_t>(std::clamp(std::round(static_cast<double>(height) * x / y), 1.0, 1e6)));
    if (height == 0 || width == 0 || height > 65536 || width > 65536) ours.refuse("is no size of a picture");
    camera.width_px = static_cast<int>(width);
    camera.height_px = static_cast<int>(height);
    const double fx = camera.width_px / (2 * x), fy = camera.height_px / (2 * y);
    camera.cx_px = ours["cx_px"].number((camera.width_px - 1) / 2.0);
    camera.cy_px = ours["cy_px"].number((camera.height_px - 1) / 2.0);
    camera.model = orthographic ? "orthographic" : "pinhole";
    if (orthographic) {
      camera.px_per_m = fx;
      if (std::abs(fy / fx - 1) > 1e-3) lose(lens, "an orthographic camera of oblong pixels", "square ones");
    } else {
      camera.fx_px = fx;
      camera.fy_px = fy;
    }
    return camera;
  }

  void read_lamp(const Item& node, const Item& index, const Motion& motion) {
    const Item entry = source_.root()["extensions"]["KHR_lights_punctual"].named("lights", index);
    manifest::Light light = light_of(entry, motion);
    manifest::values_of(*manifest::find_model(manifest::Family::light, light.model), light.parameters, entry.place());
    std::string name = node["name"].text("");
    if (name.empty()) name = entry["name"].text("");
    if (name.empty()) name = "light";
    auto& all = imported_.document.lights;
    const auto same = [&](const manifest::Light& other) {
      return other.model == light.model && other.parameters == light.parameters;
    };
    if (const auto found = all.find(name); found == all.end() || !same(found->second)) {
      // The same lamp under another number, from another scene?
      const auto twin =
          std::ranges::find_if(all, [&](const auto& l) { return l.first.starts_with(name + "-") && same(l.second); });
      name = twin != all.end() ? twin->first : unused_name(all, name, "light");
      all[name] = std::move(light);
    }
    if (std::ranges::find(lamps_of_scene_, name) == lamps_of_scene_.end()) lamps_of_scene_.push_back(name);
  }

  manifest::Light light_of(const Item& entry, const Motion& motion) {
    const std::vector<double> colour = entry["color"].numbers(3, {1, 1, 1});
    const double intensity = entry["intensity"].number(1) / lumens_per_watt;
    const manifest::Parameter value(
        std::vector<double>{colour[0] * intensity, colour[1] * intensity, colour[2] * intensity});
    const auto list = [](Vec3 v) { return manifest::Parameter(std::vector<double>{v.x, v.y, v.z}); };
    const Vec3 axis = normalized(motion.linear * Vec3{0, 0, -1});
    const std::string type = entry["type"].text();
    const Item ours = entry["extras"]["gonio"];
    manifest::Light light;
    if (entry["range"].there()) lose(entry["range"], "light that ends at a range", "light that goes on");
    if (type == "directional") {
      light.model = "directional";
      light.parameters = {{"towards", list(-axis)}, {"watt_per_m2", value}};
      return light;
    }
    light.parameters = {{"position_m", list(motion.offset)}, {"watt_per_sr", value}};
    if (type == "point") {
      light.model = ours["radius_m"].there() ? "sphere" : "point";
      if (ours["radius_m"].there()) light.parameters["radius_m"] = ours["radius_m"].number();
      return light;
    }
    if (type != "spot") entry["type"].refuse("is \"" + type + "\"; point, spot and directional lights are read");
    light.parameters["direction"] = list(axis);
    if (ours["width_m"].there()) {
      light.model = "rectangle";
      light.parameters["up"] = list(normalized(motion.linear * Vec3{0, -1, 0}));
      light.parameters["width_m"] = ours["width_m"].number();
      light.parameters["height_m"] = ours["height_m"].number();
    } else if (ours["radius_m"].there()) {
      light.model = "disc";
      light.parameters["radius_m"] = ours["radius_m"].number();
    } else {
      light.model = "spot";
      const double outer = entry["spot"]["outerConeAngle"].number(pi / 4);
      light.parameters["outer_rad"] = outer;
      if (!(outer > 0)) entry["spot"].refuse("has no opening");
      light.parameters["inner_share"] = std::clamp(entry["spot"]["innerConeAngle"].number(0) / outer, 0.0, 1.0);
    }
    return light;
  }

  Source source_;
  Imported imported_;
  MaterialReader materials_;
  std::set<std::string> walked_, shown_, object_names_, image_names_;
  std::map<std::string, std::string> meshes_;
  std::map<std::uint64_t, std::string> cameras_;
  std::vector<std::string> lamps_of_scene_;
  std::vector<manifest::PlannedImage> cameras_of_scene_;
};

}  // namespace

Imported read_scene(const std::filesystem::path& path) {
  return Reader(path).read();
}

}  // namespace gonio::scene::gltf2
