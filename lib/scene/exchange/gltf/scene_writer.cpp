// A scene as glTF 2.0 (scene/exchange/formats/gltf.cpp): geometry, nodes, cameras, lamps.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "scene/exchange/geometry.h"
#include "scene/exchange/gltf/buffer.h"
#include "scene/exchange/gltf/gltf.h"
#include "scene/exchange/lamp.h"
#include "scene/exchange/lens.h"

namespace gonio::scene::gltf2 {
namespace {

using manifest::Value;

Value list(Vec3 v) {
  return Value(std::vector<double>{v.x, v.y, v.z});
}
Value list(Quaternion q) {
  return Value(std::vector<double>{q.x, q.y, q.z, q.w});
}
template <class To, class From>
void place(Value& node, const Rigid<To, From>& pose) {
  node["rotation"] = list(normalized(pose.rotation));
  node["translation"] = list(pose.translation_m);
}

double smallest_extent(const io::TriangleMesh& mesh) {
  Vec3 low{1e300, 1e300, 1e300}, high = -low;
  for (const Vec3 p : mesh.positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return std::min({high.x - low.x, high.y - low.y, high.z - low.z});
}

class Writer {
 public:
  explicit Writer(const Scene& scene) : scene_(scene), materials_(out_) {}

  Exported write() {
    write_materials();
    write_objects();
    for (const Light& light : scene_.appearance.lights) lamps_.push_back(lamp_of(light, out_.losses));
    for (const View& view : scene_.views) write_view(view);
    Value root = Value::object({{"asset", Value::object({{"version", "2.0"}, {"generator", "gonio"}})}});
    if (!scenes_.as_array().empty()) root["scene"] = 0;
    root["scenes"] = scenes_.as_array().empty() ? Value(Value::Array{Value::object({{"nodes", objects_}})}) : scenes_;
    root["nodes"] = nodes_;
    if (!cameras_.empty()) root["cameras"] = cameras_.value();
    root["meshes"] = meshes_.value();
    materials_.finish(root);
    if (!lights_.empty()) {
      root["extensionsUsed"].push_back("KHR_lights_punctual");
      root["extensions"]["KHR_lights_punctual"]["lights"] = lights_.value();
    }
    buffer_.describe(root, "scene.bin");
    if (!buffer_.bytes().empty()) out_.files.push_back({"scene.bin", buffer_.bytes()});
    out_.files.insert(out_.files.begin(), {"scene.gltf", manifest::print_json(root) + "\n"});
    return std::move(out_);
  }

 private:
  void lose(const std::string& pointer, std::string what, std::string instead) {
    out_.losses.push_back({pointer, std::move(what), std::move(instead)});
  }
  int add_node(Value node) {
    nodes_.push_back(std::move(node));
    return static_cast<int>(nodes_.as_array().size()) - 1;
  }

  // Those that an object shows; glass as thick as the thinnest of its objects.
  void write_materials() {
    const auto& surfaces = scene_.appearance.surfaces;
    std::vector<double> size(surfaces.size(), std::numeric_limits<double>::infinity());
    for (const Instance& instance : scene_.instances)
      size[instance.surface] = std::min(size[instance.surface], smallest_extent(triangles_of(instance.shape)));
    for (std::size_t i = 0; i < surfaces.size(); ++i)
      material_of_.push_back(std::isfinite(size[i]) ? materials_.write(scene_, surfaces[i], size[i]) : -1);
  }

  void write_objects() {
    Value children = Value::array();
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      const std::string pointer = "/objects/" + std::to_string(i);
      if (std::holds_alternative<Sphere>(instance.shape))
        lose(pointer, "a sphere", format("triangles that leave at most %.0e of its radius", sagitta_of_sphere(1e-4)));
      if (instance.priority != 0)
        lose(pointer + "/priority", "priorities of overlapping media", "each interface against air");
      Value node = Value::object({{"name", instance.id}, {"mesh", mesh(instance)}});
      place(node, instance.world_from_object);
      children.push_back(add_node(std::move(node)));
    }
    objects_.push_back(add_node(Value::object(
        {{"name", "objects"}, {"rotation", list(gltf_from_world())}, {"children", std::move(children)}})));
  }

  int mesh(const Instance& instance) {
    const auto* shared = std::get_if<std::shared_ptr<const mesh::Mesh>>(&instance.shape);
    Value& known = geometry_[shared ? shared->get() : nullptr];
    Value primitive = shared && !known.is_null() ? known : known = geometry(triangles_of(instance.shape));
    primitive["material"] = material_of_[instance.surface];
    return meshes_.add(Value::object({{"primitives", Value(Value::Array{primitive})}}));
  }

  Value geometry(const io::TriangleMesh& mesh) {
    const auto flat = [](const std::vector<Vec3>& all) {
      std::vector<double> v;
      for (const Vec3 p : all) v.insert(v.end(), {p.x, p.y, p.z});
      return v;
    };
    Value attributes = Value::object({{"POSITION", buffer_.vertices(flat(mesh.positions_m), 3, true)}});
    if (!mesh.normals.empty()) attributes["NORMAL"] = buffer_.vertices(flat(mesh.normals), 3, false);
    if (!mesh.texture.empty()) {
      std::vector<double> uv;
      for (const Vec2 t : mesh.texture) uv.insert(uv.end(), {t.x, 1 - t.y});
      attributes["TEXCOORD_0"] = buffer_.vertices(uv, 2, false);
    }
    return Value::object({{"attributes", attributes}, {"indices", buffer_.indices(mesh.triangles)}});
  }

  void write_view(const View& view) {
    Value children = Value::array();
    children.push_back(camera_node(view));
    for (const std::size_t i : view.lights) {
      Lamp lamp = lamps_[i];
      if (lamp.infinite()) {
        lose("/lights/" + lamp.id, "surroundings", "no light from them");
        continue;
      }
      lamp.value *= view.gain;
      children.push_back(lamp_node(lamp));
    }
    if (scene_.appearance.ambient) lose("/mechanisms/light.ambient", "surroundings", "no light from them");
    Value nodes = objects_;
    nodes.push_back(add_node(Value::object(
        {{"name", "image " + view.image}, {"rotation", list(gltf_from_world())}, {"children", std::move(children)}})));
    scenes_.push_back(Value::object({{"name", view.image}, {"nodes", std::move(nodes)}}));
  }

  // An orthographic camera moves so that its axis meets the middle of the picture.
  int camera_node(const View& view) {
    const Lens lens = lens_of(view);
    const double right = (lens.width - 1) / 2.0 - lens.cx, down = (lens.height - 1) / 2.0 - lens.cy;
    Rigid<frame::World, frame::Camera> pose = view.world_from_camera;
    if (lens.orthographic) pose.translation_m += pose.rotate({right / lens.fx, down / lens.fy, 0});
    const std::string pointer = "/cameras/" + view.camera_name;
    if (!lens.orthographic && std::max(std::abs(right), std::abs(down)) > 0.05)
      lose(pointer, "a principal point off the middle",
           format("the picture moved by %.3g px", std::hypot(right, down)));
    if (!lens.orthographic && view.lens.aperture_radius_m > 0)
      lose("/mechanisms/optics.defocus", "a lens with an aperture", "a pinhole");
    Value node = Value::object({{"name", view.image}, {"camera", cameras_.add(camera(lens, view.camera_name))}});
    pose.rotation = pose.rotation * Quaternion{0, 1, 0, 0};
    place(node, pose);
    return add_node(std::move(node));
  }

  static Value camera(const Lens& lens, const std::string& name) {
    Value entry = Value::object({{"name", name}});
    Value extras = Value::object({{"width_px", lens.width}, {"height_px", lens.height}});
    if (lens.orthographic) {
      entry["type"] = "orthographic";
      entry["orthographic"] = Value::object(
          {{"xmag", lens.width / (2 * lens.fx)}, {"ymag", lens.height / (2 * lens.fy)}, {"znear", 0}, {"zfar", 1e4}});
    } else {
      entry["type"] = "perspective";
      entry["perspective"] = Value::object({{"aspectRatio", lens.width / lens.fx / (lens.height / lens.fy)},
                                            {"yfov", 2 * std::atan(lens.height / (2 * lens.fy))},
                                            {"znear", 1e-4}});
      extras["cx_px"] = lens.cx;
      extras["cy_px"] = lens.cy;
    }
    entry["extras"] = Value::object({{"gonio", extras}});
    return entry;
  }

  int lamp_node(const Lamp& lamp) {
    Value node = Value::object({{"name", lamp.id}});
    if (lamp.kind != Lamp::Kind::directional) node["translation"] = list(lamp.position_m);
    if (lamp.kind != Lamp::Kind::point && lamp.kind != Lamp::Kind::ball) node["rotation"] = list(lamp.turn());
    node["extensions"]["KHR_lights_punctual"]["light"] = lights_.add(light(lamp));
    return add_node(std::move(node));
  }

  // Intensity on the axis; what the extension cannot say stands in `extras`.
  Value light(const Lamp& lamp) {
    using Kind = Lamp::Kind;
    const bool flat = lamp.kind == Kind::disc || lamp.kind == Kind::rectangle;
    const double area = lamp.kind == Kind::rectangle                         ? lamp.size_x_m * lamp.size_y_m
                        : lamp.kind == Kind::disc || lamp.kind == Kind::ball ? pi * lamp.radius_m * lamp.radius_m
                                                                             : 1;
    const Rgb value = lamp.value * area;
    const double most = max_component(value);
    const std::string pointer = "/lights/" + lamp.id;
    Value entry = Value::object({{"name", lamp.id},
                                 {"type", lamp.kind == Kind::directional    ? "directional"
                                          : flat || lamp.kind == Kind::spot ? "spot"
                                                                            : "point"},
                                 {"color", most > 0 ? list(value / most) : list(Rgb{1, 1, 1})},
                                 {"intensity", most * lumens_per_watt}});
    Value extras = Value::object();
    if (lamp.kind == Kind::spot || flat)
      entry["spot"] = Value::object({{"innerConeAngle", flat ? 0 : std::min(lamp.inner_rad, lamp.outer_rad * 0.999999)},
                                     {"outerConeAngle", flat ? pi / 2 : lamp.outer_rad}});
    lose_exponent(lamp, 0, out_.losses);
    if (lamp.kind == Kind::spot) lose(pointer, "the smooth edge of a cone", "one that the other program chooses");
    if (flat) lose(pointer, "a flat lamp", "a spot of the same intensity on its axis");
    if (lamp.kind == Kind::ball) lose(pointer, "the extent of a lamp", "a point of the same intensity");
    if (lamp.kind == Kind::ball || lamp.kind == Kind::disc) extras["radius_m"] = lamp.radius_m;
    if (lamp.kind == Kind::rectangle) {
      extras["width_m"] = lamp.size_x_m;
      extras["height_m"] = lamp.size_y_m;
    }
    if (!extras.as_object().empty()) entry["extras"] = Value::object({{"gonio", extras}});
    return entry;
  }

  const Scene& scene_;
  Exported out_;
  MaterialWriter materials_;
  Buffer buffer_;
  List meshes_, cameras_, lights_;
  Value nodes_ = Value::array(), scenes_ = Value::array(), objects_ = Value::array();
  std::vector<int> material_of_;
  std::vector<Lamp> lamps_;
  std::map<const mesh::Mesh*, Value> geometry_;
};

}  // namespace

Exported write_scene(const Scene& scene) {
  return Writer(scene).write();
}

}  // namespace gonio::scene::gltf2
