#include "mesh/reconstruct/cloud_points.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"

namespace gonio::mesh {
namespace {

const io::PlyWish columns{
    .properties = {"cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz", "sigma", "red", "green", "blue"}};
constexpr std::size_t sigma_column = 6, first_colour = 7;
constexpr double least_share = 1e-6;  // of the trace: what single precision leaves of the smallest variance

// Entries in the order of the columns. Positive semidefinite as far as pairs of axes tell and rounding allows.
bool possible(const std::array<double, 6>& c) {
  if (!std::ranges::all_of(c, [](double v) { return std::isfinite(v); })) return false;
  if (!(c[0] >= 0 && c[3] >= 0 && c[5] >= 0 && c[0] + c[3] + c[5] > 0)) return false;
  const double room = 1e-5 * (c[0] + c[3] + c[5]);
  const auto pair = [&](double a, double b, double ab) { return std::abs(ab) <= std::sqrt(a * b) + room; };
  return pair(c[0], c[3], c[1]) && pair(c[0], c[5], c[2]) && pair(c[3], c[5], c[4]);
}

}  // namespace

void read_points(const std::filesystem::path& path, std::uint32_t view, MeasuredPoints& points) {
  const io::TriangleMesh file = io::read_ply(path, columns);
  if (file.positions_m.empty())
    throw Error(Exit::data, path.string(), "has no points", "leave its cloud out (--view names those that stay)");
  const auto has = [&](std::size_t column) { return !file.properties[column].empty(); };
  const bool full = std::ranges::all_of(std::array{0, 1, 2, 3, 4, 5}, [&](int k) { return has(std::size_t(k)); });
  if (!full && !has(sigma_column))
    throw Error(Exit::data, path.string(), "states no error of its points (cov_xx, ..., cov_zz, or sigma)",
                "structured-light writes them");
  for (std::size_t i = 0; i < file.positions_m.size(); ++i) {
    if (!is_finite(file.positions_m[i]))
      throw Error(Exit::data, path.string(), format("point %zu is not finite", i), "leave it out");
    std::array<double, 6> c{};
    if (full) {
      for (std::size_t k = 0; k < c.size(); ++k) c[k] = double{file.properties[k][i]};
    } else {
      const double sigma = double{file.properties[sigma_column][i]};
      c[0] = c[3] = c[5] = sigma < 0 ? -1 : sigma * sigma;
    }
    if (!possible(c))
      throw Error(Exit::data, path.string(), format("the covariance of point %zu is none", i),
                  "state finite variances above zero, or leave it out");
    const double floor = least_share * (c[0] + c[3] + c[5]);
    c[0] += floor, c[3] += floor, c[5] += floor;
    points.positions_m.push_back(file.positions_m[i]);
    points.covariance_m2.push_back(c);
    points.view.push_back(view);
  }
  if (!has(first_colour) || !has(first_colour + 1) || !has(first_colour + 2)) return;
  for (std::size_t i = 0; i < file.positions_m.size(); ++i)
    points.colour.push_back(
        {file.properties[first_colour][i], file.properties[first_colour + 1][i], file.properties[first_colour + 2][i]});
}

}  // namespace gonio::mesh
