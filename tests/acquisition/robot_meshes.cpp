// See robot_meshes.h. Where link frames and meshes in them stand is read from the descriptions beside the meshes.
#include "acquisition/robot_meshes.h"

#include <array>
#include <cmath>
#include <regex>

#include "base/atomic_file.h"
#include "data.h"
#include "geom/rigid.h"
#include "io/stl.h"

namespace gonio::tests {
namespace {

using Frame = Rigid<frame::Base, frame::Base>;

Frame frame_of(Vec3 xyz, double roll, double pitch, double yaw) {
  return {quaternion_of_rotation_vector({0, 0, yaw}) * quaternion_of_rotation_vector({0, pitch, 0}) *
              quaternion_of_rotation_vector({roll, 0, 0}),
          xyz};
}

// The number behind `key:` that comes first after `section:`.
double number_in(const std::string& yaml, const std::string& section, const std::string& key) {
  const auto at = yaml.find("\n  " + section + ":");
  std::smatch found;
  const std::string rest = yaml.substr(at == std::string::npos ? 0 : at);
  if (!std::regex_search(rest, found, std::regex("\\b" + key + ":\\s*([-+0-9.eE]+)"))) return NAN;
  return std::stod(found[1]);
}

io::TriangleMesh moved(io::TriangleMesh mesh, const Frame& frame) {
  for (Vec3& p : mesh.positions_m) p = frame * p;
  return mesh;
}

std::vector<io::TriangleMesh> universal_meshes(const std::string& model) {
  const auto root = data("robots/ur_description");
  const std::string kinematics = read_file(root / "config" / model / "default_kinematics.yaml"),
                    visual = read_file(root / "config" / model / "visual_parameters.yaml"),
                    physical = read_file(root / "config" / model / "physical_parameters.yaml");
  const std::array<std::string, 7> links{"base", "shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"};
  std::vector<io::TriangleMesh> meshes;
  Frame link{};
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto n = [&](const char* key) { return number_in(kinematics, links[i], key); };
    if (i > 0) link = link * frame_of({n("x"), n("y"), n("z")}, n("roll"), n("pitch"), n("yaw"));
    Frame mesh = frame_of({}, 0, 0, pi);  // ur_macro.xacro
    const auto offset = [&](const char* key) { return number_in(physical, "offsets", key); };
    if (i == 2) mesh = frame_of({0, 0, offset("shoulder_offset")}, pi / 2, 0, -pi / 2);
    if (i == 3) mesh = frame_of({0, 0, offset("elbow_offset")}, pi / 2, 0, -pi / 2);
    if (i > 3) mesh = frame_of({0, 0, number_in(visual, links[i], "visual_offset")}, i == 5 ? 0 : pi / 2, 0, 0);
    std::string file = links[i];
    std::erase(file, '_');
    meshes.push_back(moved(io::read_stl(root / "meshes" / model / "collision" / (file + ".stl")), link * mesh));
  }
  return meshes;
}

std::vector<io::TriangleMesh> abb_meshes(const std::string& variant) {
  const auto root = data("robots/abb_irb1600");
  const std::string xacro = read_file(root / "urdf" / (variant + "_macro.xacro"));
  std::vector<io::TriangleMesh> meshes;
  Frame link{};
  for (int i = 0; i <= 6; ++i) {
    if (i > 0) {
      std::smatch found;
      const std::string rest = xacro.substr(xacro.find("joint_" + std::to_string(i) + "\" type"));
      if (!std::regex_search(rest, found, std::regex("xyz=\"([^ ]+) ([^ ]+) ([^ ]+)\" rpy=\"0 0 0\""))) return {};
      link = link * frame_of({std::stod(found[1]), std::stod(found[2]), std::stod(found[3])}, 0, 0, 0);
    }
    const std::string folder = i == 2 ? variant : "irb1600";
    const std::string file = i == 0 ? "base_link" : "link_" + std::to_string(i);
    meshes.push_back(moved(io::read_stl(root / "meshes" / folder / "collision" / (file + ".stl")), link));
  }
  return meshes;
}

}  // namespace

std::vector<io::TriangleMesh> robot_meshes(const std::string& model) {
  if (model == "abb-irb-1600") return abb_meshes("irb1600_8_145");
  if (model == "abb-irb-1600-1.2") return abb_meshes("irb1600_6_12");
  return universal_meshes(model);
}

std::vector<Vec3> points_on(const io::TriangleMesh& mesh, double spacing_m) {
  std::vector<Vec3> points;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.positions_m[a], u = mesh.positions_m[b] - p, v = mesh.positions_m[c] - p;
    const double side = std::max({norm(u), norm(v), norm(u - v)});
    const int n = std::max(1, static_cast<int>(std::ceil(side / spacing_m)));
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) points.push_back(p + u * (double(i) / n) + v * (double(j) / n));
  }
  return points;
}

}  // namespace gonio::tests
