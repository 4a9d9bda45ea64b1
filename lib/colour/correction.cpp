// See correction.h.
#include "colour/correction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "geom/mat3_inverse.h"
#include "manifest/sections/colour_correction.h"

namespace gonio::colour {
namespace {

constexpr std::array<const char*, models> names{
    "linear",       "white-preserving", "homography",  "root-polynomial-2", "root-polynomial-3", "root-polynomial-4",
    "polynomial-2", "polynomial-3",     "polynomial-4"};
constexpr std::array<const char*, 3> targets{"cie-rgb", "srgb", "xyz-d50"};

int degree_of(Model model) {
  switch (model) {
    case Model::linear:
    case Model::white_preserving:
    case Model::homography: return 1;
    case Model::root_polynomial_2:
    case Model::polynomial_2: return 2;
    case Model::root_polynomial_3:
    case Model::polynomial_3: return 3;
    case Model::root_polynomial_4:
    case Model::polynomial_4: return 4;
  }
  return 1;
}

std::vector<Term> make_terms(Model model) {
  std::vector<Term> terms;
  for (int degree = 1; degree <= degree_of(model); ++degree)
    for (int r = degree; r >= 0; --r)
      for (int g = degree - r; g >= 0; --g) {
        const int b = degree - r - g;
        if (!keeps_exposure(model))
          terms.push_back({r, g, b, 1});
        else if (std::gcd(std::gcd(r, g), b) == 1)  // the square root of r r is r again
          terms.push_back({r, g, b, degree});
      }
  return terms;
}

double root_of(double x, int root) {
  return root == 1 ? x : root == 2 ? std::sqrt(x) : root == 3 ? std::cbrt(x) : std::sqrt(std::sqrt(x));
}

double power_of(double x, int n) {
  double y = 1;
  for (; n > 0; --n) y *= x;
  return y;
}

double value_of_term(const Term& t, Rgb c) {
  const double product = power_of(c.x, t.r) * power_of(c.y, t.g) * power_of(c.z, t.b);
  return product < 0 ? -root_of(-product, t.root) : root_of(product, t.root);
}

// d log term / d log channel is its power over the root.
double slope_of_term(const Term& t, Rgb c, int channel, double value) {
  const int power = channel == 0 ? t.r : channel == 1 ? t.g : t.b;
  if (power == 0) return 0;
  if (t.root == 1 && power == 1) {
    const double others = (channel == 0 ? 1 : power_of(c.x, t.r)) * (channel == 1 ? 1 : power_of(c.y, t.g)) *
                          (channel == 2 ? 1 : power_of(c.z, t.b));
    return others;
  }
  return c[channel] != 0 ? value * power / (t.root * c[channel]) : 0;
}

template <std::size_t N>
std::size_t place_of(const std::array<const char*, N>& list, const std::string& name, const char* what,
                     const std::string& place) {
  const auto found = std::ranges::find_if(list, [&](const char* n) { return name == n; });
  if (found != list.end()) return static_cast<std::size_t>(found - list.begin());
  std::string all;
  for (const char* n : list) all += (all.empty() ? "" : ", ") + std::string(n);
  throw Error(Exit::data, place, std::string("is no ") + what + ": " + name, "there is " + all);
}

}  // namespace

std::string name_of(Model model) {
  return names[static_cast<std::size_t>(model)];
}
std::vector<std::string> model_names() {
  return {names.begin(), names.end()};
}
Model model_named(const std::string& name, const std::string& place) {
  return static_cast<Model>(place_of(names, name, "model of colours", place));
}
bool keeps_exposure(Model model) {
  return model < Model::polynomial_2;
}
bool is_matrix(Model model) {
  return degree_of(model) == 1;
}

const std::vector<Term>& terms_of(Model model) {
  static const auto all = [] {
    std::array<std::vector<Term>, models> terms;
    for (int i = 0; i < models; ++i) terms[static_cast<std::size_t>(i)] = make_terms(static_cast<Model>(i));
    return terms;
  }();
  return all[static_cast<std::size_t>(model)];
}

std::vector<double> values_of(Model model, Rgb rgb) {
  std::vector<double> values;
  for (const Term& term : terms_of(model)) values.push_back(value_of_term(term, rgb));
  return values;
}

std::string name_of(Target target) {
  return targets[static_cast<std::size_t>(target)];
}
std::vector<std::string> target_names() {
  return {targets.begin(), targets.end()};
}
Target target_named(const std::string& name, const std::string& place) {
  return static_cast<Target>(place_of(targets, name, "kind of colours", place));
}

Mat3 from_xyz_d50(Target target) {
  using namespace optics;
  switch (target) {
    case Target::cie_rgb: return cie_rgb_from_xyz() * bradford(white_d50, white_equal_energy);
    case Target::srgb: return srgb_from_xyz() * bradford(white_d50, white_d65);
    case Target::xyz_d50: break;
  }
  return {};
}

Correction::Correction(Model model, std::vector<std::vector<double>> matrix, Rgb white, Target target,
                       const std::string& place)
    : model_(model), matrix_(std::move(matrix)), white_(white), target_(target) {
  const std::size_t terms = terms_of(model).size();
  if (matrix_.size() != 3 || std::ranges::any_of(matrix_, [&](const auto& row) { return row.size() != terms; }))
    throw Error(Exit::data, place + "/matrix", "has another shape than " + name_of(model),
                format("needs 3 rows of %zu numbers", terms));
  for (const auto& row : matrix_)
    if (!std::ranges::all_of(row, [](double x) { return std::isfinite(x); }))
      throw Error(Exit::data, place + "/matrix", "is not finite");
  if (!is_finite(white) || !(white.x > 0 && white.y > 0 && white.z > 0))
    throw Error(Exit::data, place + "/white", "is not above zero");
}

Correction Correction::scaled(double by) const {
  Correction result = *this;
  for (std::vector<double>& row : result.matrix_)
    for (double& x : row) x *= by;
  return result;
}

Rgb Correction::operator()(Rgb pixel) const {
  const Rgb c{pixel.x / white_.x, pixel.y / white_.y, pixel.z / white_.z};
  Rgb out;
  const auto& terms = terms_of(model_);
  for (std::size_t k = 0; k < terms.size(); ++k)
    out += Rgb{matrix_[0][k], matrix_[1][k], matrix_[2][k]} * value_of_term(terms[k], c);
  return out;
}

Mat3 Correction::slopes(Rgb pixel) const {
  const Rgb c{pixel.x / white_.x, pixel.y / white_.y, pixel.z / white_.z};
  Mat3 out{{0, 0, 0, 0, 0, 0, 0, 0, 0}};
  const auto& terms = terms_of(model_);
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const double value = value_of_term(terms[k], c);
    for (int j = 0; j < 3; ++j) {
      const double slope = slope_of_term(terms[k], c, j, value) / white_[j];
      for (int i = 0; i < 3; ++i) out(i, j) += matrix_[static_cast<std::size_t>(i)][k] * slope;
    }
  }
  return out;
}

