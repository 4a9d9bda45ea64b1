// See reflectance_rows.h.
#include "explain/tables/reflectance_rows.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "linear/solve.h"
#include "stats/intervals.h"
#include "surface/microfacet.h"

namespace gonio::explain::tables {
namespace {

constexpr std::size_t most_bands = 64;
constexpr std::size_t neighbours = 8, fewest_for_noise = 20;
constexpr double least_noise = 1e-3, noise_unknown = 0.02;

Vec3 direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

std::string nanometres(double metres) {
  return std::to_string(static_cast<long>(std::lround(metres * 1e9))) + " nm";
}

std::string channel_name(double channel) {
  const long c = std::lround(channel);
  return c == 0 ? "r" : c == 1 ? "g" : c == 2 ? "b" : std::to_string(c);
}

// Bands by the value of a column.
void bands_of_column(const Table& table, const std::vector<double>& column, bool wavelengths, ReflectanceRows& rows) {
  std::map<long, std::size_t> places;  // in picometres, or channels
  const auto key = [&](double v) { return std::lround(wavelengths ? v * 1e12 : v); };
  for (const double v : column) places.try_emplace(key(v), 0);
  if (places.size() > most_bands)
    throw Error(Exit::data, table.place, "has " + std::to_string(places.size()) + " wavelengths",
                "keep at most " + std::to_string(most_bands));
  std::size_t next = 0;
  for (auto& [k, place] : places) {
    place = next++;
    const double value = wavelengths ? static_cast<double>(k) * 1e-12 : static_cast<double>(k);
    rows.band_name.push_back(places.size() == 1 ? "" : wavelengths ? nanometres(value) : channel_name(value));
    if (wavelengths) rows.band_m.push_back(value);
  }
  for (const double v : column) rows.band.push_back(places.at(key(v)));
}

void find_bands(const Table& table, ReflectanceRows& rows) {
  rows.observed = table.observed.size();
  const std::vector<double>*wavelength = table.find("wavelength_m"), *channel = table.find("channel");
  if (rows.observed == 1 && (wavelength != nullptr || channel != nullptr)) {
    bands_of_column(table, wavelength != nullptr ? *wavelength : *channel, wavelength != nullptr, rows);
  } else {
    for (std::size_t r = 0; r < table.rows(); ++r)
      for (std::size_t k = 0; k < rows.observed; ++k) rows.band.push_back(k);
    for (std::size_t k = 0; k < rows.observed; ++k)
      rows.band_name.push_back(rows.observed == 1   ? ""
                               : rows.observed == 3 ? channel_name(static_cast<double>(k))
                                                    : table.columns[table.observed[k]]);
  }
  rows.rows_of_band.resize(rows.band_name.size());
  for (std::size_t i = 0; i < rows.band.size(); ++i) rows.rows_of_band[rows.band[i]].push_back(i);
}

// Distance of z from a plane through its neighbours, in units of its own noise: the residual over sqrt(1 + leverage).
double off_plane(const std::vector<Vec3>& at, const std::vector<double>& z, std::size_t own,
                 const std::vector<std::size_t>& near) {
  Eigen::Matrix<double, Eigen::Dynamic, 3> a(static_cast<Eigen::Index>(near.size()), 3);
  Eigen::VectorXd b(a.rows());
  for (Eigen::Index k = 0; k < a.rows(); ++k) {
    const std::size_t i = near[static_cast<std::size_t>(k)];
    a.row(k) << 1, at[i].x - at[own].x, at[i].y - at[own].y;
    b[k] = z[i];
  }
  Eigen::Matrix3d h = a.transpose() * a;
  h.diagonal() += Eigen::Vector3d(1e-9, 1e-9, 1e-9);  // points on a line
  const Eigen::Vector3d weights = linear::solve_ldlt(h, Eigen::Vector3d(1, 0, 0));
  return (z[own] - weights.dot(a.transpose() * b)) / std::sqrt(1 + weights[0]);
}

using Incidence = std::array<long, 3>;
Incidence incidence_of(Vec3 w) {
  return {std::lround(w.x * 1e4), std::lround(w.y * 1e4), std::lround(w.z * 1e4)};
}

// Of rows of one band and one incidence.
void neighbour_noise(const ReflectanceRows& rows, const std::vector<double>& z, const std::vector<std::size_t>& members,
                     std::vector<double>& found) {
  std::vector<Vec3> at;
  std::vector<double> here;
  for (const std::size_t i : members) at.push_back(rows.wo[i / rows.observed]), here.push_back(z[i]);
  if (at.size() < neighbours + 1) return;
  std::vector<std::pair<double, std::size_t>> by_distance(at.size());
  for (std::size_t own = 0; own < at.size(); ++own) {
    for (std::size_t k = 0; k < at.size(); ++k) by_distance[k] = {k == own ? 1e9 : norm(at[k] - at[own]), k};
    std::nth_element(by_distance.begin(), by_distance.begin() + neighbours, by_distance.end());
    std::vector<std::size_t> near;
    for (std::size_t k = 0; k < neighbours; ++k) near.push_back(by_distance[k].second);
    found.push_back(std::abs(off_plane(at, here, own, near)));
  }
}

}  // namespace

int ReflectanceRows::component(std::size_t b) const {
  if (band_m.empty()) return static_cast<int>(std::min<std::size_t>(b, 2));
  return band_m[b] > 580e-9 ? 0 : band_m[b] > 490e-9 ? 1 : 2;
}

ReflectanceRows reflectance_rows(const Table& table) {
  ReflectanceRows rows;
  const std::vector<double>&ti = table.needed("theta_i", "rad"), &pi_ = table.needed("phi_i", "rad"),
        &to = table.needed("theta_o", "rad"), &po = table.needed("phi_o", "rad");
  for (std::size_t r = 0; r < table.rows(); ++r) {
    rows.wi.push_back(direction(ti[r], pi_[r]));
    rows.wo.push_back(direction(to[r], po[r]));
    const double ci = rows.wi[r].z, co = rows.wo[r].z;
    rows.weight.push_back(ci > 1e-9 && co > 1e-9 ? 100 * ci * co : 0);
  }
  find_bands(table, rows);
  if (const std::vector<double>* excitation = table.find("excitation")) rows.excitation = *excitation;
  return rows;
}

// The difference angle is half the phase angle, to the bit: the one that people set stands before it.
std::vector<Condition> reflectance_conditions(const ReflectanceRows& rows) {
  std::vector<Condition> all = {{"surface.half-angle", "rad", "surface", {}, {}, "ln"},
                                {"surface.incidence-angle", "rad", "surface", {}, {}, "ln"},
                                {"surface.exitance-angle", "rad", "surface", {}, {}, "ln"},
                                {"surface.phase-angle", "rad", "surface", {}, {}, "ln"},
                                {"surface.difference-angle", "rad", "surface", {}, {}, "ln"},
                                {"surface.azimuth", "rad", "surface", {}, {}, "ln"}};
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    const Vec3 wi = rows.wi[r], wo = rows.wo[r], h = surface::half_vector(wo, wi);
    const double azimuth = std::hypot(h.x, h.y) > 1e-6 ? std::remainder(std::atan2(h.y, h.x), pi) : std::nan("");
    const double phase = std::acos(std::clamp(dot(wi, wo), -1.0, 1.0));
    const std::array<double, 6> at = {std::acos(std::clamp(h.z, -1.0, 1.0)),
                                      std::acos(std::clamp(wi.z, -1.0, 1.0)),
                                      std::acos(std::clamp(wo.z, -1.0, 1.0)),
                                      phase,
                                      0.5 * phase,
                                      azimuth};
    for (std::size_t k = 0; k < at.size(); ++k) all[k].values.push_back(at[k]);
  }
  if (rows.observed == 1 && rows.band_m.size() > 1) {
    Condition wavelength{"surface.wavelength", "m", "surface", {}, {}, "ln"};
    for (const std::size_t b : rows.band) wavelength.values.push_back(rows.band_m[b]);
    all.push_back(std::move(wavelength));
  }
  if (!rows.excitation.empty()) all.push_back({"surface.excitation", "1", "surface", rows.excitation, {}, "ln"});
  return all;
}

