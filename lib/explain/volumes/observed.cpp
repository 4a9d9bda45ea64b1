// See observed.h.
#include "explain/volumes/observed.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/error.h"
#include "base/random.h"
#include "explain/volumes/row_noise.h"
#include "explain/volumes/simulated_readings.h"
#include "explain/volumes/sites.h"
#include "linear/solve.h"
#include "stats/intervals.h"

namespace gonio::explain::volumes {
namespace {

constexpr std::size_t site_count = 3000, alignment_count = 800, fewest_walls = 200, most_cells = 160;
constexpr double least_plateau = 3.5, deepest_voxels = 40, highest_voxels = 20;
constexpr double least_reach = 3, largest_reach = 8, reach_in_widths = 3.5, plateau_in_widths = 4.5;
constexpr std::size_t rough_cells = 48;
constexpr double marker_margin = 5, sharpest_blur = 0.8, most_displaced = 1.5;  // voxels
constexpr double nominal_attenuation = 2;  // of the longest path, where values are no attenuation

Body body_for(const VolumesInput& input, const Sampled& sampled, const mesh::Mesh& mesh) {
  const std::size_t longest = std::ranges::max(input.volume.head.size);
  const double coarser = std::max(1.0, static_cast<double>(longest) / most_cells);
  std::array<std::size_t, 3> size{};
  for (std::size_t a = 0; a < 3; ++a)
    size[a] = static_cast<std::size_t>(std::ceil(static_cast<double>(input.volume.head.size[a]) / coarser));
  return body_of(mesh, size, sampled.extent_m(), input.place);
}

struct Pose {
  Vec3 turn{}, shift{};
};

// Gauss-Newton on walls, which is what the pose moves; Huber's weights. The shape's own size is no part of it.
Pose better_pose(const std::vector<Site>& sites, const std::vector<volume::Edge>& edges, double voxel_m) {
  std::vector<double> distances;
  for (const volume::Edge& e : edges)
    if (e.good) distances.push_back(e.position);
  const double width = std::max(0.05, stats::robust_sigma(distances));
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Identity() * 1e-9;
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  double lever = voxel_m;
  for (const Site& s : sites) lever = std::max(lever, norm(s.at_m));
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!edges[i].good) continue;
    const Vec3 turn = cross(sites[i].at_m, sites[i].normal) / lever;
    Eigen::Matrix<double, 6, 1> row;
    row << sites[i].normal.x, sites[i].normal.y, sites[i].normal.z, turn.x, turn.y, turn.z;
    const double weight = std::min(1.0, 1.5 * width / std::max(1e-12, std::abs(edges[i].position)));
    h += weight * row * row.transpose();
    b += weight * row * (edges[i].position * voxel_m);
  }
  // A shape that turns into itself keeps its turn.
  h.diagonal().tail<3>().array() += 1e-6 * static_cast<double>(sites.size());
  const Eigen::Matrix<double, 6, 1> x = linear::solve_ldlt(h, b);
  return {Vec3{x[3], x[4], x[5]} / lever, {x[0], x[1], x[2]}};
}

// The believed shape where the volume has it: from a wide look to a narrow one.
mesh::Mesh aligned(const VolumesInput& input, const Sampled& sampled, Observed& o) {
  mesh::Mesh mesh = input.mesh;
  Quaternion turned;
  for (const double reach : {6.0, 4.0, 3.0, 3.0}) {
    const Body body = body_for(input, sampled, mesh);
    const mesh::TriangleTree tree(mesh.positions_m, mesh.triangles);
    const std::vector<Site> sites = sites_of(mesh, tree, sampled.voxel_m(), alignment_count);
    const Values values = values_of(sampled, body, sites, input.place);
    const std::vector<volume::Edge> edges = edges_of(sampled, sites, values, reach);
    const auto good = std::ranges::count_if(edges, [](const volume::Edge& e) { return e.good; });
    if (good < 50) continue;
    const Pose pose = better_pose(sites, edges, sampled.voxel_m());
    mesh = moved(std::move(mesh), pose.turn, pose.shift);
    const Quaternion turn = quaternion_of_rotation_vector(pose.turn);
    turned = normalized(turn * turned);
    o.moved_m = matrix_of(turn) * o.moved_m + pose.shift;
  }
  o.turned_rad = rotation_vector_of(turned);
  return mesh;
}

