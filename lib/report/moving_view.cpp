// See moving_view.h.
#include "report/moving_view.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "base/text.h"
#include "manifest/value.h"
#include "report/colour_map.h"
#include "report/page.h"

namespace gonio::report {
namespace {

using io::ModelNode;
using io::MovingModel;
using manifest::Value;

constexpr std::size_t looked_at_keys = 24;  // spread over all, for the extent of what moves

std::string floats(const std::vector<float>& values) {
  std::string bytes;
  for (const float v : values) append_bytes(bytes, std::bit_cast<std::uint32_t>(v), 4);
  return base64(bytes);
}

// A shape: 16 bits a coordinate in the cube about it; indices of 16 bits where that is enough, else of 32.
std::string shape_data(const io::TriangleMesh& mesh) {
  Vec3 low = mesh.positions_m.empty() ? Vec3{} : mesh.positions_m.front(), high = low;
  for (const Vec3 p : mesh.positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double extent = max_component(high - low), side = extent > 0 ? extent : 1;
  std::string positions, indices;
  for (const Vec3 p : mesh.positions_m)
    for (int i = 0; i < 3; ++i)
      append_bytes(positions, static_cast<std::uint32_t>(std::lround((p[i] - low[i]) / side * 65535)), 2);
  const int wide = mesh.positions_m.size() <= 65536 ? 2 : 4;
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t i : t) append_bytes(indices, i, wide);
  return format(
             "<script type=\"text/plain\" class=\"shape\" data-low=\"%.9g %.9g %.9g\" data-side=\"%.9g\" "
             "data-wide=\"%d\" data-indices=\"",
             low.x, low.y, low.z, side, wide) +
         base64(indices) + "\">" + base64(positions) + "</script>";
}

double rounded(double value) {
  return std::round(value * 1e9) / 1e9;
}

// [parent, hinge, shape, colour, [x, y, z, qw, qx, qy, qz], label, [[from_s, colour], ...]]; what is empty at the end
// is left out.
Value node_data(const ModelNode& node) {
  const Vec3 t = node.placed.translation_m;
  const Quaternion q = normalized(node.placed.rotation);
  std::vector<double> place{t.x, t.y, t.z, q.w, q.x, q.y, q.z};
  for (double& v : place) v = rounded(v);
  Value entry(Value::Array{node.parent, node.hinge, node.mesh, node.colour, Value(place)});
  if (node.label.empty() && node.changes.empty()) return entry;
  entry.push_back(node.label);
  Value changes = Value::array();
  for (const io::ColourChange& change : node.changes)
    changes.push_back(Value(Value::Array{rounded(change.from_s), change.colour}));
  if (!node.changes.empty()) entry.push_back(std::move(changes));
  return entry;
}

// JSON inside an element of script: nothing in it may end the element.
std::string embedded(const Value& value) {
  std::string text;
  for (const char c : manifest::print_json(value, -1)) {
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  }
  return text;
}

}  // namespace

void append_bytes(std::string& bytes, std::uint32_t value, int count) {
  for (int k = 0; k < count; ++k) bytes += static_cast<char>(value >> (8 * k) & 255u);
}

std::vector<Vec3> points_in_view(const MovingModel& model) {
  const bool some = std::ranges::any_of(model.nodes, [](const ModelNode& n) { return n.mesh >= 0 && !n.surroundings; });
  std::vector<Vec3> points;
  const std::size_t looks = std::min(looked_at_keys, model.keys.size());
  for (std::size_t k = 0; k < looks; ++k) {
    const std::size_t at = looks > 1 ? k * (model.keys.size() - 1) / (looks - 1) : 0;
    const auto places = io::placed_nodes(model, model.keys[at].time_s);
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
      const ModelNode& node = model.nodes[i];
      if (node.mesh < 0 || (some && node.surroundings)) continue;
      for (const Vec3 p : model.meshes[static_cast<std::size_t>(node.mesh)].positions_m)
        points.push_back(places[i].rotation * p + places[i].origin_m);
    }
  }
  return points;
}

void each_triangle(const MovingModel& model, double time_s,
                   const std::function<void(const std::array<Vec3, 3>&, const std::array<float, 3>&)>& take) {
  const auto places = io::placed_nodes(model, time_s);
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const ModelNode& node = model.nodes[i];
    if (node.mesh < 0) continue;
    const io::TriangleMesh& mesh = model.meshes[static_cast<std::size_t>(node.mesh)];
    const auto& colour = model.palette.at(static_cast<std::size_t>(io::colour_at(node, time_s)));
    for (const auto& t : mesh.triangles) {
      std::array<Vec3, 3> corners;
      for (std::size_t c = 0; c < 3; ++c) corners[c] = places[i].rotation * mesh.positions_m[t[c]] + places[i].origin_m;
      take(corners, colour);
    }
  }
}

std::string data_of(const MovingModel& model) {
  std::string data;
  for (const io::TriangleMesh& mesh : model.meshes) data += shape_data(mesh);
  Value nodes = Value::array(), palette = Value::array(), words = Value::array();
  for (const ModelNode& node : model.nodes) nodes.push_back(node_data(node));
  for (const auto& colour : model.palette) palette.push_back(hex(colour));
  for (const io::ModelWords& w : model.words)
    words.push_back(Value(Value::Array{rounded(w.from_s), w.words, w.stop ? 1 : 0}));
  std::vector<float> times, angles;
  for (const io::ModelKey& key : model.keys) {
    times.push_back(static_cast<float>(key.time_s));
    for (const double a : key.angles_rad) angles.push_back(static_cast<float>(a));
  }
  return data + "<script type=\"application/json\" class=\"model\">" +
         embedded(Value::object({{"palette", palette}, {"nodes", nodes}, {"words", words}})) +
         "</script><script type=\"text/plain\" class=\"times\" data-times=\"" + floats(times) + "\">" + floats(angles) +
         "</script>";
}

std::string legend_of(const MeshView& view) {
  std::string text;
  for (const ColourKey& key : view.legend)
    text += "<span><i style=\"background:" + hex(view.moving.palette.at(static_cast<std::size_t>(key.colour))) +
            "\"></i>" + escape(key.words) + "</span>";
  return text.empty() ? text : "<div class=\"keys\">" + text + "</div>";
}

}  // namespace gonio::report
