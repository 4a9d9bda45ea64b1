// The light's hand-eye calibration to and from the manifest, and its page.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "base/error.h"
#include "linear/geom_matrices.h"
#include "linear/symmetric_eigen.h"
#include "manifest/document.h"
#include "manifest/sections/frame_link.h"
#include "manifest/sections/light_position.h"
#include "manifest/sections/mounting.h"
#include "report/number_text.h"
#include "report/page.h"
#include "robot/light_handeye.h"

namespace gonio::robot {
namespace {

constexpr std::size_t fewest_positions = 4;
constexpr double mm = 1e3, deg = 180 / pi;

std::string pointer(std::size_t i) {
  return "/light_positions/" + std::to_string(i);
}

std::optional<Mat3> covariance_of(const manifest::Document& document, std::size_t i) {
  const std::vector<double>& given = document.light_positions[i].covariance_m2;
  if (given.empty()) return {};
  const std::string where = manifest::place(document, pointer(i) + "/covariance_m2");
  if (given.size() != 9) throw Error(Exit::data, where, "not nine numbers", "give three rows of three");
  Mat3 m;
  std::copy(given.begin(), given.end(), m.m.begin());
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < r; ++c)
      if (std::abs(m(r, c) - m(c, r)) > 1e-6 * std::sqrt(std::abs(m(r, r) * m(c, c))))
        throw Error(Exit::data, where, "not the same on both sides of its diagonal", "a covariance is symmetric");
  if (!(linear::SymmetricEigen<Eigen::Matrix3d>(linear::as_eigen(m)).eigenvalues().minCoeff() > 0))
    throw Error(Exit::data, where, "not positive definite", "state how well the position is known");
  return m;
}

Vec3 sigma_of(const manifest::Document& document, std::size_t i, const std::optional<Mat3>& covariance) {
  if (covariance) {
    const Mat3& m = *covariance;
    return {std::sqrt(m(0, 0)), std::sqrt(m(1, 1)), std::sqrt(m(2, 2))};
  }
  const std::vector<double>& given = document.light_positions[i].sigma_m;
  const std::string where = manifest::place(document, pointer(i) + "/sigma_m");
  if (given.size() != 1 && given.size() != 3)
    throw Error(Exit::data, where, "not one or three numbers", "state how well the position is known");
  const bool three = given.size() == 3;
  const Vec3 sigma{given[0], given[three ? 1 : 0], given[three ? 2 : 0]};
  if (!(std::min({sigma.x, sigma.y, sigma.z}) > 0))
    throw Error(Exit::data, where, "not above 0", "state how well the position is known");
  return sigma;
}

}  // namespace

std::vector<LightSample> light_samples(const manifest::Document& document, std::string& light,
                                       const std::string& robot) {
  const std::string section = manifest::place(document, "/light_positions");
  std::set<std::string> lights;
  for (const manifest::LightPosition& p : document.light_positions) lights.insert(p.light);
  if (light.empty() && lights.size() > 1) {
    throw Error(Exit::data, section, "positions of " + std::to_string(lights.size()) + " lights",
                "choose one with --light-name");
  }
  if (light.empty() && lights.size() == 1) light = *lights.begin();
  std::vector<LightSample> samples;
  for (std::size_t i = 0; i < document.light_positions.size(); ++i) {
    const manifest::LightPosition& p = document.light_positions[i];
    if (p.light != light || (!robot.empty() && !p.robot.empty() && p.robot != robot)) continue;
    if (p.position_m.size() != 3) {
      throw Error(Exit::data, manifest::place(document, pointer(i) + "/position_m"), "not three numbers",
                  "give x, y, z in metres");
    }
    samples.push_back({p.id, *p.base_from_tool, {p.position_m[0], p.position_m[1], p.position_m[2]}, {}, {}});
    samples.back().covariance_m2 = covariance_of(document, i);
    samples.back().sigma_m = sigma_of(document, i, samples.back().covariance_m2);
  }
  if (samples.size() < fewest_positions) {
    throw Error(Exit::data, section, std::to_string(samples.size()) + " positions of the light (at least 4 are needed)",
                "find the light at ten or more poses with turns about different axes");
  }
  const bool moves = std::ranges::any_of(samples, [&](const LightSample& s) {
    const auto between = inverse(samples[0].base_from_tool) * s.base_from_tool;
    return norm(between.translation_m) > 1e-6 || norm(rotation_vector_of(between.rotation)) > 1e-6;
  });
  if (!moves) throw Error(Exit::data, section, "the robot's poses are all the same", "give the pose of every position");
  return samples;
}

