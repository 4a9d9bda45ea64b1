#include "mesh/register/moved_cloud.h"

#include <algorithm>

#include "base/atomic_file.h"
#include "geom/covariance.h"
#include "io/ply.h"
#include "io/ply_header.h"

namespace gonio::mesh {
namespace {

constexpr std::array<std::string_view, 6> covariance_names{"cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"};

// Of the vertices, beside what every mesh has.
io::PlyWish further_properties(const std::string& file, const std::string& place) {
  constexpr std::array<std::string_view, 12> own{"x", "y", "z", "nx", "ny",        "nz",
                                                 "s", "t", "u", "v",  "texture_u", "texture_v"};
  io::PlyWish wish;
  for (const io::PlyElement& element : io::read_ply_header(file, place).elements) {
    if (element.name != "vertex") continue;
    for (const io::PlyProperty& property : element.properties)
      if (!property.count_type && std::ranges::find(own, property.name) == own.end())
        wish.properties.push_back(property.name);
  }
  return wish;
}

}  // namespace

void write_moved_cloud(const std::filesystem::path& from, const ViewMotion& motion, const std::filesystem::path& to) {
  const std::string file = read_file(from);
  const io::PlyWish wish = further_properties(file, from.string());
  io::TriangleMesh mesh = io::parse_ply(file, from.string(), wish);
  for (Vec3& p : mesh.positions_m) p = motion * p;
  for (Vec3& n : mesh.normals) n = motion.rotate(n);
  std::array<std::vector<float>*, 6> entries{};
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const auto found = std::ranges::find(wish.properties, covariance_names[k]);
    if (found != wish.properties.end())
      entries[k] = &mesh.properties[static_cast<std::size_t>(found - wish.properties.begin())];
  }
  if (std::ranges::find(entries, nullptr) == entries.end()) {
    const Mat3 turn = matrix_of(motion.rotation);
    for (std::size_t i = 0; i < mesh.positions_m.size(); ++i) {
      std::array<double, 6> stored{};
      for (std::size_t k = 0; k < stored.size(); ++k) stored[k] = double{(*entries[k])[i]};
      const std::array<double, 6> turned = turned_covariance(turn, stored);
      for (std::size_t k = 0; k < turned.size(); ++k) (*entries[k])[i] = static_cast<float>(turned[k]);
    }
  }
  io::write_ply(to, mesh, wish);
}

}  // namespace gonio::mesh
