#include "optics/colour.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "geom/mat3_inverse.h"
#include "optics/colorimetry.h"
#include "optics/standard_observer.h"

namespace gonio::optics {
namespace {

constexpr double step_m = 5e-9;

// Inverse of the matrix at the head of the header.
Rgb rgb_from_xyz(Vec3 xyz) {
  return cie_rgb_from_xyz() * xyz * 0.17697;
}

struct Table {
  std::array<Rgb, observer_rows> value;
  Rgb integral;  // over metres; trapezoidal: exact for what is linear in between
  Table() {
    for (std::size_t i = 0; i < observer_rows; ++i) {
      value[i] = rgb_from_xyz(standard_observer[i]);
      integral += value[i] * (i == 0 || i + 1 == observer_rows ? step_m / 2 : step_m);
    }
  }
};
const Table& table() {
  static const Table t;
  return t;
}

Rgb over(Rgb a, Rgb b) {
  return {a.x / b.x, a.y / b.y, a.z / b.z};
}

// Midpoints of a grid of 1 nm.
template <class Function>
void over_visible(Function each) {
  constexpr double fine_m = 1e-9;
  for (int i = 0; i < 400; ++i) {
    const double wavelength_m = first_visible_m + (i + 0.5) * fine_m;
    each(wavelength_m, over(matching_functions(wavelength_m), table().integral) * fine_m);
  }
}

// 0 below `edge`, 1 above, a sine's rise over 40 nm in between.
double rise(double wavelength_m, double edge_m) {
  constexpr double half_m = 20e-9;
  const double x = std::clamp((wavelength_m - edge_m) / half_m, -1.0, 1.0);
  return 0.5 + 0.5 * std::sin(pi / 2 * x);
}
Rgb boxes(double wavelength_m) {
  const double red = rise(wavelength_m, 590e-9), blue = 1 - rise(wavelength_m, 480e-9);
  return {red, 1 - red - blue, blue};
}

// Of the matrix of the boxes' RGBs: what to take of each box so that the RGB is right.
const Mat3& boxes_from_rgb() {
  static const Mat3 solved = [] {
    std::array<Vec3, 3> column{};  // RGB of each box
    over_visible([&](double wavelength_m, Rgb weight) {
      const Rgb box = boxes(wavelength_m);
      column[0] += weight * box.x, column[1] += weight * box.y, column[2] += weight * box.z;
    });
    return inverse(Mat3{{column[0].x, column[1].x, column[2].x, column[0].y, column[1].y, column[2].y, column[0].z,
                         column[1].z, column[2].z}});
  }();
  return solved;
}

}  // namespace

Rgb matching_functions(double wavelength_m) {
  const double position = (wavelength_m - first_visible_m) / step_m;
  if (!(position >= 0) || position > observer_rows - 1) return {};
  const auto i = std::min(static_cast<std::size_t>(position), observer_rows - 2);
  const double share = position - static_cast<double>(i);
  return table().value[i] * (1 - share) + table().value[i + 1] * share;
}

Rgb normalised_matching_functions(double wavelength_m) {
  return over(matching_functions(wavelength_m), table().integral);
}

std::vector<Rgb> rgb_weights(std::span<const double> wavelength_m, const std::string& place) {
  std::vector<Rgb> weights;
  Rgb sum, absolute;
  const std::size_t count = wavelength_m.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double width = count == 1 ? 1 : wavelength_m[std::min(i + 1, count - 1)] - wavelength_m[i > 0 ? i - 1 : 0];
    weights.push_back(matching_functions(wavelength_m[i]) * width);
    sum += weights.back();
    absolute += Rgb{std::abs(weights.back().x), std::abs(weights.back().y), std::abs(weights.back().z)};
  }
  for (int c = 0; c < 3; ++c)
    if (!(sum[c] > 0.1 * absolute[c]))
      throw Error(Exit::data, place,
                  std::string("no wavelength for ") + (c == 0   ? "red"
                                                       : c == 1 ? "green"
                                                                : "blue"),
                  "spread the wavelengths over 400 nm to 700 nm");
  for (Rgb& weight : weights) weight = over(weight, sum);
  return weights;
}

Rgb rgb_of(const std::function<double(double)>& spectrum) {
  Rgb sum;
  over_visible([&](double wavelength_m, Rgb weight) { sum += weight * spectrum(wavelength_m); });
  return sum;
}

Rgb rgb_centres_m() {
  return rgb_of([](double wavelength_m) { return wavelength_m; });
}

Rgb band_values(const std::function<double(double)>& spectrum, Range covered, const Bands& bands,
                const std::string& place) {
  if (!bands.rgb) {
    const auto& w = bands.wavelength_m;
    return {spectrum(w[0]), spectrum(w[1]), spectrum(w[2])};
  }
  Rgb sum, all, held;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  over_visible([&](double wavelength_m, Rgb weight) {
    const double inside_m = std::clamp(wavelength_m, covered.first_m, covered.last_m), value = spectrum(inside_m);
    const Rgb absolute{std::abs(weight.x), std::abs(weight.y), std::abs(weight.z)};
    low = std::min(low, value), high = std::max(high, value);
    sum += weight * value;
    all += absolute;
    if (inside_m != wavelength_m) held += absolute;
  });
  const double share = max_component(over(held, all));
  const std::string problem =
      format("covers %s to %s: for %.0f %% of a colour's weight ", nanometres(covered.first_m).c_str(),
             nanometres(covered.last_m).c_str(), 100 * share);
  if (share > held_limit)
    throw Error(Exit::data, place, problem + "there is no value", "name a file that covers 380 nm to 780 nm");
  if (share > held_warning) log(LogLevel::warning, place + ": " + problem + "its end's value is used");
  return {std::clamp(sum.x, low, high), std::clamp(sum.y, low, high), std::clamp(sum.z, low, high)};
}

Rgb band_values(const Spectrum& spectrum, const Bands& bands) {
  return band_values([&](double wavelength_m) { return spectrum.at(wavelength_m); }, spectrum.range(), bands,
                     spectrum.place());
}

double upsampled(Rgb value, double wavelength_m) {
  return dot(boxes_from_rgb() * value, boxes(wavelength_m));
}

Rgb upsampled(Rgb value, const Bands& bands) {
  if (bands.rgb) return value;
  const auto& w = bands.wavelength_m;
  return {upsampled(value, w[0]), upsampled(value, w[1]), upsampled(value, w[2])};
}

}  // namespace gonio::optics