double reflectance_noise(const ReflectanceRows& rows, const std::vector<double>& f) {
  std::vector<double> z(f.size());
  for (std::size_t i = 0; i < f.size(); ++i) z[i] = scaled_reflectance(f[i], rows.weight[i / rows.observed]);
  std::vector<double> off, exchanged;
  for (const std::vector<std::size_t>& band : rows.rows_of_band) {
    std::map<Incidence, std::vector<std::size_t>> series;
    std::map<std::pair<Incidence, Incidence>, std::size_t> known;
    for (const std::size_t i : band) {
      const Incidence in = incidence_of(rows.wi[i / rows.observed]), out = incidence_of(rows.wo[i / rows.observed]);
      series[in].push_back(i);
      known[{in, out}] = i;
      if (const auto pair = known.find({out, in}); pair != known.end() && in != out)
        exchanged.push_back(std::abs(z[i] - z[pair->second]) / std::sqrt(2.0));
    }
    for (const auto& [incidence, members] : series) neighbour_noise(rows, z, members, off);
  }
  double noise = 0;
  if (off.size() >= fewest_for_noise) noise = stats::sigma_of_median * stats::median(off);
  if (exchanged.size() >= fewest_for_noise) noise = std::max(noise, stats::sigma_of_median * stats::median(exchanged));
  return noise > 0 ? std::max(noise, least_noise) : noise_unknown;
}

}  // namespace gonio::explain::tables