void enter_light_mounting(const LightMounting& m, const std::string& light, const std::string& robot,
                          manifest::Document& document) {
  manifest::Mounting entry;
  entry.kind = "light-in-hand";
  entry.light = light;
  entry.robot = robot;
  entry.method = "weighted least squares from alternated Procrustes";
  std::erase_if(document.frames, [](const manifest::Link& link) { return link.to == "world" && link.from == "base"; });
  if (m.base_known) {
    manifest::Pose<frame::World, frame::Base> pose;
    pose.rotation = m.world_from_base.rotation;
    pose.translation_m = m.world_from_base.translation_m;
    pose.sigma = manifest::PoseSigma{{m.sigma(0), m.sigma(1), m.sigma(2)}, {m.sigma(3), m.sigma(4), m.sigma(5)}};
    entry.world_from_base = pose;
    document.frames.push_back({"world", "base", pose.rotation, pose.translation_m, pose.sigma});
  }
  if (m.light_known) {
    entry.light_in_tool_m = {m.light_in_tool_m.x, m.light_in_tool_m.y, m.light_in_tool_m.z};
    entry.sigma["light_in_tool_m"] = {m.sigma(6), m.sigma(7), m.sigma(8)};
  }
  entry.robot_m = m.robot_m;
  entry.scatter_m = m.scatter_m;
  entry.unobservable = m.unobservable;
  if (m.unobservable.empty()) {
    const std::vector<std::string> order{"world_from_base.rotation_x_rad",
                                         "world_from_base.rotation_y_rad",
                                         "world_from_base.rotation_z_rad",
                                         "world_from_base.x_m",
                                         "world_from_base.y_m",
                                         "world_from_base.z_m",
                                         "light_in_tool.x_m",
                                         "light_in_tool.y_m",
                                         "light_in_tool.z_m"};
    manifest::Value values = manifest::Value::array();
    for (std::size_t i = 0; i < 9; ++i) {
      const double* row = m.covariance.data() + 9 * i;
      values.push_back(manifest::Value(std::vector<double>(row, row + 9)));
    }
    entry.covariance = manifest::Value::object({{"order", manifest::Value(order)}, {"values", values}});
  }
  document.mountings[light.empty() ? "light" : light] = entry;
}

std::string light_page(const LightMounting& m, const std::vector<LightSample>& samples, const std::string& light) {
  using report::number_text;
  const bool known = m.unobservable.empty();
  const double worst = std::max({m.sigma(6), m.sigma(7), m.sigma(8)});
  report::Page page(
      "Hand-eye calibration of a light",
      known ? "The light\u2019s place on the tool is known within " + number_text(1.96 * worst * mm, 2) + " mm at 95 %."
            : "These poses do not determine the " + m.unobservable.front() + ".",
      "Light \u201c" + light + "\u201d at " + std::to_string(samples.size()) + " poses.",
      known ? report::Tone::good : report::Tone::bad);
  page.section("Result");
  if (!known) page.list(m.unobservable);
  report::TableText table;
  table.columns = {{"", "", false},   {"x", "mm"},       {"y", "mm"},      {"z", "mm"},
                   {"turn x", "deg"}, {"turn y", "deg"}, {"turn z", "deg"}};
  const auto cell = [](double value, double sigma, bool is_known) {
    return is_known ? report::with_sigma(value, sigma) : std::string("not determined");
  };
  const Vec3 t = m.world_from_base.translation_m, r = rotation_vector_of(m.world_from_base.rotation),
             l = m.light_in_tool_m;
  std::vector<std::string> base{"world_from_base"}, place{"light in tool"};
  for (int k = 0; k < 3; ++k)
    base.push_back(cell(t[k] * mm, m.sigma(3 + static_cast<std::size_t>(k)) * mm, m.base_known));
  for (int k = 0; k < 3; ++k)
    base.push_back(cell(r[k] * deg, m.sigma(static_cast<std::size_t>(k)) * deg, m.base_known));
  for (int k = 0; k < 3; ++k)
    place.push_back(cell(l[k] * mm, m.sigma(6 + static_cast<std::size_t>(k)) * mm, m.light_known));
  place.insert(place.end(), 3, "");
  table.rows = {base, place};
  table.caption =
      "\u00b1: one standard deviation; noise beyond the positions\u2019 own: " + number_text(m.robot_m * mm, 2) +
      " mm a coordinate.";
  page.table(table);
  page.section("Residuals");
  report::TableText list;
  list.columns = {{"Position", "", false}, {"x", "mm"}, {"y", "mm"}, {"z", "mm"}, {"distance", "mm"}};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3 e = m.residual_m[i];
    list.rows.push_back({samples[i].id, number_text(e.x * mm, 3), number_text(e.y * mm, 3), number_text(e.z * mm, 3),
                         number_text(norm(e) * mm, 3)});
  }
  page.table(list);
  page.footer("handeye, gonio " GONIO_VERSION ". This page is one file and loads nothing.");
  return page.html();
}

}  // namespace gonio::robot