optics::Lab Correction::lab(Rgb pixel) const {
  return optics::lab_from_xyz(inverse(from_xyz_d50(target_)) * (*this)(pixel), optics::white_d50);
}

Correction correction_of(const manifest::ColourCorrection& section, const std::string& place) {
  if (section.white.size() != 3) throw Error(Exit::data, place + "/white", "needs 3 numbers", "give R, G, B");
  return {model_named(section.model, place + "/model"), section.matrix,
          Rgb{section.white[0], section.white[1], section.white[2]}, target_named(section.to, place + "/to"), place};
}

void apply(const Correction& correction, io::Image& picture, const std::string& place) {
  std::array<int, 3> colour{}, variance{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name(1, "RGB"[c]);
    colour[c] = picture.channel(name), variance[c] = picture.channel("variance." + name);
    if (colour[c] < 0) throw Error(Exit::data, place, "has no channel " + name, "colours need R, G and B");
  }
  const bool varies = std::ranges::all_of(variance, [](int c) { return c >= 0; });
  const std::size_t channels = picture.channels.size();
  const auto rows = static_cast<std::size_t>(picture.height), columns = static_cast<std::size_t>(picture.width);
  parallel_for(0, rows, [&](std::size_t y) {
    for (std::size_t x = 0; x < columns; ++x) {
      float* at = &picture.data[(y * columns + x) * channels];
      const Rgb pixel{at[colour[0]], at[colour[1]], at[colour[2]]}, out = correction(pixel);
      if (varies) {
        const Mat3 slopes = correction.slopes(pixel);
        const Rgb before{at[variance[0]], at[variance[1]], at[variance[2]]};
        for (int i = 0; i < 3; ++i) {
          double sum = 0;
          for (int j = 0; j < 3; ++j) sum += slopes(i, j) * slopes(i, j) * before[j];
          at[variance[static_cast<std::size_t>(i)]] = static_cast<float>(sum);
        }
      }
      for (int i = 0; i < 3; ++i) at[colour[static_cast<std::size_t>(i)]] = static_cast<float>(out[i]);
    }
  });
}

}  // namespace gonio::colour
