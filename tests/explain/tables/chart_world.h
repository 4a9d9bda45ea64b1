// What cameras read of a ColorChecker, by sums over wavelengths that are written out here: measured reflectances,
// scattered as prints scatter, times a light times a camera's curves.
#pragma once
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "data.h"
#include "table_world.h"

namespace gonio::explain::tables::tests {

struct ChartTruth {
  double print = 0.01;             // scatter of the inks' density, relative: 0.4 in L*
  double noise = 0.003;            // of a reading, relative
  double glare = 0;                // share of the mean over patches
  std::array<double, 3> offset{};  // over what white reads in green
  double quadratic = 0;            // of a reading, at white
  double gamma = 1;                // exponent of a reading over white's
  double full_scale = 2;           // over white
  double across = 0, down = 0;     // change of the light over the chart
  std::vector<double> exposures{1};
  bool states_exposure = false;
  std::string sensed{};  // camera whose curves are stated for the one that took the picture; empty: none are
};

inline std::vector<std::vector<double>> numbers_in(const std::filesystem::path& path) {
  std::vector<std::vector<double>> rows;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || std::isdigit(static_cast<unsigned char>(line[0])) == 0) continue;
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

struct ChartSpectra {  // at 400 to 700 nm, every 10
  std::vector<std::array<double, 24>> reflectance;
  std::vector<std::array<double, 3>> observer, camera;
  std::vector<double> light;
};
inline ChartSpectra chart_spectra(const std::string& camera) {
  const auto root = gonio::tests::data("colour/colorchecker-reference");
  const auto reflectance = numbers_in(root / "data_babelcolor_average_reflectance.csv"),
             observer = numbers_in(root / "cmf_CIE_1931_2_Degree_Standard_Observer.csv"),
             light = numbers_in(root / "illuminant_D50.csv"),
             curves = numbers_in(gonio::tests::data("colour/camera_sensitivities") / camera);
  const auto at = [](const std::vector<std::vector<double>>& rows, double nm) {
    for (const auto& row : rows)
      if (row[0] == nm) return row;
    ADD_FAILURE() << nm << " nm is missing";
    return std::vector<double>(25, 0.0);
  };
  ChartSpectra s;
  for (double nm = 400; nm <= 700; nm += 10) {
    const auto r = at(reflectance, nm), o = at(observer, nm), c = at(curves, nm);
    s.reflectance.emplace_back();
    std::copy_n(r.begin() + 1, 24, s.reflectance.back().begin());
    s.observer.push_back({o[1], o[2], o[3]});
    s.camera.push_back({c[1], c[2], c[3]});
    s.light.push_back(at(light, nm)[1]);
  }
  return s;
}

using ChartNumbers = std::array<std::array<double, 3>, 24>;
// Sums over the spectrum, over what a white gives in `over`. `density`: exponent of each patch's reflectance.
inline ChartNumbers integrated(const ChartSpectra& s, const std::vector<std::array<double, 3>>& curves,
                               std::size_t over, const std::array<double, 24>& density) {
  ChartNumbers sums{};
  double white = 0;
  for (std::size_t k = 0; k < s.light.size(); ++k) {
    white += s.light[k] * curves[k][over];
    for (std::size_t p = 0; p < 24; ++p)
      for (std::size_t c = 0; c < 3; ++c)
        sums[p][c] += s.light[k] * curves[k][c] * std::pow(s.reflectance[k][p], density[p]);
  }
  for (auto& patch : sums)
    for (double& v : patch) v /= white;
  return sums;
}

inline World chart_world(std::uint64_t seed, const ChartSpectra& s, const ChartTruth& t) {
  Random random(seed, 61);
  std::array<double, 24> stated{}, printed{};
  stated.fill(1);
  for (double& d : printed) d = 1 + t.print * random.normal();
  const ChartNumbers xyz = integrated(s, s.observer, 1, stated), rgb = integrated(s, s.camera, 1, printed);
  World w;
  w.columns = {{"patch", ""}, {"fold", ""}, {"picture", ""}, {"X", "1"},
               {"Y", "1"},    {"Z", "1"},   {"x", "1"},      {"y", "1"}};
  if (t.states_exposure) w.columns.emplace_back("exposure_s", "s");
  for (const char* name : {"R", "G", "B", "R_sigma", "G_sigma", "B_sigma"}) w.columns.emplace_back(name, "1");
  ChartNumbers sensed{};
  if (!t.sensed.empty()) {
    for (const char* name : {"sensed_R", "sensed_G", "sensed_B"}) w.columns.emplace_back(name, "1");
    const ChartSpectra other = chart_spectra(t.sensed);
    for (std::size_t c = 0; c < 3; ++c) {
      const ChartNumbers of_channel = integrated(other, other.camera, c, stated);
      for (std::size_t p = 0; p < 24; ++p) sensed[p][c] = of_channel[p][c];
    }
  }
  w.rest =
      R"("model": "chart", "observed": ["R", "G", "B"], "sigma": ["R_sigma", "G_sigma", "B_sigma"], "group": "fold", "block": "patch")";
  std::array<double, 3> mean{};
  for (const auto& patch : rgb)
    for (std::size_t c = 0; c < 3; ++c) mean[c] += patch[c] / 24;
  for (std::size_t e = 0; e < t.exposures.size(); ++e)
    for (std::size_t p = 0; p < 24; ++p) {
      const double u = (0.5 + static_cast<double>(p % 6)) / 6, v = (0.5 + std::floor(static_cast<double>(p) / 6)) / 4;
      const double light = t.exposures[e] * (1 + t.across * (u - 0.5) + t.down * (v - 0.5));
      std::vector<double> row = {p + 1.0, p % 8 + 1.0, e + 1.0, xyz[p][0], xyz[p][1], xyz[p][2], u, v};
      if (t.states_exposure) row.push_back(t.exposures[e]);
      std::array<double, 3> sigma{};
      for (std::size_t c = 0; c < 3; ++c) {
        double f = light * rgb[p][c] + t.exposures[e] * t.glare * mean[c];
        f = std::pow(f, t.gamma);
        f = std::min(f * (1 + t.quadratic * f), t.full_scale) + t.offset[c];
        sigma[c] = t.noise * std::abs(f) + 1e-5;
        row.push_back(f + sigma[c] * random.normal());
      }
      row.insert(row.end(), sigma.begin(), sigma.end());
      if (!t.sensed.empty()) row.insert(row.end(), sensed[p].begin(), sensed[p].end());
      w.rows.push_back(std::move(row));
    }
  return w;
}

}  // namespace gonio::explain::tables::tests
