// Evaluation and reading of published fits; formulas in the header.
#include "goniometry/reconstruction/published_fits.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"

namespace gonio::tests {
namespace {

double shadowing(const BagherChannel& f, double cosine) {
  const double beyond = std::acos(std::min(cosine, 1.0)) - f.theta_0;
  const double g = beyond > 0 ? 1 + f.lambda * (1 - std::exp(f.c * std::pow(beyond, f.k))) : 1;
  return std::clamp(g, 0.0, 1.0);
}

double dielectric(double cosine, double ior) {
  const double g = std::sqrt(std::max(0.0, ior * ior + cosine * cosine - 1));
  const double s = (g - cosine) / (g + cosine), p = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1);
  return 0.5 * s * s * (1 + p * p);
}

// Rows of named numbers; the first column is the name.
struct Row {
  std::string name;
  std::map<std::string, double> number;
  std::array<double, 3> rgb(const std::string& what) const {
    return {number.at(what + "_r"), number.at(what + "_g"), number.at(what + "_b")};
  }
};

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> parts;
  std::istringstream stream(line);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

std::vector<Row> read_rows(const std::filesystem::path& csv) {
  std::istringstream lines(read_file(csv));
  std::string line;
  std::getline(lines, line);
  const auto heads = fields(line);
  std::vector<Row> rows;
  while (std::getline(lines, line)) {
    const auto parts = fields(line);
    if (parts.size() != heads.size()) throw Error(Exit::data, csv.string(), "has a row of another length");
    Row row{parts[0], {}};
    for (std::size_t i = 1; i < parts.size(); ++i)
      if (heads[i] != "other_name") row.number[heads[i]] = std::stod(parts[i]);
    rows.push_back(row);
  }
  return rows;
}

template <class Fit>
std::vector<goniometry::Material> as_materials(const std::vector<Fit>& fits) {
  std::vector<goniometry::Material> materials;
  for (const Fit& fit : fits) materials.push_back({fit.name, [fit](Vec3 wo, Vec3 wi) { return fit.evaluate(wo, wi); }});
  return materials;
}

}  // namespace

double BagherChannel::evaluate(Vec3 wo, Vec3 wi) const {
  if (wo.z <= 0 || wi.z <= 0) return 0;
  const Vec3 h = normalized(wo + wi);
  const double c2 = h.z * h.z, u = alpha + (1 - c2) / c2 / alpha, cos_d = dot(wi, h);
  const double d = rho_s * kap * std::exp(-u) / std::pow(u, p) / (pi * c2 * c2);
  const double fresnel = std::max(0.0, f0 - f1 * cos_d + (1 - f0) * std::pow(1 - cos_d, 5));
  return (rho_d + fresnel * d * shadowing(*this, wo.z) * shadowing(*this, wi.z) / (wo.z * wi.z)) / pi;
}

Rgb BagherFit::evaluate(Vec3 wo, Vec3 wi) const {
  return {channels[0].evaluate(wo, wi), channels[1].evaluate(wo, wi), channels[2].evaluate(wo, wi)};
}

Rgb LowFit::evaluate(Vec3 wo, Vec3 wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  const Vec3 h = normalized(wo + wi);
  const double cos_d = dot(wi, h), g = std::min({1.0, 2 * h.z * wo.z / cos_d, 2 * h.z * wi.z / cos_d});
  const double lobe = dielectric(cos_d, ior) * g / std::pow(1 + b * (1 - h.z), c) / (pi * wo.z * wi.z);
  return k_d / pi + a * lobe;
}

std::vector<BagherFit> read_bagher_fits(const std::filesystem::path& csv) {
  std::vector<BagherFit> fits;
  for (const Row& row : read_rows(csv)) {
    BagherFit fit{row.name, {}};
    for (std::size_t i = 0; i < 3; ++i)
      fit.channels[i] = {row.rgb("rhoD")[i], row.rgb("rhoS")[i], row.rgb("alpha")[i], row.rgb("p")[i],
                         row.rgb("f0")[i],   row.rgb("f1")[i],   row.rgb("kap")[i],   row.rgb("lambda")[i],
                         row.rgb("c")[i],    row.rgb("k")[i],    row.rgb("theta0")[i]};
    fits.push_back(fit);
  }
  return fits;
}

std::vector<LowFit> read_low_fits(const std::filesystem::path& csv) {
  std::vector<LowFit> fits;
  for (const Row& row : read_rows(csv)) {
    const auto kd = row.rgb("kD"), a = row.rgb("A");
    fits.push_back({row.name,
                    {kd[0], kd[1], kd[2]},
                    {a[0], a[1], a[2]},
                    row.number.at("B"),
                    row.number.at("C"),
                    row.number.at("ior")});
  }
  return fits;
}

std::vector<goniometry::Material> materials_of(const std::vector<BagherFit>& fits) {
  return as_materials(fits);
}
std::vector<goniometry::Material> materials_of(const std::vector<LowFit>& fits) {
  return as_materials(fits);
}

}  // namespace gonio::tests
