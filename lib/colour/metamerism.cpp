// See metamerism.h.
#include "colour/metamerism.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "colour/correction_fit.h"
#include "geom/mat3_inverse.h"
#include "linear/geom_matrices.h"
#include "linear/symmetric_eigen.h"
#include "optics/colorimetry.h"
#include "optics/spectrum.h"

namespace gonio::colour {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double first_m = 380e-9, step_m = 5e-9;
constexpr Index steps = 81;

double wavelength_m(Index i) {
  return first_m + step_m * static_cast<double>(i);
}

}  // namespace

double reflectance_covariance(double a_m, double b_m) {
  constexpr double deviation = 0.226, level = 0.25, length_m = 66e-9;
  const double d = (a_m - b_m) / length_m;
  return deviation * deviation * (level + (1 - level) * std::exp(-d * d / 2));
}

Sensitivities parse_sensitivities(const std::string& text, const std::string& place) {
  std::array<std::string, 3> columns;
  std::istringstream in(text);
  std::size_t row = 0;
  for (std::string line; std::getline(in, line);) {
    ++row;
    std::vector<std::string> cells;
    std::istringstream parts(line);
    for (std::string cell;
         line.find_first_not_of(" \t\r") != std::string::npos && line[0] != '#' && std::getline(parts, cell, ',');)
      cells.push_back(cell);
    if (!cells.empty() && cells.size() != 4)
      throw Error(Exit::data, place + ":" + std::to_string(row), format("has %zu columns, needs 4", cells.size()),
                  "write wavelength_nm,R,G,B");
    // Every line stays a line, so that what is wrong with a number is said at its own.
    for (std::size_t c = 0; c < 3; ++c) columns[c] += (cells.empty() ? "#" : cells[0] + "," + cells[1 + c]) + "\n";
  }
  std::vector<optics::Spectrum> spectra;
  for (const std::string& column : columns) spectra.push_back(optics::parse_spectrum(column, place));
  return [all = std::make_shared<const std::vector<optics::Spectrum>>(std::move(spectra))](double w) {
    const auto at = [&](std::size_t c) { return (*all)[c].covers(w) ? (*all)[c].at(w) : 0.0; };
    return Rgb{at(0), at(1), at(2)};
  };
}

Sensitivities read_sensitivities(const std::filesystem::path& path) {
  return parse_sensitivities(read_file(path, 1 << 22), path.string());
}

double metamerism_de00(const Sensitivities& sensor, const std::function<double(double)>& light,
                       const std::string& place) {
  MatrixXd observer(3, steps), read(3, steps), covariance(steps, steps);
  for (Index i = 0; i < steps; ++i) {
    const double w = wavelength_m(i), power = light(w);
    read.col(i) = linear::as_eigen(sensor(w) * power);
    // The light off a reflectance that is one at this wavelength alone.
    observer.col(i) =
        linear::as_eigen(optics::xyz_of([&](double v) { return std::abs(v - w) < step_m / 2 ? 1.0 : 0.0; }, light));
    for (Index j = 0; j < steps; ++j) covariance(i, j) = reflectance_covariance(w, wavelength_m(j));
  }
  const Eigen::Matrix3d own = read * covariance * read.transpose();
  const Eigen::Vector3d over = own.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d even = over.asDiagonal() * own * over.asDiagonal();
  if (!(own.diagonal().minCoeff() > 0) || !(linear::SymmetricEigen<Eigen::Matrix3d>(even).eigenvalues()[0] > 1e-9))
    throw Error(Exit::data, place, "has channels that see the same under this light",
                "name a file of three different sensitivities");
  const Eigen::Matrix3d shared = over.asDiagonal() * read * covariance * observer.transpose();
  const Eigen::Matrix3d left = observer * covariance * observer.transpose() -
                               shared.transpose() * linear::as_eigen(inverse(linear::mat3_of(even))) * shared;
  const optics::Xyz white = optics::xyz_of([](double) { return 1.0; }, light), grey = white * mean_reflectance;
  const Eigen::Matrix3d whiten =
      linear::as_eigen(difference_root(optics::lab_from_xyz(grey, white)) * optics::lab_slopes(grey, white));
  return std::sqrt(std::max(0.0, (whiten * left * whiten.transpose()).trace()));
}

std::vector<Rgb> sensed(const Chart& chart, const Sensitivities& sensor, const std::function<double(double)>& light,
                        const std::string& place) {
  Rgb white{};
  for (Index i = 0; i < steps; ++i) white += sensor(wavelength_m(i)) * light(wavelength_m(i));
  if (!(white.x > 0 && white.y > 0 && white.z > 0))
    throw Error(Exit::data, place, "has a channel that sees nothing of the light", "name another --light or --sensor");
  std::vector<Rgb> all;
  for (const Patch& patch : chart.patches) {
    if (!patch.reflectance) return {};
    Rgb sum{};
    for (Index i = 0; i < steps; ++i)
      sum += sensor(wavelength_m(i)) * (light(wavelength_m(i)) * patch.reflectance(wavelength_m(i)));
    all.push_back({sum.x / white.x, sum.y / white.y, sum.z / white.z});
  }
  return all;
}

}  // namespace gonio::colour
