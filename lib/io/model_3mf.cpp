// See model_3mf.h. A transform of twelve numbers m takes a place (x, y, z) to (x, y, z, 1) M, M being their 4 x 3
// matrix row by row.
#include "io/model_3mf.h"

#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <pugixml.hpp>

#include "base/error.h"
#include "io/zip_file.h"

namespace gonio::io {
namespace {

constexpr std::uint64_t most_model_bytes = std::uint64_t{1} << 30;
constexpr std::size_t most_triangles = 100000000;
constexpr std::size_t most_placements = 1000000;
constexpr int deepest = 32;

struct Placed {
  Mat3 turn{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  Vec3 shift{};
  Vec3 operator()(Vec3 p) const { return turn * p + shift; }
};
Placed operator*(const Placed& outer, const Placed& inner) {
  return {outer.turn * inner.turn, outer(inner.shift)};
}

bool mirrors(const Mat3& turn) {
  return dot(cross({turn(0, 0), turn(0, 1), turn(0, 2)}, {turn(1, 0), turn(1, 1), turn(1, 2)}),
             {turn(2, 0), turn(2, 1), turn(2, 2)}) < 0;
}

class Model {
 public:
  Model(const pugi::xml_node& root, const std::string& place) : place_(place) {
    unit_m_ = unit_of(root.attribute("unit").as_string("millimeter"));
    for (const pugi::xml_node object : root.child("resources").children("object"))
      objects_[object.attribute("id").as_string()] = object;
    bool any = false;
    for (const pugi::xml_node item : root.child("build").children("item")) {
      any = true;
      add(item.attribute("objectid").as_string(), transform_of(item), 0);
    }
    if (!any)
      for (const auto& [id, object] : objects_)
        if (std::string_view(object.attribute("type").as_string("model")) == "model") add(id, {}, 0);
    if (mesh_.triangles.empty()) refuse("has no triangles");
  }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  [[noreturn]] void refuse(const std::string& problem) const {
    throw Error(Exit::data, place_, problem, "export or copy it again");
  }

  double unit_of(std::string_view name) const {
    static const std::map<std::string_view, double> units{{"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2},
                                                          {"inch", 0.0254}, {"foot", 0.3048},     {"meter", 1}};
    const auto found = units.find(name);
    if (found == units.end()) refuse("is in the unit \"" + std::string(name.substr(0, 20)) + "\", which there is not");
    return found->second;
  }

  double number(std::string_view text, const char* what) const {
    double value = 0;
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end.ec != std::errc{} || end.ptr != text.data() + text.size() || !std::isfinite(value))
      refuse("has \"" + std::string(text.substr(0, 20)) + "\" as " + what + ", where a number belongs");
    return value;
  }

  Placed transform_of(const pugi::xml_node& node) const {
    const pugi::xml_attribute attribute = node.attribute("transform");
    if (!attribute) return {};
    std::array<double, 12> m{};
    std::string_view rest = attribute.value();
    for (double& value : m) {
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
      const std::size_t end = std::min(rest.find_first_of(" \t\r\n"), rest.size());
      value = number(rest.substr(0, end), "a transform's number");
      rest.remove_prefix(end);
    }
    return {Mat3{{m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}}, {m[9], m[10], m[11]}};
  }

  void add(const std::string& id, const Placed& placed, int depth) {
    const auto found = objects_.find(id);
    if (found == objects_.end()) refuse("places object \"" + id.substr(0, 20) + "\", which it has not");
    if (++placements_ > most_placements) refuse("places more than " + std::to_string(most_placements) + " objects");
    if (depth > deepest) refuse("has objects within each other, more than " + std::to_string(deepest) + " deep");
    for (const pugi::xml_node component : found->second.child("components").children("component"))
      add(component.attribute("objectid").as_string(), placed * transform_of(component), depth + 1);
    if (const pugi::xml_node mesh = found->second.child("mesh")) add_mesh(mesh, placed, id);
  }

  void add_mesh(const pugi::xml_node& mesh, const Placed& placed, const std::string& id) {
    const std::size_t first = mesh_.positions_m.size();
    for (const pugi::xml_node v : mesh.child("vertices").children("vertex"))
      mesh_.positions_m.push_back(placed({number(v.attribute("x").value(), "x"), number(v.attribute("y").value(), "y"),
                                          number(v.attribute("z").value(), "z")}) *
                                  unit_m_);
    const std::size_t count = mesh_.positions_m.size() - first;
    const bool mirrored = mirrors(placed.turn);
    for (const pugi::xml_node t : mesh.child("triangles").children("triangle")) {
      std::array<std::uint32_t, 3> corners{};
      const char* names[] = {"v1", "v2", "v3"};
      for (std::size_t c = 0; c < 3; ++c) {
        const double at = number(t.attribute(names[c]).value(), names[c]);
        if (!(at >= 0 && at < static_cast<double>(count) && at == std::floor(at)))
          refuse("has a triangle in object \"" + id.substr(0, 20) + "\" with " + names[c] + " = " +
                 std::string(t.attribute(names[c]).value()).substr(0, 20) + ", and " + std::to_string(count) +
                 " vertices");
        corners[c] = static_cast<std::uint32_t>(first + static_cast<std::size_t>(at));
      }
      if (mirrored) std::swap(corners[1], corners[2]);
      mesh_.triangles.push_back(corners);
      if (mesh_.triangles.size() > most_triangles)
        refuse("places more than " + std::to_string(most_triangles) + " triangles");
    }
  }

  const std::string& place_;
  double unit_m_ = 1e-3;
  std::size_t placements_ = 0;
  std::map<std::string, pugi::xml_node> objects_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh parse_3mf_model(std::string_view xml, const std::string& place) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(xml.data(), xml.size());
  if (!parsed)
    throw Error(Exit::data, place, std::string("is no XML (") + parsed.description() + ")", "export or copy it again");
  return Model(document.child("model"), place).take();
}

TriangleMesh read_3mf(const std::filesystem::path& path) {
  const ZipReader zip(path, "3MF archive");
  // Where the specification puts it; others follow from the relations, which nobody is known to use.
  std::size_t model = zip.find("3D/3dmodel.model");
  for (std::size_t i = 0; model == zip.entries().size() && i < zip.entries().size(); ++i)
    if (zip.entries()[i].name.ends_with(".model")) model = i;
  if (model == zip.entries().size())
    throw Error(Exit::data, path.filename().string(), "has no 3D/3dmodel.model in it", "export or copy it again");
  return parse_3mf_model(zip.read(model, most_model_bytes), zip.place(model));
}

}  // namespace gonio::io
