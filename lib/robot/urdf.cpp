// See urdf.h.
#include "robot/urdf.h"

#include <algorithm>
#include <map>

#include "base/error.h"
#include "robot/axis_rows.h"

namespace gonio::robot {
namespace {

using Placed = Rigid<frame::Base, frame::Tool>;  // a link's frame in the base, all joints at zero

Rigid<frame::Tool, frame::Tool> moved_by(const io::UrdfOrigin& origin) {
  const auto turn = [](Vec3 v) { return quaternion_of_rotation_vector(v); };
  const Vec3 rpy = origin.rpy_rad;
  return {turn({0, 0, rpy.z}) * turn({0, rpy.y, 0}) * turn({rpy.x, 0, 0}), origin.xyz_m};
}

class LinkTree {
 public:
  LinkTree(const io::Urdf& urdf, const std::string& place) : urdf_(urdf), place_(place) {
    for (const io::UrdfLink& link : urdf.links)
      if (!links_.emplace(link.name, &link).second) refuse("link \"" + link.name + "\" is there twice");
    for (const io::UrdfJoint& joint : urdf.joints) {
      for (const std::string& link : {joint.parent, joint.child})
        if (!links_.contains(link))
          refuse("joint \"" + joint.name + "\" names the link \"" + link + "\", which is not there");
      if (!above_.emplace(joint.child, &joint).second) refuse("link \"" + joint.child + "\" hangs on two joints");
    }
  }

  std::string root() const {
    std::string found;
    for (const auto& [name, link] : links_) {
      if (above_.contains(name)) continue;
      if (!found.empty()) refuse("has two roots, \"" + found + "\" and \"" + name + "\"", "name the base link");
      found = name;
    }
    if (found.empty()) refuse("has no link that hangs on nothing", "name the base link");
    return found;
  }

  std::string only_end() const {
    std::string names;
    int count = 0;
    for (const auto& [name, link] : links_) {
      const bool parent =
          std::any_of(urdf_.joints.begin(), urdf_.joints.end(), [&](auto& j) { return j.parent == name; });
      if (parent) continue;
      names += (count++ > 0 ? ", " : "") + name;
    }
    if (count != 1) refuse("ends in " + std::to_string(count) + " links", "name the flange's: " + names);
    return names;
  }

  // Joints from base to tip.
  std::vector<const io::UrdfJoint*> way(const std::string& base, const std::string& tip) const {
    for (const std::string& name : {base, tip})
      if (!links_.contains(name)) refuse("has no link \"" + name + "\"", "links are " + all_links());
    std::vector<const io::UrdfJoint*> joints;
    for (std::string at = tip; at != base;) {
      const auto above = above_.find(at);
      if (above == above_.end() || joints.size() > urdf_.joints.size())
        refuse("link \"" + tip + "\" does not hang on \"" + base + "\"");
      joints.push_back(above->second);
      at = above->second->parent;
    }
    std::reverse(joints.begin(), joints.end());
    return joints;
  }

  // The frame of a link that is fixed beside the chain ("base" of Universal Robots' descriptions) serves as base too:
  // `at` becomes the chain's link in it, whose name is returned.
  std::string chain_below(const std::string& base, const std::string& tip, Placed& at) const {
    std::string name = base;
    while (links_.contains(name) && !hangs_on(tip, name)) {
      const auto above = above_.find(name);
      if (above == above_.end() || above->second->type != "fixed") return base;
      at = at * inverse(moved_by(above->second->origin));
      name = above->second->parent;
    }
    return name;
  }

  const io::UrdfLink& link(const std::string& name) const { return *links_.at(name); }
  [[noreturn]] void refuse(const std::string& problem, const std::string& remedy = {}) const {
    throw Error(Exit::data, place_, problem, remedy);
  }

