// See probe_scene.h.
#include "explain/tables/probe_scene.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "explain/tables/read_table.h"
#include "linear/geom_matrices.h"
#include "linear/solve.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "probe/highlight_rows.h"
#include "probe/unwrap.h"

namespace gonio::explain::tables {
namespace {

static_assert(gonio::probe::fewest_rows == fewest_rows && gonio::probe::fewest_groups == fewest_groups);
constexpr const char* place_key = "position_m";

struct Cells {  // of one row
  const Table& table;
  std::size_t row;
  double operator()(const char* column) const {
    const std::vector<double>* values = table.find(column);
    return values == nullptr ? 0 : (*values)[row];
  }
};

ProbeBall ball_in(const Table& table, std::size_t row, const std::string& name) {
  const Cells cell{table, row};
  ProbeBall ball{name, {{cell("ball_x_m"), cell("ball_y_m"), cell("ball_z_m")}, cell("radius_m")}, false, {}};
  const Vec3 s{cell("ball_sigma_x_m"), cell("ball_sigma_y_m"), cell("ball_sigma_z_m")};
  if (!(ball.stated.radius_m > 0))
    throw Error(Exit::data, table.place, "has ball " + name + " with radius_m " + shortest_text(ball.stated.radius_m),
                "radii are above 0");
  if (s.x == 0 && s.y == 0 && s.z == 0) return ball;
  const double xy = cell("ball_correlation_xy") * s.x * s.y, xz = cell("ball_correlation_xz") * s.x * s.z,
               yz = cell("ball_correlation_yz") * s.y * s.z;
  const linear::Llt factor(linear::as_eigen(Mat3{{s.x * s.x, xy, xz, xy, s.y * s.y, yz, xz, yz, s.z * s.z}}));
  if (factor.info() != Eigen::Success)
    throw Error(Exit::data, table.place, "has ball " + name + " with ball_sigma and ball_correlation of no covariance",
                "sigmas are all above 0 or all 0, correlations between -1 and 1");
  const Eigen::MatrixXd root = factor.lower();
  for (int k = 0; k < 3; ++k) ball.root[static_cast<std::size_t>(k)] = {root(0, k), root(1, k), root(2, k)};
  ball.uncertain = true;
  return ball;
}

bool same(const ProbeBall& a, const ProbeBall& b) {
  constexpr double near_m = 1e-9;
  bool all =
      norm(a.stated.centre_m - b.stated.centre_m) < near_m && std::abs(a.stated.radius_m - b.stated.radius_m) < near_m;
  for (std::size_t k = 0; k < a.root.size(); ++k) all = all && norm(a.root[k] - b.root[k]) < near_m;
  return all;
}

ProbeLamp lamp_of(const manifest::Document& document, const std::string& name, Vec3 middle_m) {
  ProbeLamp lamp{name};
  const auto found = document.lights.find(name);
  if (found == document.lights.end()) return lamp;
  const manifest::Parameters& p = found->second.parameters;
  if (const auto place = p.find(place_key); place != p.end() && place->second.given()) {
    const Vec3 way = place->second.vector() - middle_m;
    lamp.in_manifest = true;
    lamp.inverse_distance_per_m = 1 / norm(way);
    lamp.frame = Basis(normalized(way));
  } else if (const auto towards = p.find("towards"); towards != p.end() && towards->second.given()) {
    lamp.in_manifest = true;
    lamp.frame = Basis(normalized(towards->second.vector()));
  }
  return lamp;
}

// Where lamps that the manifest does not know are looked for first: where their highlights, as the balls are stated,
// mirror the cameras' rays to.
void find_lamps(ProbeScene& scene, const Table& table) {
  for (std::size_t l = 0; l < scene.lamps.size(); ++l) {
    if (scene.lamps[l].in_manifest) continue;
    Vec3 sum{};
    for (std::size_t r = 0; r < scene.rows.size(); ++r) {
      const ProbeRow& s = scene.rows[r];
      if (s.lamp != l) continue;
      const ImageView& view = scene.views[s.view];
      const camera::Ray ray = view.camera.ray({table.values[table.observed[0]][r], table.values[table.observed[1]][r]});
      const auto seen =
          gonio::probe::mirror_before(view.camera, view.world_from_camera, scene.balls[s.ball].stated)
              .reflect(view.world_from_camera * ray.origin_m, view.world_from_camera.rotate(ray.direction));
      if (!seen)
        throw Error(Exit::data, scene.place,
                    "has a highlight of lamp \"" + scene.lamps[l].name + "\" in image \"" + view.image +
                        "\" beside ball " + scene.balls[s.ball].name,
                    "check u_px, v_px and where the ball is");
      sum += seen->direction;
    }
    if (!(norm(sum) > 0.1))
      throw Error(Exit::data, scene.place, "has highlights of lamp \"" + scene.lamps[l].name + "\" in all directions",
                  "check which highlights are of one lamp");
    scene.lamps[l].frame = Basis(normalized(sum));
  }
}

}  // namespace

ProbeScene probe_scene(const manifest::Document& document, const std::string&, const Table& table) {
  for (const gonio::probe::HighlightColumn& column : gonio::probe::highlight_columns())
    if (column.needed || table.place_of(column.name) != Table::none) table.needed(column.name, column.unit);
  const Names images = names_in(table, "image", manifest::names_in(document, "images")),
              balls = names_in(table, "ball", {}),
              lamps = names_in(table, "lamp", manifest::names_in(document, "lights"));
  ProbeScene scene;
  scene.place = table.place;
  std::vector<std::size_t> camera_of_view;
  for (const std::string& id : images.all) {
    scene.views.push_back(image_view(document, id, table));
    const std::string& camera = scene.views.back().camera_name;
    const auto known = std::ranges::find(scene.cameras, camera, &ProbeCamera::name);
    camera_of_view.push_back(static_cast<std::size_t>(known - scene.cameras.begin()));
    if (known == scene.cameras.end()) scene.cameras.push_back({camera, scene.views.back().camera});
  }
  for (std::size_t r = 0; r < table.rows(); ++r) {
    const ProbeRow row{images.of_row[r], camera_of_view[images.of_row[r]], balls.of_row[r], lamps.of_row[r]};
    const ProbeBall ball = ball_in(table, r, balls.all[row.ball]);
    if (row.ball == scene.balls.size()) scene.balls.push_back(ball);
    if (!same(scene.balls[row.ball], ball))
      throw Error(Exit::data, table.place, "has ball " + ball.name + " at two places, or of two sizes",
                  "call each ball by a name of its own");
    scene.rows.push_back(row);
  }
  for (const ProbeBall& ball : scene.balls)
    scene.middle_m += ball.stated.centre_m / static_cast<double>(scene.balls.size());
  for (const std::string& lamp : lamps.all) scene.lamps.push_back(lamp_of(document, lamp, scene.middle_m));
  find_lamps(scene, table);
  return scene;
}

void write_back(const FittedLamp& lamp, manifest::Light& light) {
  const auto list = [](Vec3 v) { return std::vector<double>{v.x, v.y, v.z}; };
  const auto spread = [](Vec3 a, Vec3 b, Vec3 c) {
    return std::vector<double>{std::hypot(a.x, b.x, c.x), std::hypot(a.y, b.y, c.y), std::hypot(a.z, b.z, c.z)};
  };
  if (!(lamp.inverse_distance_per_m > 0)) {
    if (!light.parameters.contains("towards")) return;
    light.parameters["towards"].value = list(lamp.towards);
    light.sigma["towards"] = spread(lamp.sigma_1, lamp.sigma_2, {});
    return;
  }
  const double d = 1 / lamp.inverse_distance_per_m, relative = lamp.inverse_distance_sigma * d;
  light.parameters[place_key].value = list(lamp.middle_m + lamp.towards * d);
  light.sigma[place_key] = spread(lamp.sigma_1 * d, lamp.sigma_2 * d, lamp.towards * (d * relative));
  light.parameters.erase("towards"), light.sigma.erase("towards");
  const auto irradiance = light.parameters.find("watt_per_m2");
  if (light.model != "directional" || irradiance == light.parameters.end()) return;
  light.model = "point";
  manifest::Parameter intensity = irradiance->second;
  std::vector<double> sigma = light.sigma["watt_per_m2"];
  sigma.resize(intensity.value.size(), 0);
  for (std::size_t k = 0; k < sigma.size(); ++k) {
    sigma[k] = d * d * std::hypot(sigma[k], 2 * intensity.value[k] * relative);
    intensity.value[k] *= d * d;
  }
  light.parameters["watt_per_sr"] = intensity, light.sigma["watt_per_sr"] = sigma;
  light.parameters.erase("watt_per_m2"), light.sigma.erase("watt_per_m2");
}

}  // namespace gonio::explain::tables