// A grey value along the normal at a depth that is drawn; half-way through what is thinner than two plateaus; nothing
// where the next wall is too near.
class Greys {
 public:
  Greys(const Sampled& sampled, const mesh::TriangleTree& tree, const Values& values, double plateau, bool thin)
      : sampled_(sampled), tree_(tree), values_(values), plateau_(plateau), thin_(thin) {}
  void add(const Site& site, std::uint32_t number, bool inside, std::vector<Row>& rows) {
    const double room = inside ? site.behind : site.before, share = random_.uniform();
    const bool between = room < 2 * plateau_;
    if (between && (!thin_ || room < least_room)) return;
    const double most = std::min(room - plateau_, inside ? deepest_voxels : highest_voxels);
    const double depth = between ? 0.5 * room : plateau_ + share * (most - plateau_);
    Row row;
    row.reading = inside ? Reading::inside : Reading::outside;
    row.site = number;
    row.at_m = site.at_m + site.normal * ((inside ? -depth : depth) * sampled_.voxel_m());
    if (!sampled_.within(row.at_m, 2)) return;
    row.depth = std::min(depth, room - depth);
    const double clear_m = std::min(clear_voxels, clear_share * row.depth) * sampled_.voxel_m();
    if (tree_.nearest(row.at_m, clear_m).distance_m < clear_m) return;
    row.normal = site.normal;
    const double rise = values_.material - values_.air;
    row.value = (sampled_.at(row.at_m) - values_.air) / rise;
    row.sigma = values_.noise / std::abs(rise);
    rows.push_back(row);
  }

 private:
  static constexpr double least_room = 4, clear_voxels = 2.5, clear_share = 0.8;
  const Sampled& sampled_;
  const mesh::TriangleTree& tree_;
  const Values& values_;
  double plateau_;
  bool thin_;
  Random random_{1, 0x67726579};
};

// The width of most edges; what is read next to them stands clear of it.
double typical_width(const Sampled& sampled, const std::vector<Site>& sites, const Values& values) {
  std::vector<double> widths;
  for (const double reach : {least_reach, 2 * least_reach}) {
    widths.clear();
    for (const volume::Edge& e : edges_of(sampled, sites, values, reach))
      if (e.good) widths.push_back(e.width);
    if (widths.size() > fewest_walls && reach > reach_in_widths * stats::median(widths)) break;
  }
  return widths.empty() ? 1 : stats::median(widths);
}

std::vector<Row> rows_of(const Sampled& sampled, const mesh::TriangleTree& tree, const Values& values,
                         const std::vector<Site>& sites, double width, double reach, bool fine) {
  const std::vector<volume::Edge> edges = edges_of(sampled, sites, values, reach);
  std::vector<Row> rows;
  Greys greys(sampled, tree, values, std::max(least_plateau, plateau_in_widths * width), fine);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const volume::Edge& e = edges[i];
    const auto number = static_cast<std::uint32_t>(i);
    if (e.good) {
      Row row;
      row.site = number;
      row.at_m = sites[i].at_m, row.normal = sites[i].normal, row.curvature = sites[i].curvature;
      row.value = e.position, row.sigma = e.sigma;
      rows.push_back(row);
      row.reading = Reading::width;
      // Of a step in white noise: integral of u^2 phi^2 over that of phi^2 is one half.
      row.value = e.width, row.sigma = std::sqrt(2.0) * e.sigma;
      rows.push_back(row);
    }
    greys.add(sites[i], number, true, rows);
    greys.add(sites[i], number, false, rows);
  }
  return rows;
}

// Of the largest line integral, where values are no attenuation.
double attenuation_per_m(const VolumesInput& input, const mesh::Mesh& mesh, const Values& values) {
  if (input.attenuation) return std::max(1e-3, values.material - values.air);
  const Tomograph rough(mesh, input.volume.head.size, input.spacing_m, 1, {}, rough_cells);
  return nominal_attenuation / std::max(1e-9, rough.longest_m());
}

