// See scene/exchange/moving_gltf.h.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "io/picture.h"
#include "report/page.h"
#include "scene/exchange/gltf/buffer.h"
#include "scene/exchange/gltf/gltf.h"
#include "scene/exchange/moving_gltf.h"

namespace gonio::scene {
namespace {

using gltf2::Buffer;
using gltf2::List;
using manifest::Value;

// Slerp takes the shorter way: between two keys no hinge turns by more.
constexpr double most_turn_rad = 2;

Value quaternion_list(const Quaternion& q) {
  return Value(std::vector<double>{q.x, q.y, q.z, q.w});
}

Quaternion turn_about_z(double angle) {
  return {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
}

// Times rise in single precision; long turns are cut.
std::vector<io::ModelKey> animation_keys(const io::MovingModel& model) {
  std::vector<io::ModelKey> keys;
  const auto enter = [&keys](double time, std::vector<double> angles) {
    auto single = static_cast<float>(time);
    if (!keys.empty() && !(double{single} > keys.back().time_s))
      single = std::nextafter(static_cast<float>(keys.back().time_s), std::numeric_limits<float>::infinity());
    keys.push_back({single, std::move(angles)});
  };
  for (std::size_t k = 0; k < model.keys.size(); ++k) {
    const io::ModelKey& to = model.keys[k];
    if (k > 0) {
      const io::ModelKey& from = model.keys[k - 1];
      double largest = 0;
      for (std::size_t h = 0; h < to.angles_rad.size(); ++h)
        largest = std::max(largest, std::abs(to.angles_rad[h] - from.angles_rad[h]));
      const int pieces = std::max(1, static_cast<int>(std::ceil(largest / most_turn_rad)));
      for (int i = 1; i < pieces; ++i) {
        const double time = from.time_s + (to.time_s - from.time_s) * i / pieces;
        enter(time, io::angles_at(model, time));
      }
    }
    enter(to.time_s, to.angles_rad);
  }
  return keys;
}

class ModelWriter {
 public:
  explicit ModelWriter(const io::MovingModel& model) : model_(model) {}

  std::string write(bool binary) {
    Value root = Value::object({{"asset", Value::object({{"version", "2.0"}, {"generator", "gonio"}})}});
    write_nodes();
    const Value moving = animation();
    Value scene = Value::object({{"name", "laboratory"}, {"nodes", Value(Value::Array{add(world_node())})}});
    Value stops = Value::array();
    for (const io::ModelWords& words : model_.words)
      if (words.stop) stops.push_back(Value::object({{"time_s", words.from_s}, {"name", words.words}}));
    if (!stops.as_array().empty())
      scene["extras"] = Value::object({{"gonio", Value::object({{"stops", std::move(stops)}})}});
    root["scene"] = 0;
    root["scenes"] = Value(Value::Array{std::move(scene)});
    root["nodes"] = nodes_;
    for (const auto& [key, list] :
         {std::pair<const char*, const List*>{"cameras", &cameras_}, {"meshes", &meshes_}, {"materials", &materials_}})
      if (!list->empty()) root[key] = list->value();
    if (!moving.is_null()) root["animations"] = Value(Value::Array{moving});
    if (!lights_.empty()) {
      root["extensionsUsed"].push_back("KHR_lights_punctual");
      root["extensions"]["KHR_lights_punctual"]["lights"] = lights_.value();
    }
    if (binary) {
      buffer_.describe(root, "");
      return gltf2::binary_file(root, buffer_.bytes());
    }
    buffer_.describe(root, "data:application/octet-stream;base64," + report::base64(buffer_.bytes()));
    return manifest::print_json(root) + "\n";
  }

 private:
  int add(Value node) {
    nodes_.push_back(std::move(node));
    return static_cast<int>(nodes_.as_array().size()) - 1;
  }
  void hang(int parent, int child) {
    if (parent < 0)
      top_.push_back(child);
    else
      nodes_.as_array()[static_cast<std::size_t>(parent)]["children"].push_back(child);
  }
  Value world_node() {
    Value node = Value::object({{"name", "world"}, {"rotation", quaternion_list(gltf2::gltf_from_world())}});
    if (!top_.as_array().empty()) node["children"] = top_;
    return node;
  }

  void write_nodes() {
    const std::vector<double> first = model_.keys.empty() ? std::vector<double>{} : model_.keys.front().angles_rad;
    for (const io::ModelNode& node : model_.nodes) {
      Quaternion turn = node.placed.rotation;
      if (node.hinge >= 0) turn = turn * turn_about_z(first.at(static_cast<std::size_t>(node.hinge)));
      const Vec3 at = node.placed.translation_m;
      Value entry = Value::object({{"name", node.name},
                                   {"translation", Value(std::vector<double>{at.x, at.y, at.z})},
                                   {"rotation", quaternion_list(normalized(turn))}});
      if (node.mesh >= 0 && !model_.meshes[static_cast<std::size_t>(node.mesh)].triangles.empty())
        entry["mesh"] = mesh(node);
      if (node.watt_per_sr) entry["extensions"]["KHR_lights_punctual"]["light"] = lights_.add(light(node));
      hang(node.parent, add(std::move(entry)));
    }
    for (std::size_t i = 0; i < model_.nodes.size(); ++i)
      if (const auto& lens = model_.nodes[i].lens) {
        const std::string& name = model_.nodes[i].name;
        hang(static_cast<int>(i), add(Value::object({{"name", name + " camera"},
                                                     {"camera", cameras_.add(camera(*lens, name))},
                                                     {"rotation", quaternion_list({0, 1, 0, 0})}})));
      }
  }

  int mesh(const io::ModelNode& node) {
    Value& geometry = geometry_[node.mesh];
    if (geometry.is_null()) {
      const io::TriangleMesh& shape = model_.meshes[static_cast<std::size_t>(node.mesh)];
      std::vector<double> flat;
      for (const Vec3 p : shape.positions_m) flat.insert(flat.end(), {p.x, p.y, p.z});
      geometry = Value::object({{"attributes", Value::object({{"POSITION", buffer_.vertices(flat, 3, true)}})},
                                {"indices", buffer_.indices(shape.triangles)}});
    }
    Value primitive = geometry;
    primitive["material"] = material(node.colour);
    return meshes_.add(Value::object({{"primitives", Value(Value::Array{primitive})}}));
  }

  int material(int colour) {
    std::vector<double> factor;
    for (const float code : model_.palette.at(static_cast<std::size_t>(colour)))
      factor.push_back(double{io::linear_from_srgb(code)});
    factor.push_back(1);
    return materials_.add(Value::object(
        {{"doubleSided", true},
         {"pbrMetallicRoughness",
          Value::object({{"baseColorFactor", Value(factor)}, {"metallicFactor", 0}, {"roughnessFactor", 0.7}})}}));
  }

  static Value light(const io::ModelNode& node) {
    const double most = max_component(*node.watt_per_sr);
    const Vec3 colour = most > 0 ? *node.watt_per_sr / most : Vec3{1, 1, 1};
    return Value::object({{"name", node.name},
                          {"type", "point"},
                          {"color", Value(std::vector<double>{colour.x, colour.y, colour.z})},
                          {"intensity", most * gltf2::lumens_per_watt}});
  }

  static Value camera(const io::ModelLens& lens, const std::string& name) {
    Value entry = Value::object({{"name", name}});
    if (lens.orthographic) {
      entry["type"] = "orthographic";
      entry["orthographic"] = Value::object(
          {{"xmag", lens.half_height_m * lens.aspect}, {"ymag", lens.half_height_m}, {"znear", 0}, {"zfar", 100}});
    } else {
      entry["type"] = "perspective";
      entry["perspective"] = Value::object({{"aspectRatio", lens.aspect}, {"yfov", lens.yfov_rad}, {"znear", 0.001}});
    }
    return entry;
  }

  // Null where nothing moves.
  Value animation() {
    const std::vector<io::ModelKey> keys = animation_keys(model_);
    if (keys.size() < 2) return {};
    int input = -1;
    Value channels = Value::array(), samplers = Value::array();
    for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
      const io::ModelNode& node = model_.nodes[i];
      if (node.hinge < 0) continue;
      const auto h = static_cast<std::size_t>(node.hinge);
      if (std::ranges::all_of(keys, [&](const io::ModelKey& k) { return k.angles_rad[h] == keys[0].angles_rad[h]; }))
        continue;
      std::vector<double> turns;
      for (const io::ModelKey& key : keys) {
        const Quaternion q = normalized(node.placed.rotation * turn_about_z(key.angles_rad[h]));
        turns.insert(turns.end(), {q.x, q.y, q.z, q.w});
      }
      if (input < 0) {
        std::vector<double> times;
        for (const io::ModelKey& key : keys) times.push_back(key.time_s);
        input = buffer_.samples(times, 1, true);
      }
      samplers.push_back(
          Value::object({{"input", input}, {"interpolation", "LINEAR"}, {"output", buffer_.samples(turns, 4, false)}}));
      channels.push_back(
          Value::object({{"sampler", static_cast<std::int64_t>(samplers.as_array().size()) - 1},
                         {"target", Value::object({{"node", static_cast<std::int64_t>(i)}, {"path", "rotation"}})}}));
    }
    if (input < 0) return {};
    return Value::object({{"name", "plan"}, {"channels", std::move(channels)}, {"samplers", std::move(samplers)}});
  }

  const io::MovingModel& model_;
  Buffer buffer_;
  List cameras_, meshes_, materials_, lights_;
  Value nodes_ = Value::array(), top_ = Value::array();
  std::map<int, Value> geometry_;
};

}  // namespace

std::string gltf_of(const io::MovingModel& model, bool binary) {
  return ModelWriter(model).write(binary);
}

}  // namespace gonio::scene