 private:
  bool hangs_on(std::string link, const std::string& other) const {
    for (std::size_t steps = 0; link != other; ++steps) {
      const auto above = above_.find(link);
      if (above == above_.end() || steps > urdf_.joints.size()) return false;
      link = above->second->parent;
    }
    return true;
  }
  std::string all_links() const {
    std::string names;
    for (const auto& [name, link] : links_) names += (names.empty() ? "" : ", ") + name;
    return names;
  }
  const io::Urdf& urdf_;
  std::string place_;
  std::map<std::string, const io::UrdfLink*> links_;
  std::map<std::string, const io::UrdfJoint*> above_;
};

bool turns(const io::UrdfJoint& joint) {
  return joint.type == "revolute" || joint.type == "continuous";
}

void check_joint(const io::UrdfJoint& joint, const LinkTree& tree) {
  if (joint.type == "fixed") return;
  if (!turns(joint))
    tree.refuse("joint \"" + joint.name + "\" is " + joint.type +
                ", only revolute, continuous and fixed ones make an arm");
  if (joint.mimics) tree.refuse("joint \"" + joint.name + "\" mimics another, every joint of an arm has its own angle");
  if (!(norm(joint.axis) > 1e-9)) tree.refuse("joint \"" + joint.name + "\" has an axis without direction");
}

struct Chain {
  UrdfArm arm;
  std::map<std::string, std::size_t> behind;  // links: of how many joints
  std::map<std::string, Placed> placed;
};

// What hangs on the chain by fixed joints moves with it.
void add_fixed(const io::Urdf& urdf, Chain& chain) {
  for (bool more = true; more;) {
    more = false;
    for (const io::UrdfJoint& joint : urdf.joints) {
      if (joint.type != "fixed" || !chain.placed.contains(joint.parent) || chain.placed.contains(joint.child)) continue;
      chain.placed[joint.child] = chain.placed[joint.parent] * moved_by(joint.origin);
      chain.behind[joint.child] = chain.behind[joint.parent];
      more = true;
    }
  }
}

void add_bodies(const LinkTree& tree, Chain& chain) {
  UrdfArm& arm = chain.arm;
  for (const auto& [name, base_from_link] : chain.placed) {
    const std::size_t behind = chain.behind.at(name);
    const std::vector<double> zero(behind, 0.0);
    const Placed base_from_frame = arm.base_from_first * flange(std::span(arm.arm.links).first(behind), zero);
    for (const io::UrdfCollision& shape : tree.link(name).collisions) {
      const auto at = inverse(base_from_frame) * base_from_link * moved_by(shape.origin);
      arm.bodies.push_back({name, behind, {at.rotation, at.translation_m}, shape});
    }
  }
  std::stable_sort(arm.bodies.begin(), arm.bodies.end(),
                   [](const CollisionBody& a, const CollisionBody& b) { return a.behind < b.behind; });
}

}  // namespace

UrdfArm arm_of_urdf(const io::Urdf& urdf, const std::string& base, const std::string& tip, const std::string& place) {
  const LinkTree tree(urdf, place);
  const std::string last = tip.empty() ? tree.only_end() : tip;
  Chain chain;
  std::vector<AxisLine> axes;
  Placed at;
  const std::string first = tree.chain_below(base.empty() ? tree.root() : base, last, at);
  chain.placed[first] = at;
  chain.behind[first] = 0;
  for (const io::UrdfJoint* joint : tree.way(first, last)) {
    check_joint(*joint, tree);
    at = at * moved_by(joint->origin);
    if (turns(*joint)) {
      axes.push_back({at.rotate(normalized(joint->axis)), at.translation_m});
      chain.arm.joints.push_back(joint->name);
      chain.arm.limits.push_back({joint->lower_rad, joint->upper_rad, joint->speed_rad_per_s});
    }
    chain.placed[joint->child] = at;
    chain.behind[joint->child] = axes.size();
  }
  if (axes.empty()) tree.refuse("no joint turns between \"" + first + "\" and \"" + last + "\"");
  ChainRows rows = rows_of(axes, at);
  chain.arm.arm = {urdf.name, std::move(rows.links), "URDF, from " + (base.empty() ? first : base) + " to " + last};
  chain.arm.base_from_first = rows.base_from_first;
  chain.arm.last_from_flange = rows.last_from_flange;
  add_fixed(urdf, chain);
  add_bodies(tree, chain);
  return std::move(chain.arm);
}

std::filesystem::path mesh_of_urdf(const std::string& mesh, const std::filesystem::path& description) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::absolute(description).parent_path();
  constexpr std::string_view package = "package://", file = "file://";
  if (!mesh.starts_with(package)) {
    const fs::path given = mesh.starts_with(file) ? mesh.substr(file.size()) : mesh;
    const fs::path path = given.is_absolute() ? given : folder / given;
    if (fs::is_regular_file(path)) return path;
    throw Error(Exit::no_input, description.string(), "its mesh \"" + mesh + "\" is not there",
                "looked for " + path.string());
  }
  const fs::path inside = mesh.substr(package.size());
  const fs::path rest = inside.lexically_relative(*inside.begin());
  for (fs::path above = folder;; above = above.parent_path()) {
    if (fs::is_regular_file(above / inside)) return above / inside;
    if (fs::exists(above / "package.xml") && fs::is_regular_file(above / rest)) return above / rest;
    if (above == above.root_path()) break;
  }
  throw Error(Exit::no_input, description.string(), "its mesh \"" + mesh + "\" is not there",
              "put the folder \"" + inside.begin()->string() + "\" beside the description or above it");
}

}  // namespace gonio::robot
