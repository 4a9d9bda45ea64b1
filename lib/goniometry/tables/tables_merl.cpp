// MERL's .binary as samples. A table has 1.5 million cells, far more than a fit needs: every a-th bin of theta_h, b-th
// of theta_d and c-th of phi_d is taken, the middle of each stretch, with a <= b <= c as small as the wanted number of
// rows allows; bins of theta_h are dense near the mirror direction as they are. Cells of one theta_d are a series.
//
// Cells stand for the middles of their bins (surface/merl_table.h):
//   theta_h = ((i + 1/2) / n)^2 pi / 2, theta_d = (j + 1/2) / n pi / 2, phi_d = (k + 1/2) / n pi
// With phi_h = 0: wi = R_y(theta_h) (sin theta_d cos phi_d, sin theta_d sin phi_d, cos theta_d), and wo is wi mirrored
// in the half vector (Rusinkiewicz 1998).
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "goniometry/tables/tables_readings.h"
#include "io/merl.h"

namespace gonio::goniometry {
namespace {

struct Strides {
  std::size_t h = 1, d = 1, p = 1;
};

Strides strides_for(const io::MerlTable& table, std::size_t most) {
  const auto count = [&](const Strides& s) {
    return ((table.bins[0] + s.h - 1) / s.h) * ((table.bins[1] + s.d - 1) / s.d) * ((table.bins[2] + s.p - 1) / s.p);
  };
  Strides s;
  while (count(s) > most) {  // the half angle matters most, the azimuth least
    if (s.p < 4 * s.d && s.p < table.bins[2])
      ++s.p;
    else if (s.d < 2 * s.h && s.d < table.bins[1])
      ++s.d;
    else if (s.h < table.bins[0])
      ++s.h;
    else
      break;
  }
  return s;
}

std::array<double, 4> angles_of(double theta_h, double theta_d, double phi_d) {
  const Vec3 h{std::sin(theta_h), 0, std::cos(theta_h)};
  const Vec3 d{std::sin(theta_d) * std::cos(phi_d), std::sin(theta_d) * std::sin(phi_d), std::cos(theta_d)};
  const Vec3 wi{d.x * h.z + d.z * h.x, d.y, -d.x * h.x + d.z * h.z};
  const Vec3 wo = 2 * dot(h, wi) * h - wi;
  return {std::acos(std::clamp(wi.z, -1.0, 1.0)), std::atan2(wi.y, wi.x), std::acos(std::clamp(wo.z, -1.0, 1.0)),
          std::atan2(wo.y, wo.x)};
}

}  // namespace

Readings merl_readings(const std::filesystem::path& path, const TableOptions& options) {
  const io::MerlTable table = io::read_merl(path);
  const Strides s = strides_for(table, std::max<std::size_t>(options.most_rows, 1));
  Readings out{path.filename().string(), {}, {"theta_i", "phi_i", "theta_o", "phi_o"}, true, {"r", "g", "b"}};
  out.preset = Mirror::opposite;
  const auto [nh, nd, np] = table.bins;
  const auto bin = [](double i, std::size_t n) { return (i + 0.5) / static_cast<double>(n); };
  for (std::size_t i = s.h / 2; i < nh; i += s.h)
    for (std::size_t j = s.d / 2; j < nd; j += s.d)
      for (std::size_t k = s.p / 2; k < np; k += s.p) {
        const double root = bin(static_cast<double>(i), nh);
        out.angles.push_back(angles_of(root * root * pi / 2, bin(static_cast<double>(j), nd) * pi / 2,
                                       bin(static_cast<double>(k), np) * pi));
        const std::size_t cell = (i * nd + j) * np + k;
        for (std::size_t c = 0; c < 3; ++c) out.f.push_back(table.brdf_per_sr[3 * cell + c]);
        out.series.push_back(std::to_string(j));
        out.place.push_back(out.name + ": cell " + std::to_string(i) + ", " + std::to_string(j) + ", " +
                            std::to_string(k));
      }
  out.notes.push_back(std::to_string(out.angles.size()) + " of " + std::to_string(table.cells()) +
                      " cells are used: every " + std::to_string(s.h) + ". bin of theta_h, " + std::to_string(s.d) +
                      ". of theta_d, " + std::to_string(s.p) + ". of phi_d");
  return out;
}

}  // namespace gonio::goniometry
