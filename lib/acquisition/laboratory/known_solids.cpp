// See known_solids.h. The rows: the smallest cylinders and boxes of a chosen layout (housing of a joint, tube, collars)
// that hold the collision models of the makers' ROS descriptions (Universal_Robots_ROS2_Description;
// ROS-Industrial's abb_irb1600_support), rounded up to whole millimetres. In base coordinates with all joints at zero,
// where every axis of these arms is parallel to one of the base's.
#include "acquisition/laboratory/known_solids.h"

#include <cmath>
#include <map>
#include <span>

namespace gonio::acquisition {
namespace {

enum class Kind { box, along_x, along_y, along_z };
struct KnownRow {
  int link;
  Kind kind;
  Vec3 middle_m;
  Vec3 sides_m;  // of a box; else radius and length
};

constexpr KnownRow ur3_rows[] = {
    {0, Kind::along_z, {0, 0, 0.043}, {0.066, 0.088}},
    {0, Kind::box, {-0.0055, 0.0825, 0.006}, {0.025, 0.035, 0.014}},
    {1, Kind::along_z, {0, 0, 0.1454}, {0.046, 0.119}},
    {1, Kind::along_y, {0, -0.0235, 0.1519}, {0.067, 0.063}},
    {2, Kind::along_y, {0, -0.115, 0.1519}, {0.046, 0.124}},
    {2, Kind::along_y, {-0.24365, -0.1235, 0.1519}, {0.039, 0.109}},
    {2, Kind::along_x, {-0.1315, -0.11989, 0.1519}, {0.034, 0.105}},
    {2, Kind::along_x, {-0.04, -0.11546, 0.1519}, {0.063, 0.08}},
    {2, Kind::along_x, {-0.2135, -0.12327, 0.1519}, {0.054, 0.061}},
    {3, Kind::along_y, {-0.24365, -0.0395, 0.1519}, {0.038, 0.079}},
    {3, Kind::along_y, {-0.4569, -0.0255, 0.1519}, {0.033, 0.089}},
    {3, Kind::along_x, {-0.35715, -0.02724, 0.1519}, {0.028, 0.105}},
    {3, Kind::along_x, {-0.27465, -0.03673, 0.1519}, {0.042, 0.062}},
    {3, Kind::along_x, {-0.43265, -0.02543, 0.1519}, {0.045, 0.05}},
    {4, Kind::along_y, {-0.4569, -0.08885, 0.1519}, {0.033, 0.047}},
    {4, Kind::along_z, {-0.4569, -0.11235, 0.1539}, {0.035, 0.09}},
    {5, Kind::along_z, {-0.4569, -0.11235, 0.09005}, {0.034, 0.047}},
    {5, Kind::along_y, {-0.4569, -0.10835, 0.06655}, {0.034, 0.09}},
    {6, Kind::along_y, {-0.4569, -0.17275, 0.06655}, {0.036, 0.041}},
};

constexpr KnownRow ur5_rows[] = {
    {0, Kind::along_z, {0, 0, 0.012}, {0.074, 0.026}},
    {0, Kind::box, {0, 0.093, 0.0085}, {0.012, 0.036, 0.011}},
    {1, Kind::along_z, {0, 0, 0.08916}, {0.06, 0.132}},
    {1, Kind::along_y, {0, -0.033, 0.08916}, {0.078, 0.076}},
    {2, Kind::along_y, {0, -0.137, 0.08916}, {0.061, 0.134}},
    {2, Kind::along_y, {-0.425, -0.137, 0.08916}, {0.061, 0.134}},
    {2, Kind::along_x, {-0.211, -0.13569, 0.08916}, {0.051, 0.26}},
    {2, Kind::along_x, {-0.041, -0.13755, 0.08916}, {0.071, 0.082}},
    {2, Kind::along_x, {-0.383, -0.13752, 0.08916}, {0.071, 0.084}},
    {3, Kind::along_y, {-0.425, -0.0265, 0.08916}, {0.059, 0.091}},
    {3, Kind::along_y, {-0.81725, -0.0115, 0.08916}, {0.04, 0.105}},
    {3, Kind::along_x, {-0.6355, -0.01661, 0.08916}, {0.04, 0.285}},
    {3, Kind::along_x, {-0.46, -0.02392, 0.08916}, {0.048, 0.07}},
    {3, Kind::along_x, {-0.7975, -0.01167, 0.08916}, {0.053, 0.041}},
    {4, Kind::along_y, {-0.81725, -0.08615, 0.08916}, {0.039, 0.046}},
    {4, Kind::along_z, {-0.81725, -0.10915, 0.09416}, {0.04, 0.106}},
    {5, Kind::along_z, {-0.81725, -0.10915, 0.01751}, {0.039, 0.046}},
    {5, Kind::along_y, {-0.81725, -0.10415, -0.00549}, {0.04, 0.106}},
    {6, Kind::along_y, {-0.81725, -0.17445, -0.00549}, {0.044, 0.036}},
};

constexpr KnownRow ur5e_rows[] = {
    {0, Kind::along_z, {0, 0, 0.0495}, {0.076, 0.101}},
    {1, Kind::along_z, {0, 0, 0.165}, {0.065, 0.133}},
    {1, Kind::along_y, {0, -0.035, 0.1625}, {0.08, 0.08}},
    {2, Kind::along_y, {0, -0.1385, 0.1625}, {0.061, 0.135}},
    {2, Kind::along_y, {-0.425, -0.133, 0.1625}, {0.06, 0.146}},
    {2, Kind::box, {-0.3185, -0.135, 0.1625}, {0.213, 0.15, 0.121}},
    {2, Kind::box, {-0.1065, -0.1375, 0.1625}, {0.213, 0.145, 0.121}},
    {3, Kind::along_y, {-0.425, -0.0135, 0.1625}, {0.059, 0.095}},
    {3, Kind::along_y, {-0.8172, -0.0055, 0.1625}, {0.039, 0.111}},
    {3, Kind::box, {-0.752, -0.0055, 0.1625}, {0.132, 0.111, 0.093}},
    {3, Kind::box, {-0.621, -0.007, 0.1625}, {0.132, 0.108, 0.105}},
    {3, Kind::box, {-0.4905, -0.0085, 0.1625}, {0.131, 0.105, 0.117}},
    {4, Kind::along_y, {-0.8172, -0.0963, 0.1625}, {0.052, 0.074}},
    {4, Kind::along_z, {-0.8172, -0.1333, 0.164}, {0.052, 0.111}},
    {5, Kind::along_z, {-0.8172, -0.1333, 0.0863}, {0.047, 0.047}},
    {5, Kind::along_y, {-0.8172, -0.1318, 0.0628}, {0.047, 0.111}},
    {6, Kind::along_y, {-0.8172, -0.2104, 0.0628}, {0.044, 0.047}},
};

constexpr KnownRow ur10e_rows[] = {
    {0, Kind::along_z, {0, 0, 0.0495}, {0.096, 0.101}},
    {1, Kind::along_z, {0, 0, 0.1857}, {0.082, 0.174}},
    {1, Kind::along_y, {0, -0.0445, 0.1807}, {0.104, 0.101}},
    {2, Kind::along_y, {0, -0.18, 0.1807}, {0.077, 0.172}},
    {2, Kind::along_y, {-0.6127, -0.171, 0.1807}, {0.06, 0.146}},
    {2, Kind::box, {-0.4595, -0.178, 0.1805}, {0.307, 0.164, 0.139}},
    {2, Kind::box, {-0.1535, -0.182, 0.181}, {0.307, 0.176, 0.154}},
    {3, Kind::along_y, {-0.6127, -0.046, 0.1807}, {0.059, 0.108}},
    {3, Kind::along_y, {-1.18425, -0.045, 0.1807}, {0.047, 0.124}},
    {3, Kind::box, {-1.089, -0.044, 0.1805}, {0.192, 0.126, 0.103}},
    {3, Kind::box, {-0.8985, -0.043, 0.1805}, {0.191, 0.124, 0.111}},
    {3, Kind::box, {-0.708, -0.0415, 0.1805}, {0.192, 0.121, 0.117}},
    {4, Kind::along_y, {-1.18425, -0.13965, 0.1807}, {0.06, 0.069}},
    {4, Kind::along_z, {-1.18425, -0.17415, 0.1762}, {0.06, 0.125}},
    {5, Kind::along_z, {-1.18425, -0.17415, 0.08785}, {0.057, 0.054}},
    {5, Kind::along_y, {-1.18425, -0.17965, 0.06085}, {0.057, 0.125}},
    {6, Kind::along_y, {-1.18425, -0.2662, 0.06085}, {0.052, 0.049}},
};

constexpr KnownRow irb_1600_rows[] = {
    {0, Kind::box, {-0.0525, 0, 0.086}, {0.661, 0.484, 0.172}},
    {1, Kind::box, {0.0195, 0.0145, 0.187}, {0.569, 0.357, 0.126}},
    {1, Kind::box, {0.0295, 0.0135, 0.335}, {0.569, 0.355, 0.17}},
    {1, Kind::box, {0.0445, -0.0055, 0.483}, {0.543, 0.317, 0.126}},
    {1, Kind::box, {0.078, -0.016, 0.599}, {0.454, 0.258, 0.106}},
    {2, Kind::box, {0.15, -0.1895, 0.5415}, {0.176, 0.127, 0.287}},
    {2, Kind::box, {0.1495, -0.1785, 0.8275}, {0.167, 0.135, 0.287}},
    {2, Kind::box, {0.1485, -0.168, 1.1135}, {0.155, 0.124, 0.287}},
    {3, Kind::box, {0.1125, 0.0205, 1.1725}, {0.275, 0.281, 0.245}},
    {3, Kind::box, {0.3, 0.0065, 1.1645}, {0.1, 0.253, 0.229}},
    {3, Kind::box, {0.4075, 0.003, 1.171}, {0.115, 0.192, 0.18}},
    {4, Kind::along_x, {0.517, 0, 1.1865}, {0.053, 0.106}},
    {4, Kind::box, {0.66, 0, 1.1865}, {0.18, 0.126, 0.112}},
    {4, Kind::along_y, {0.75, 0, 1.1865}, {0.056, 0.126}},
    {5, Kind::along_y, {0.75, 0, 1.1865}, {0.043, 0.048}},
    {6, Kind::along_x, {0.776, 0, 1.1865}, {0.021, 0.052}},
    {6, Kind::along_x, {0.809, 0, 1.1865}, {0.025, 0.014}},
};

constexpr KnownRow irb_1600_12_rows[] = {
    {0, Kind::box, {-0.0525, 0, 0.086}, {0.661, 0.484, 0.172}},
    {1, Kind::box, {0.0195, 0.0145, 0.187}, {0.569, 0.357, 0.126}},
    {1, Kind::box, {0.0295, 0.0135, 0.335}, {0.569, 0.355, 0.17}},
    {1, Kind::box, {0.0445, -0.0055, 0.483}, {0.543, 0.317, 0.126}},
    {1, Kind::box, {0.078, -0.016, 0.599}, {0.454, 0.258, 0.106}},
    {2, Kind::box, {0.141, -0.189, 0.504}, {0.224, 0.128, 0.212}},
    {2, Kind::box, {0.143, -0.1785, 0.715}, {0.214, 0.141, 0.212}},
    {2, Kind::box, {0.1475, -0.169, 0.926}, {0.171, 0.126, 0.212}},
    {3, Kind::box, {0.1125, 0.0205, 0.9475}, {0.275, 0.281, 0.245}},
    {3, Kind::box, {0.3, 0.0065, 0.9395}, {0.1, 0.253, 0.229}},
    {3, Kind::box, {0.4075, 0.003, 0.946}, {0.115, 0.192, 0.18}},
    {4, Kind::along_x, {0.517, 0, 0.9615}, {0.053, 0.106}},
    {4, Kind::box, {0.66, 0, 0.9615}, {0.18, 0.126, 0.112}},
    {4, Kind::along_y, {0.75, 0, 0.9615}, {0.056, 0.126}},
    {5, Kind::along_y, {0.75, 0, 0.9615}, {0.043, 0.048}},
    {6, Kind::along_x, {0.776, 0, 0.9615}, {0.021, 0.052}},
    {6, Kind::along_x, {0.809, 0, 0.9615}, {0.025, 0.014}},
};

Quaternion turned_to(Kind kind) {  // takes z to where the cylinder's axis points
  const double half = std::sqrt(0.5);
  switch (kind) {
    case Kind::along_x: return {half, 0, half, 0};
    case Kind::along_y: return {half, -half, 0, 0};
    default: return {};
  }
}

}  // namespace

std::vector<LinkSolid> known_solids(const std::string& model) {
  static const std::map<std::string, std::span<const KnownRow>> all = {
      {"ur3", ur3_rows},
      {"ur5", ur5_rows},
      {"ur5e", ur5e_rows},
      {"ur10e", ur10e_rows},
      {"abb-irb-1600", irb_1600_rows},
      {"abb-irb-1600-1.2", irb_1600_12_rows},
  };
  std::vector<LinkSolid> solids;
  const auto found = all.find(model);
  if (found == all.end()) return solids;
  for (const KnownRow& row : found->second) {
    LinkSolid link;
    link.solid.name = "link-" + std::to_string(row.link);
    link.solid.shape = row.kind == Kind::box ? Solid::Shape::box : Solid::Shape::cylinder;
    link.solid.sides_m = row.sides_m;
    link.solid.link = row.link;
    link.base_from_body = {turned_to(row.kind), row.middle_m};
    solids.push_back(std::move(link));
  }
  return solids;
}

}  // namespace gonio::acquisition
