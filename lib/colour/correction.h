// A camera's linear R, G, B as colours: the terms of a model, and what a correction makes of a pixel.
//
// A pixel is divided by `white`, what a perfect white reads, so that terms are of order one and white itself is 1, 1, 1
// however long the exposure was. A matrix of three rows then takes terms of r, g, b to colours whose white is one:
//   linear, white-preserving, homography   r, g, b
//   polynomial-N                           all products of r, g, b of degree 1 to N
//   root-polynomial-N                      of those of degree 1 to N, to the power of one over the degree, each once:
//                                          Finlayson, Mackiewicz & Hurlbert 2015, "Color correction using root-
//                                          polynomial regression", IEEE Trans. Image Processing 24(5)
// All but polynomials are of degree one: a picture twice as bright becomes twice as bright, colours unchanged. Terms
// stand degree by degree, within a degree by falling powers of r, then of g. Roots of negative products, which noise
// about black gives, are the negative roots of their magnitude.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "io/image.h"
#include "manifest/sections/forward.h"
#include "optics/colorimetry.h"

namespace gonio::colour {

enum class Model {
  linear,
  white_preserving,
  homography,
  root_polynomial_2,
  root_polynomial_3,
  root_polynomial_4,
  polynomial_2,
  polynomial_3,
  polynomial_4
};
inline constexpr int models = 9;
std::string name_of(Model model);
std::vector<std::string> model_names();
Model model_named(const std::string& name, const std::string& place);  // Error(data) for others
bool keeps_exposure(Model model);                                      // of degree one
bool is_matrix(Model model);                                           // linear in r, g, b

// Powers of r, g, b whose product, to the power of 1 / `degree`, is a term.
struct Term {
  int r = 0, g = 0, b = 0;
  int root = 1;
};
const std::vector<Term>& terms_of(Model model);
std::vector<double> values_of(Model model, Rgb rgb);  // of the terms, rgb over white

// Colours that a correction can give, linear, and what stands between them and the CIE's:
//   cie-rgb   CIE RGB by the normalised matching functions (optics/colour.h), adapted by Bradford so that white, D50 on
//             a chart, is 1, 1, 1: what a renderer takes whose lamp is 1, 1, 1
//   srgb      IEC 61966-2-1's primaries, adapted to D65
//   xyz-d50   CIE XYZ under D50, as it is
enum class Target { cie_rgb, srgb, xyz_d50 };
std::string name_of(Target target);
std::vector<std::string> target_names();
Target target_named(const std::string& name, const std::string& place);
Mat3 from_xyz_d50(Target target);

class Correction {
 public:
  Correction() = default;  // changes nothing
  // Error(data) at `place` for another number of rows or columns than the model's, or numbers that are not finite.
  Correction(Model model, std::vector<std::vector<double>> matrix, Rgb white, Target target, const std::string& place);
  Model model() const { return model_; }
  Target target() const { return target_; }
  Rgb white() const { return white_; }
  const std::vector<std::vector<double>>& matrix() const { return matrix_; }
  // The same colours, so many times as bright: polynomials too, whose terms are of the pixel and not of what comes out.
  Correction scaled(double by) const;
  Rgb operator()(Rgb pixel) const;   // a pixel as the camera gave it
  Mat3 slopes(Rgb pixel) const;      // d colour / d pixel; where a root has none, zero
  optics::Lab lab(Rgb pixel) const;  // about D50's white

 private:
  Model model_ = Model::linear;
  std::vector<std::vector<double>> matrix_{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Rgb white_{1, 1, 1};
  Target target_ = Target::xyz_d50;
};

Correction correction_of(const manifest::ColourCorrection& section, const std::string& place);

// A picture's R, G, B through the correction; where it has variance.R, variance.G, variance.B these become the variance
// of each colour by the slopes, as if the three were independent. Pixels that are not finite stay so. Error(data) at
// `place` for a picture without R, G, B.
void apply(const Correction& correction, io::Image& picture, const std::string& place);

}  // namespace gonio::colour
