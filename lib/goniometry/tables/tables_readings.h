// Readings of a table as the file has them, in SI: between the readers (one source a format) and Samples.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "goniometry/tables/tables.h"
#include "goniometry/tables/tables_text.h"

namespace gonio::goniometry {

struct Readings {
  std::string name;                             // of the file
  std::vector<std::array<double, 4>> angles{};  // theta_i, phi_i, theta_o, phi_o
  std::array<std::string, 4> angle_name{};      // as the file calls them
  bool said_radians = false;                    // the file or the user says that the angles are in radians
  std::vector<std::string> band_name{};
  std::vector<double> band_m{};       // empty: not known
  std::vector<double> f{}, sigma{};   // [row * bands + band]; NaN: no number there; sigma may be empty
  std::vector<std::string> series{};  // labels; empty: by direction of the light
  std::vector<std::string> place{};   // one per row
  Mirror preset = Mirror::automatic;  // what the format says
  std::vector<std::string> notes{};
};

Readings cornell_readings(const std::string& text, const std::string& name);
Readings merl_readings(const std::filesystem::path& path, const TableOptions& options);
Readings column_readings(const TextTable& table, const TableOptions& options);
// "550 nm" for a wavelength.
std::string band_text(double wavelength_m);

// Optical radiation lies between X-rays and radio waves, 1 nm to 1 mm (CIE S 017); else Error(data).
void check_wavelength(double metres, const std::string& place);

// Drops, turns, orders into series. Error as read_table() says.
ReadTable samples_of(Readings readings, const TableOptions& options);

}  // namespace gonio::goniometry
