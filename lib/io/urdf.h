// URDF, the robot description of ROS (wiki.ros.org/urdf/XML), as its elements: links with their collision shapes,
// joints with origins, axes and limits. What they make together is robot/urdf.h's. Lengths in m, angles in rad, as the
// file has them. Inertia, visuals, materials, transmissions, safety controllers and elements that the format does not
// know are left out.
#pragma once
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "geom/vector.h"

namespace gonio::io {

struct UrdfOrigin {  // to_from: T = translate(xyz) Rz(yaw) Ry(pitch) Rx(roll)
  Vec3 xyz_m, rpy_rad;
};

enum class UrdfForm { mesh, box, cylinder, sphere };

struct UrdfCollision {
  UrdfOrigin origin;  // in the link
  UrdfForm form = UrdfForm::mesh;
  std::string mesh;     // its file as written, "package://..." mostly
  Vec3 scale{1, 1, 1};  // of the mesh
  Vec3 size_m;          // box: edges; cylinder: radius, length along z; sphere: radius
};

struct UrdfLink {
  std::string name;
  std::vector<UrdfCollision> collisions;
};

struct UrdfJoint {
  std::string name, type, parent, child;
  UrdfOrigin origin;  // parent_from_child with the joint at zero
  Vec3 axis{1, 0, 0};
  bool mimics = false;
  double lower_rad = -std::numeric_limits<double>::infinity(), upper_rad = std::numeric_limits<double>::infinity();
  double speed_rad_per_s = std::numeric_limits<double>::infinity();
};

struct Urdf {
  std::string name;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
};

// Error(data) for what is no XML, no robot, still xacro, or names numbers that are none; `file` is what errors call it.
Urdf parse_urdf(std::string_view text, const std::string& file);
Urdf read_urdf(const std::filesystem::path& path);

}  // namespace gonio::io
