// See urdf.h.
#include "io/urdf.h"

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"

namespace gonio::io {
namespace {

constexpr std::uint64_t most_urdf_bytes = 1 << 26;

std::string place_in_urdf(const std::string& file, std::string_view text, std::ptrdiff_t offset) {
  const auto end = text.begin() + std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(text.size()));
  return file + ":" + std::to_string(1 + std::count(text.begin(), end, '\n'));
}

struct UrdfText {
  std::string_view text;
  const std::string& file;

  std::string place(pugi::xml_node node) const { return place_in_urdf(file, text, node.offset_debug()); }

  std::string attribute(pugi::xml_node node, const char* name) const {
    const pugi::xml_attribute a = node.attribute(name);
    if (!a || *a.value() == 0)
      throw Error(Exit::data, place(node), "<" + std::string(node.name()) + "> has no " + name);
    return a.value();
  }

  std::vector<double> numbers(pugi::xml_node node, const char* name, std::size_t count) const {
    std::vector<double> found;
    std::istringstream words(attribute(node, name));
    for (std::string word; words >> word;) {
      char* end = nullptr;
      const double value = std::strtod(word.c_str(), &end);
      if (end != word.c_str() + word.size() || !std::isfinite(value))
        throw Error(Exit::data, place(node), "\"" + word.substr(0, 40) + "\" in " + name + " is no finite number");
      found.push_back(value);
    }
    if (found.size() != count)
      throw Error(Exit::data, place(node),
                  std::string(name) + " has " + std::to_string(found.size()) + " numbers where " +
                      std::to_string(count) + " are expected");
    return found;
  }

  double number(pugi::xml_node node, const char* name) const { return numbers(node, name, 1)[0]; }

  Vec3 vector(pugi::xml_node node, const char* name, Vec3 otherwise) const {
    if (!node.attribute(name)) return otherwise;
    const std::vector<double> n = numbers(node, name, 3);
    return {n[0], n[1], n[2]};
  }

  UrdfOrigin origin(pugi::xml_node parent) const {
    const pugi::xml_node node = parent.child("origin");
    return {vector(node, "xyz", {}), vector(node, "rpy", {})};
  }

  UrdfCollision collision(pugi::xml_node node) const {
    UrdfCollision c{origin(node), UrdfForm::mesh, "", {1, 1, 1}, {}};
    const pugi::xml_node geometry = node.child("geometry");
    if (const auto mesh = geometry.child("mesh")) {
      c.mesh = attribute(mesh, "filename");
      c.scale = vector(mesh, "scale", {1, 1, 1});
    } else if (const auto box = geometry.child("box")) {
      c.form = UrdfForm::box;
      attribute(box, "size");
      c.size_m = vector(box, "size", {});
    } else if (const auto cylinder = geometry.child("cylinder")) {
      c.form = UrdfForm::cylinder;
      c.size_m = {number(cylinder, "radius"), number(cylinder, "length"), 0};
    } else if (const auto sphere = geometry.child("sphere")) {
      c.form = UrdfForm::sphere;
      c.size_m = {number(sphere, "radius"), 0, 0};
    } else {
      throw Error(Exit::data, place(node), "<collision> has no mesh, box, cylinder or sphere");
    }
    return c;
  }

  UrdfJoint joint(pugi::xml_node node) const {
    UrdfJoint j;
    j.name = attribute(node, "name");
    j.type = attribute(node, "type");
    j.parent = attribute(node.child("parent") ? node.child("parent") : node, "link");
    j.child = attribute(node.child("child") ? node.child("child") : node, "link");
    j.origin = origin(node);
    j.axis = vector(node.child("axis"), "xyz", {1, 0, 0});
    j.mimics = static_cast<bool>(node.child("mimic"));
    const pugi::xml_node limit = node.child("limit");
    if (j.type == "revolute" && limit.attribute("lower")) j.lower_rad = number(limit, "lower");
    if (j.type == "revolute" && limit.attribute("upper")) j.upper_rad = number(limit, "upper");
    if (limit.attribute("velocity")) j.speed_rad_per_s = number(limit, "velocity");
    if (j.lower_rad > j.upper_rad)
      throw Error(Exit::data, place(limit), "joint \"" + j.name + "\" has its lower limit above its upper one");
    return j;
  }
};

struct MacroSearch : pugi::xml_tree_walker {
  pugi::xml_node found;
  bool for_each(pugi::xml_node& node) override {
    bool macro = std::string_view(node.name()).starts_with("xacro:");
    for (const auto a : node.attributes()) macro |= std::string_view(a.value()).find("${") != std::string_view::npos;
    if (macro) found = node;
    return !macro;
  }
};

}  // namespace

Urdf parse_urdf(std::string_view text, const std::string& file) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size(), pugi::parse_default);
  if (!result)
    throw Error(Exit::data, place_in_urdf(file, text, result.offset),
                std::string("is no XML: ") + result.description());
  const UrdfText urdf{text, file};
  const pugi::xml_node robot = document.child("robot");
  if (!robot) throw Error(Exit::data, file, "has no <robot>", "give a robot description (URDF)");
  MacroSearch search;
  document.traverse(search);
  if (search.found)
    throw Error(Exit::data, urdf.place(search.found), "<" + std::string(search.found.name()) + "> is a macro of xacro",
                "expand it: xacro in.xacro > out.urdf");
  Urdf out{robot.attribute("name").value(), {}, {}};
  for (const auto node : robot.children("link")) {
    UrdfLink link{urdf.attribute(node, "name"), {}};
    for (const auto c : node.children("collision")) link.collisions.push_back(urdf.collision(c));
    out.links.push_back(std::move(link));
  }
  for (const auto node : robot.children("joint")) out.joints.push_back(urdf.joint(node));
  return out;
}

Urdf read_urdf(const std::filesystem::path& path) {
  return parse_urdf(read_file(path, most_urdf_bytes), path.filename().string());
}

}  // namespace gonio::io
