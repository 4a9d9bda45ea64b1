// See highlight_rows.h.
#include "probe/highlight_rows.h"

#include <cmath>
#include <set>

#include "base/text.h"
#include "goniometry/outputs.h"

namespace gonio::probe {

const std::vector<HighlightColumn>& highlight_columns() {
  static const std::vector<HighlightColumn> columns = {
      {"image", "", "photograph: an image of the manifest, with its camera and world_from_camera"},
      {"ball", "", "which of the balls"},
      {"lamp", "", "whose highlight it is: a light of the manifest, or any name"},
      {"view", "", "of one ball in one photograph", false},
      {"ball_x_m", "m", "of the ball's centre, in the world"},
      {"ball_y_m", "m", "of the ball's centre, in the world"},
      {"ball_z_m", "m", "of the ball's centre, in the world"},
      {"radius_m", "m", "of the ball"},
      {"ball_sigma_x_m", "m", "standard deviation of ball_x_m; 0: known exactly", false},
      {"ball_sigma_y_m", "m", "standard deviation of ball_y_m", false},
      {"ball_sigma_z_m", "m", "standard deviation of ball_z_m", false},
      {"ball_correlation_xy", "1", "of the errors of ball_x_m and ball_y_m", false},
      {"ball_correlation_xz", "1", "of the errors of ball_x_m and ball_z_m", false},
      {"ball_correlation_yz", "1", "of the errors of ball_y_m and ball_z_m", false},
      {"u_px", "px", "where the highlight is seen"},
      {"v_px", "px", "where the highlight is seen"},
      {"u_sigma_px", "px", "standard deviation of u_px"},
      {"v_sigma_px", "px", "standard deviation of v_px"}};
  return columns;
}

namespace {

std::string view_of(const HighlightRow& row) {
  return row.image + " ball " + row.ball;
}

}  // namespace

std::string highlight_group(std::span<const HighlightRow> rows) {
  std::set<std::string> views, lamps;
  for (const HighlightRow& r : rows) views.insert(view_of(r)), lamps.insert(r.lamp);
  if (rows.size() < fewest_rows) return {};
  return views.size() >= fewest_groups ? "view" : views.size() > 1 && lamps.size() >= fewest_groups ? "lamp" : "";
}

std::string highlight_csv(std::span<const HighlightRow> rows) {
  std::string csv;
  for (const HighlightColumn& c : highlight_columns()) csv += (csv.empty() ? "" : ",") + c.name;
  csv += "\n";
  for (const HighlightRow& r : rows) {
    const Vec3 o = r.stated.centre_m;
    const auto deviation = [&](int k) { return std::sqrt(r.covariance_m2(k, k)); };
    const Vec3 sigma{deviation(0), deviation(1), deviation(2)};
    const auto correlation = [&](int i, int j) {
      return sigma[i] > 0 && sigma[j] > 0 ? r.covariance_m2(i, j) / (sigma[i] * sigma[j]) : 0;
    };
    csv += goniometry::quoted(r.image) + "," + goniometry::quoted(r.ball) + "," + goniometry::quoted(r.lamp) + "," +
           goniometry::quoted(view_of(r));
    for (const double v : {o.x, o.y, o.z, r.stated.radius_m, sigma.x, sigma.y, sigma.z, correlation(0, 1),
                           correlation(0, 2), correlation(1, 2), r.seen_px.x, r.seen_px.y, r.sigma_px.x, r.sigma_px.y})
      csv += "," + shortest_text(v);
    csv += "\n";
  }
  return csv;
}

manifest::Table highlight_table(const std::string& file, const std::string& group) {
  manifest::Table table;
  table.file = file;
  table.model = "probe";
  for (const HighlightColumn& c : highlight_columns()) table.columns.emplace_back(c.name, c.unit);
  table.observed = {"u_px", "v_px"};
  table.sigma = {"u_sigma_px", "v_sigma_px"};
  table.group = group;
  return table;
}

std::string reflected_csv(std::span<const HighlightRow> rows, const Metal& metal) {
  std::string csv = std::string("view,direction,channel,highlight,theta_i,") +
                    (metal.perfect ? "" : "metal_n,metal_k,") + "value,value_sigma\n";
  std::set<std::string> views;
  std::size_t written = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const HighlightRow& r = rows[k];
    if (r.clipped) continue;
    views.insert(view_of(r)), ++written;
    for (int c = 0; c < 3; ++c) {
      csv += goniometry::quoted(view_of(r)) + "," + goniometry::quoted(r.lamp) + "," + std::to_string(c) + "," +
             std::to_string(k) + "," + shortest_text(r.theta_i);
      if (!metal.perfect) csv += "," + shortest_text(metal.eta[c]) + "," + shortest_text(metal.k[c]);
      csv += "," + shortest_text(r.reflected[c]) + "," + shortest_text(r.reflected_sigma[c]) + "\n";
    }
  }
  return written >= fewest_rows && views.size() >= fewest_groups ? csv : "";
}

manifest::Table reflected_table(const std::string& file, const Metal& metal) {
  manifest::Table table;
  table.file = file;
  table.model = "probe-radiance";
  table.columns = {{"view", ""}, {"direction", ""}, {"channel", ""}, {"highlight", ""}, {"theta_i", "rad"}};
  if (!metal.perfect)
    for (const char* name : {"metal_n", "metal_k"}) table.columns.emplace_back(name, "1");
  for (const char* name : {"value", "value_sigma"}) table.columns.emplace_back(name, "1");
  table.observed = {"value"};
  table.sigma = {"value_sigma"};
  table.group = "view";
  table.block = "highlight";
  return table;
}

}  // namespace gonio::probe