// Walls that stand off by about this much everywhere: what is simulated stands there, too, for an edge errs with its
// place between voxels. Blurred edges err too little, and may not be off by their geometry.
struct Displacement {
  double offset = 0, scale = 0;  // voxels, share of the distance from the middle
  double at(const Row& row, double voxel_m) const { return offset + scale * dot(row.at_m, row.normal) / voxel_m; }
};
Displacement displacement(const std::vector<Row>& rows, const Observed& o) {
  if (o.typical_width > sharpest_blur) return {};
  const double lever = o.field_m / o.voxel_m;
  Eigen::Matrix2d h = Eigen::Matrix2d::Identity();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  for (const Row& row : rows) {
    if (row.reading != Reading::wall || !(std::abs(row.value) < most_displaced)) continue;
    const Eigen::Vector2d j(1, dot(row.at_m, row.normal) / o.field_m);
    h += j * j.transpose();
    b += j * row.value;
  }
  const Eigen::Vector2d x = linear::solve_ldlt(h, b);
  return {x[0], x[1] / lever};
}
mesh::Mesh displaced(mesh::Mesh mesh, const Displacement& by, double voxel_m) {
  for (std::size_t v = 0; v < mesh.positions_m.size(); ++v)
    mesh.positions_m[v] = mesh.positions_m[v] * (1 + by.scale) + mesh.normals[v] * (by.offset * voxel_m);
  return mesh;
}

// How dense each marker is: the median of what stands within half its radius, over the material's.
std::vector<Ball> dense(std::vector<Ball> markers, const Sampled& sampled, const Values& values) {
  constexpr int cells = 5;
  for (Ball& ball : markers) {
    std::vector<double> shares;
    for (int k = -cells; k <= cells; ++k)
      for (int j = -cells; j <= cells; ++j)
        for (int i = -cells; i <= cells; ++i) {
          const Vec3 off = Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} / cells;
          const double value = sampled.at(ball.centre_m + off * (0.5 * ball.radius_m));
          if (dot(off, off) <= 1 && std::isfinite(value))
            shares.push_back((value - values.air) / (values.material - values.air));
        }
    ball.share = shares.empty() ? 0 : std::max(0.0, stats::median(shares));
  }
  return markers;
}

// What is near a marker shows the marker.
void leave_out_markers(const std::vector<Ball>& markers, double voxel_m, std::vector<Row>& rows) {
  std::erase_if(rows, [&](const Row& row) {
    return std::ranges::any_of(markers, [&](const Ball& ball) {
      return norm(row.at_m - ball.centre_m) < ball.radius_m + marker_margin * voxel_m;
    });
  });
}

}  // namespace

Observed observed(const VolumesInput& input) {
  const Sampled sampled(input.volume, input.spacing_m);
  Observed o;
  o.voxel_m = sampled.voxel_m(), o.field_m = sampled.field_m(), o.half_height_m = 0.5 * sampled.extent_m().z;
  const mesh::Mesh mesh = aligned(input, sampled, o);
  const Body body = body_for(input, sampled, mesh);
  const mesh::TriangleTree tree(mesh.positions_m, mesh.triangles);
  const std::vector<Site> sites = sites_of(mesh, tree, sampled.voxel_m(), site_count);
  const Values values = values_of(sampled, body, sites, input.place);
  o.air = values.air, o.material = values.material;
  o.voxel_noise = values.noise / std::abs(values.material - values.air);
  o.sites = sites.size();
  o.typical_width = typical_width(sampled, sites, values);
  const double reach = std::clamp(reach_in_widths * o.typical_width, least_reach, largest_reach);
  std::vector<Row> rows =
      rows_of(sampled, tree, values, sites, o.typical_width, reach, Tomograph::is_fine_for(input.volume.head.size));
  leave_out_markers(input.markers, o.voxel_m, rows);
  const Displacement by = displacement(rows, o);
  const Tomograph tomograph(displaced(mesh, by, o.voxel_m), input.volume.head.size, input.spacing_m,
                            attenuation_per_m(input, mesh, values), dense(input.markers, sampled, values));
  o.longest_path_m = tomograph.longest_m();
  add_simulated(tomograph, sampled, values, sites, input.markers, reach, rows, o);
  if (tomograph.is_fine())
    for (Row& row : rows)
      if (row.reading == Reading::wall) row.simulated -= by.at(row, o.voxel_m);
  const auto walls = std::ranges::count(rows, Reading::wall, &Row::reading);
  if (walls < static_cast<std::ptrdiff_t>(fewest_walls))
    throw Error(Exit::data, input.place,
                "shows an edge at " + std::to_string(walls) + " of " + std::to_string(sites.size()) +
                    " places of the believed surface (at least " + std::to_string(fewest_walls) + ")",
                "give the object's pose in the volume, or a finer scan");
  o.ring_rms = add_rings(sampled, body, values, rows);
  o.left_out = settle_row_noise(rows, o.voxel_m);
  std::tie(o.groups, o.blocks) = group_rows(rows, o.voxel_m);
  o.rows = std::move(rows);
  return o;
}

}  // namespace gonio::explain::volumes
