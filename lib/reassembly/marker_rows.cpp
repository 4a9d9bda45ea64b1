// Columns of the table of sightings, its text, and what stands between a camera and a marker.
#include "reassembly/marker_rows.h"

#include <algorithm>
#include <functional>
#include <optional>

#include "base/text.h"

namespace gonio::reassembly {
namespace {

constexpr std::array<const char*, most_walls> wall_names = {"glass_", "glass2_"};

std::string quoted(const std::string& name) {  // RFC 4180
  if (name.find_first_of(",\"\r\n# ") == std::string::npos) return name;
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

std::vector<double> numbers_of(const MarkerRow& row) {
  std::vector<double> n{row.centre_m.x, row.centre_m.y, row.centre_m.z, row.centre_sigma_m, row.normal.x,  row.normal.y,
                        row.normal.z,   row.seen_px.x,  row.seen_px.y,  row.sigma_px.x,     row.sigma_px.y};
  for (const GlassWall& w : row.glass)
    n.insert(n.end(), {w.path_m, w.behind_m, w.in.x, w.in.y, w.in.z, w.out.x, w.out.y, w.out.z});
  return n;
}

std::vector<MarkerColumn> all_columns() {
  std::vector<MarkerColumn> columns{
      {"image", "", "id of the photograph, whose camera and pose the manifest has"},
      {"piece", "", "id of the object that the marker is glued to"},
      {"marker", "", "id of the marker; its rows are held out together"},
      {"x_m", "m", "of the marker's centre by the tomograph, in the object's frame"},
      {"y_m", "m", "of the same"},
      {"z_m", "m", "of the same"},
      {"centre_sigma_m", "m", "one standard deviation of each of these coordinates; 0: known exactly", false},
      {"nx", "1", "of the piece's outward normal at the marker, object's frame; 0 0 0: not known", false},
      {"ny", "1", "of the same", false},
      {"nz", "1", "of the same", false},
      {"u_px", "px", "where the axis of the marker's cone meets the picture"},
      {"v_px", "px", "of the same"},
      {"u_sigma_px", "px", "one standard deviation of u_px", false},
      {"v_sigma_px", "px", "one standard deviation of v_px", false}};
  for (std::size_t wall = 0; wall < most_walls; ++wall) {
    const auto add = [&](const std::string& what, const std::string& unit, const std::string& meaning) {
      columns.push_back({glass_column(wall, what), unit, meaning, false});
    };
    add("path_m", "m", "of the line of sight within a wall of glass in front of the marker; 0: there is none");
    add("behind_m", "m", "from where that line leaves the wall to the marker's centre");
    for (const char* side : {"in", "out"})
      for (const char* axis : {"_x", "_y", "_z"})
        add(std::string(side) + axis, "1",
            std::string("outward normal of the wall where the line goes ") + side + ", world frame");
  }
  return columns;
}

struct Crossing {
  double t = 0;
  Vec3 normal;  // world frame, out of the glass
};

// All crossings of the line with one mesh, up to t = 1.
std::vector<Crossing> crossings_of(const PosedMesh& posed, Vec3 from_m, Vec3 to_m) {
  const auto object_from_world = inverse(posed.world_from_object);
  const Vec3 origin = object_from_world * from_m, along = object_from_world * to_m - origin;
  std::vector<Crossing> all;
  double t = 0;
  while (const auto hit = posed.tree->first_hit(origin, along, t)) {
    if (hit->t >= 1) break;
    const auto& corner = posed.mesh->triangles[hit->triangle];
    const auto& p = posed.mesh->positions_m;
    const Vec3 n = cross(p[corner[1]] - p[corner[0]], p[corner[2]] - p[corner[0]]);
    all.push_back({hit->t, normalized(posed.world_from_object.rotate(n))});
    t = hit->t + 1e-9;
  }
  return all;
}

Vec3 normal_at(const PosedMesh& posed, Vec3 world_m) {
  return posed.world_from_object.rotate(
      outward_normal(*posed.mesh, *posed.tree, inverse(posed.world_from_object) * world_m));
}

}  // namespace

std::string glass_column(std::size_t wall, const std::string& what) {
  return wall_names[wall] + what;
}

const std::vector<MarkerColumn>& marker_columns() {
  static const std::vector<MarkerColumn> columns = all_columns();
  return columns;
}

std::string marker_csv(std::span<const MarkerRow> rows) {
  std::string text;
  for (const MarkerColumn& column : marker_columns()) text += (text.empty() ? "" : ",") + column.name;
  text += "\n";
  for (const MarkerRow& row : rows) {
    text += quoted(row.image) + "," + quoted(row.piece) + "," + quoted(row.marker);
    for (const double n : numbers_of(row)) text += "," + shortest_text(n);
    text += "\n";
  }
  return text;
}

manifest::Table marker_table(const std::string& file) {
  manifest::Table table;
  table.file = file;
  table.model = "markers";
  for (const MarkerColumn& column : marker_columns()) table.columns.emplace_back(column.name, column.unit);
  table.observed = {"u_px", "v_px"};
  table.sigma = {"u_sigma_px", "v_sigma_px"};
  table.group = "marker";
  return table;
}

Vec3 outward_normal(const mesh::Mesh& mesh, const mesh::TriangleTree& tree, Vec3 point_m) {
  const auto nearest = tree.nearest(point_m);
  const auto& corner = mesh.triangles.at(nearest.triangle);
  const auto& p = mesh.positions_m;
  return normalized(cross(p[corner[1]] - p[corner[0]], p[corner[2]] - p[corner[0]]));
}

std::array<GlassWall, most_walls> walls_between(Vec3 camera_m, Vec3 marker_m, double radius_m,
                                                std::span<const PosedMesh> meshes) {
  const double length = norm(marker_m - camera_m);
  std::vector<GlassWall> walls;
  for (const PosedMesh& posed : meshes) {
    const Vec3 along = marker_m - camera_m;
    std::optional<Crossing> in;
    for (const Crossing& c : crossings_of(posed, camera_m, marker_m)) {
      const bool enters = dot(c.normal, along) < 0;
      if (enters && !in) in = c;
      if (enters || !in) continue;
      GlassWall wall{(c.t - in->t) * length, (1 - c.t) * length, in->normal, c.normal};
      in.reset();
      if (wall.behind_m > 0) walls.push_back(wall);
    }
    // A marker on the far side of its own wall stands right behind it, or its centre still within: the wall ends there.
    if (in && (1 - in->t) * length > radius_m)
      walls.push_back({(1 - in->t) * length, 0, in->normal, normal_at(posed, marker_m)});
  }
  std::ranges::sort(walls, std::greater{}, &GlassWall::behind_m);
  std::array<GlassWall, most_walls> result{};
  std::copy_n(walls.begin(), std::min(walls.size(), most_walls), result.begin());
  return result;
}

}  // namespace gonio::reassembly
