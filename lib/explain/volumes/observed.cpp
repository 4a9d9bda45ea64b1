// See observed.h.
#include "explain/volumes/observed.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "explain/volumes/row_noise.h"
#include "explain/volumes/simulated_tomograph.h"
#include "explain/volumes/sites.h"
#include "linear/solve.h"
#include "stats/intervals.h"
#include "volume/mechanisms/ct_beam_hardening.h"
#include "volume/mechanisms/ct_streak.h"

namespace gonio::explain::volumes {
namespace {

constexpr std::size_t site_count = 3000, alignment_count = 800, fewest_walls = 200, most_cells = 160;
constexpr double least_plateau = 3.5, deepest_voxels = 40, highest_voxels = 20;
constexpr double least_reach = 3, largest_reach = 8, reach_in_widths = 3.5, plateau_in_widths = 4.5;
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

std::vector<volume::Edge> edges_of(const Sampled& sampled, const std::vector<Site>& sites, const Values& values,
                                   double reach) {
  std::vector<volume::Edge> edges(sites.size());
  parallel_for(
      0, sites.size(), [&](std::size_t i) { edges[i] = edge_at(sampled, sites[i], values, reach); }, 32);
  return edges;
}

// The believed shape where the volume has it: from a wide look to a narrow one.
mesh::Mesh aligned(const VolumesInput& input, const Sampled& sampled, Observed& o) {
  mesh::Mesh mesh = input.mesh;
  Quaternion turned;
  for (const double reach : {6.0, 4.0, 3.0, 3.0}) {
    const Body body = body_for(input, sampled, mesh);
    const Values values = values_of(sampled, body, input.place);
    const std::vector<Site> sites = sites_of(mesh, body, sampled.voxel_m(), alignment_count);
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

bool is_plain(const Body& body, Vec3 at, double share, double voxel_m) {
  for (const Vec3 way : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}})
    if (std::abs(body.at(at + way * (2.5 * voxel_m)) - share) > 0.001) return false;
  return true;
}

// A grey value along the normal at a depth that is drawn; nothing where the next wall is too near.
void add_grey(const Sampled& sampled, const Body& body, const Values& values, const Site& site, bool inside,
              double plateau, Random& random, std::vector<Row>& rows) {
  const double free = (inside ? site.behind : site.before) - plateau;
  const double most = std::min(free, inside ? deepest_voxels : highest_voxels), share = random.uniform();
  if (!(most >= plateau)) return;
  const double depth = plateau + share * (most - plateau);
  Row row;
  row.reading = inside ? Reading::inside : Reading::outside;
  row.at_m = site.at_m + site.normal * ((inside ? -depth : depth) * sampled.voxel_m());
  if (!sampled.within(row.at_m, 2) || !is_plain(body, row.at_m, inside ? 1 : 0, sampled.voxel_m())) return;
  row.normal = site.normal;
  row.depth = std::min(depth, std::max(plateau, free + plateau - depth));
  const double rise = values.material - values.air;
  row.value = (sampled.at(row.at_m) - values.air) / rise;
  row.sigma = values.noise / std::abs(rise);
  rows.push_back(row);
}

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

std::vector<Row> rows_of(const Sampled& sampled, const Body& body, const Values& values, const std::vector<Site>& sites,
                         double width) {
  const double plateau = std::max(least_plateau, plateau_in_widths * width);
  const std::vector<volume::Edge> edges =
      edges_of(sampled, sites, values, std::clamp(reach_in_widths * width, least_reach, largest_reach));
  std::vector<Row> rows;
  Random random(1, 0x67726579);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const volume::Edge& e = edges[i];
    if (e.good) {
      Row row;
      row.at_m = sites[i].at_m, row.normal = sites[i].normal, row.curvature = sites[i].curvature;
      row.value = e.position, row.sigma = e.sigma;
      rows.push_back(row);
      row.reading = Reading::width;
      // Of a step in white noise: integral of u^2 phi^2 over that of phi^2 is one half.
      row.value = e.width, row.sigma = std::sqrt(2.0) * e.sigma;
      rows.push_back(row);
    }
    add_grey(sampled, body, values, sites[i], true, plateau, random, rows);
    add_grey(sampled, body, values, sites[i], false, plateau, random, rows);
  }
  return rows;
}

void add_paths(const VolumesInput& input, const Body& body, const Values& values, std::vector<Row>& rows, Observed& o) {
  std::vector<Vec3> places;
  for (const Row& row : rows) places.push_back(row.at_m);
  const Tomograph tomograph(body);
  const double longest = tomograph.longest_m();
  o.longest_path_m = longest;
  const double per_m = input.attenuation ? std::max(1e-3, values.material - values.air) : nominal_attenuation / longest;
  const std::vector<double> path = tomograph.mean_path(places);
  const std::vector<double> hardening =
      tomograph.reconstructed([&](double p) { return equation::ct_beam_hardening_lacks(p, longest); }, places);
  const std::vector<std::vector<double>> scatter = tomograph.scattered(per_m, scatter_shares, places);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].path_m = path[i], rows[i].hardening = hardening[i];
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t s = 0; s < scatter_shares.size(); ++s) rows[i].scatter[s] = scatter[s][i];
  if (input.markers.empty()) return;
  Body markers = body;
  std::ranges::fill(markers.share, 0.0f);
  for (const VolumesInput::Ball& ball : input.markers) add_ball(markers, ball.centre_m, ball.radius_m);
  const Tomograph through(markers);
  if (!(through.longest_m() > 0)) return;
  const double most = through.longest_m();
  const std::vector<double> streak =
      through.reconstructed([&](double m) { return equation::ct_streak_lacks(m, most); }, places);
  const std::vector<double> marker_path = through.mean_path(places);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].markers = streak[i], rows[i].marker_path_m = marker_path[i];
}

}  // namespace

Observed observed(const VolumesInput& input) {
  const Sampled sampled(input);
  Observed o;
  o.voxel_m = sampled.voxel_m(), o.field_m = sampled.field_m(), o.half_height_m = 0.5 * sampled.extent_m().z;
  const mesh::Mesh mesh = aligned(input, sampled, o);
  const Body body = body_for(input, sampled, mesh);
  const Values values = values_of(sampled, body, input.place);
  o.air = values.air, o.material = values.material;
  o.voxel_noise = values.noise / std::abs(values.material - values.air);
  const std::vector<Site> sites = sites_of(mesh, body, sampled.voxel_m(), site_count);
  o.sites = sites.size();
  o.typical_width = typical_width(sampled, sites, values);
  std::vector<Row> rows = rows_of(sampled, body, values, sites, o.typical_width);
  const auto walls = std::ranges::count(rows, Reading::wall, &Row::reading);
  if (walls < static_cast<std::ptrdiff_t>(fewest_walls))
    throw Error(Exit::data, input.place,
                "shows an edge at " + std::to_string(walls) + " of " + std::to_string(sites.size()) +
                    " places of the believed surface (at least " + std::to_string(fewest_walls) + ")",
                "give the object's pose in the volume, or a finer scan");
  add_paths(input, body, values, rows, o);
  o.ring_rms = add_rings(sampled, body, values, rows);
  o.left_out = settle_row_noise(rows, o.voxel_m);
  std::tie(o.groups, o.blocks) = group_rows(rows, o.voxel_m);
  o.rows = std::move(rows);
  return o;
}

}  // namespace gonio::explain::volumes
