// Recorded reflectances as samples, read plainly: conventions as in DATA/README.md, nothing guessed.
#pragma once
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "goniometry/fit/synthetic.h"
#include "goniometry/samples.h"

namespace gonio::tests {

// Rows of numbers below comments; commas count as blanks.
inline std::vector<std::vector<double>> number_rows(const std::filesystem::path& path, std::size_t columns) {
  std::ifstream in(path);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    for (char& c : line)
      if (c == ',') c = ' ';
    std::istringstream words(line);
    std::vector<double> row;
    for (double x = 0; words >> x;) row.push_back(x);
    if (row.size() == columns) rows.push_back(row);
  }
  return rows;
}

inline void add_row(goniometry::Samples& s, std::map<long, std::size_t>& series, Vec3 wi, Vec3 wo) {
  s.wi.push_back(wi), s.wo.push_back(wo);
  const long key = std::lround(1e4 * std::acos(wi.z)) * 100000 + std::lround(1e3 * (std::atan2(wi.y, wi.x) + pi));
  s.series.push_back(series.emplace(key, series.size()).first->second);
}

// Cornell: theta_i phi_i theta_s phi_s and 31 bands from 400 nm; mirror direction at pi. Zeniths up to `largest`.
inline goniometry::Samples cornell(const std::filesystem::path& path, const std::vector<int>& nm,
                                   double largest = 85 * pi / 180) {
  goniometry::Samples s;
  s.name = path.filename().string();
  for (const int n : nm) s.band_name.push_back(std::to_string(n) + " nm"), s.band_m.push_back(n * 1e-9);
  std::map<long, std::size_t> series;
  for (const auto& row : number_rows(path, 35)) {
    if (row[0] > largest || row[2] > largest) continue;
    add_row(s, series, direction(row[0], row[1]), direction(row[2], row[3]));
    for (const int n : nm) s.f.push_back(row[static_cast<std::size_t>(4 + (n - 400) / 10)]);
  }
  return s;
}

// In-plane scans: phi_in theta_in phi_out theta_out brdf in degrees, phi the zenith, theta the azimuth; the light lies
// at azimuth 180, the mirror direction at the positive zenith.
inline goniometry::Samples scans(const std::filesystem::path& path, double largest = 85 * pi / 180) {
  goniometry::Samples s;
  s.name = path.filename().string();
  s.band_name = {""};
  std::map<long, std::size_t> series;
  for (const auto& row : number_rows(path, 5)) {
    const double k = pi / 180;
    const Vec3 wi = direction(row[0] * k, row[1] * k), wo = direction(row[2] * k, row[3] * k);
    if (wi.z < std::cos(largest) || wo.z < std::cos(largest) || !(row[4] > 0)) continue;
    add_row(s, series, wi, wo);
    s.f.push_back(row[4]);
  }
  return s;
}

}  // namespace gonio::tests
