// From the pictures of a sequence to the projector's pixel that lit each pixel of the camera.
//
// Gray code: a bit is set where its picture is brighter than its inverse (where none is shown: than the mean of white
// and black). A pixel's code holds where every difference is larger than noise could make it and than a share of what
// white and black differ by; else it is an edge: the border of two stripes, or light that comes from other parts
// of the scene. It tells a whole stripe: sigma is its width over sqrt(12).
//
// What white adds is light d on the straight way and g by way of other parts of the scene. With the lit share x of g, a
// bit and its inverse differ by |d + (2 x - 1) g|, of d + g: fine stripes light half of what the scene sends on, x =
// 1/2, and show the share r = d / (d + g), here the median over both axes' finest bits but the very finest, of which
// borders blur few. A bit that was read wrong differs by (1 - 2 x) g - d, at most by the share 1 - 2 r; one that
// differs by more is right, and a pixel with one that does not is refused (interreflection): the rules of Xu & Aliaga
// 2007 for a bit and its inverse, with d and g as Nayar et al. 2006 find them. Where d > g none is refused but for the
// margin of 0.1.
//
// Cosines: least squares for A + C cos(shift) + S sin(shift) = A + B cos(theta - shift), theta = atan2(S, C), whose
// variance is that of the frames times (J^-1) in the direction across (C, S), over B^2. Which period it is, all numbers
// of periods say together: of the places u that the finest theta leaves open the one that contradicts the others least,
//   chi^2(u) = sum_f (theta_f - 2 pi P_f (u + 1/2) / size, wrapped)^2 / sigma_f^2,
// if none other is nearly as good. The light of other parts of the scene turns coarse phases: where the coarse
// amplitudes are larger than the finest one, and phases disagree, the next has to be worse by more (interreflection,
// else). Any numbers of periods that do not all repeat together will do: a coarse one to start from, several close to
// each other (heterodyne), or many high ones (micro phase shifting, Gupta & Nayar 2012). Then u is the mean of what all
// say, by their variances.
//
// A projector that is not linear bends cosines; four shifts and more tell its exponent, and phases are straightened
// (bent_phase.h). Five and more tell whether it shows all above a level of what is sent alike, or all below one, and
// phases are straightened for that (projector_tone.h).
//
// Motion: a bit and its inverse light every pixel of the projector once, as white and black do, and cosines in equal
// steps light all of them half, whatever their number of periods: whatever way light takes, these sums are the same of
// a scene and a lamp that stand still. Means of cosines that differ by more than a tenth of what white adds are
// refused; sums of bits where they differ by half of it, or by what the bit and its inverse differ by, which then says
// nothing (not those of the three finest bits, which move a place by little). All only beyond five standard deviations,
// by chance once in a million sums; saturated readings are no sums.
//
// Subsurface: a translucent thing spreads light beneath and loses fine cosines, smoothly, so that phases still agree
// and are wrong (structured-light.subsurface). The finest amplitude over the largest, over what the best tenth of the
// picture has (the loss of lenses), is the share of light that comes straight back.
//
// Lines: the centroid of the light over the offsets at which the pixel is lit, where a Gray code tells the period
// (Guehring 2001).
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "manifest/noise.h"
#include "scan/projector_tone.h"
#include "scan/sequence.h"

namespace gonio::scan {

// Linear light, row by row: numbers, with those that are saturated marked (or none); or codes of 8 bits, with the light
// that each means, and from which on they are saturated.
struct CameraFrame {
  std::vector<float> light;
  std::vector<std::uint8_t> saturated;
  std::vector<std::uint8_t> codes{};
  std::array<float, 256> light_of_code{};
  int full_from = 256;
  std::size_t size() const { return codes.empty() ? light.size() : codes.size(); }
  float at(std::size_t i) const { return codes.empty() ? light[i] : light_of_code[codes[i]]; }
  bool full(std::size_t i) const {
    return codes.empty() ? !saturated.empty() && saturated[i] != 0 : codes[i] >= full_from;
  }
};

// Why a pixel has no code. edge: the stripe's border goes through it; contradictory: its numbers of periods do not
// agree; interreflection: light from other parts of the scene may have made a bit, or a period, another; motion: sums
// that light cannot change differ; subsurface: fine cosines are lost in the thing; ambiguous: one pixel of the
// projector is told by pixels that lie apart (code_places.h). Numbers are written to files: new ones come last.
enum class Refusal : std::uint8_t {
  none,
  masked,
  dark,
  saturated,
  edge,
  contradictory,
  outside,
  interreflection,
  motion,
  subsurface,
  ambiguous
};
constexpr std::array<std::string_view, 11> refusal_names{"none",   "masked",        "dark",     "saturated",
                                                         "edge",   "contradictory", "outside",  "interreflection",
                                                         "motion", "subsurface",    "ambiguous"};

struct Codes {
  int width = 0, height = 0;
  std::array<std::vector<float>, 2> place, sigma;  // by axis: the projector's pixel; empty where the axis is not told
  std::vector<Refusal> refusal;                    // by pixel
  std::vector<float> reflected;                    // what the projector's white adds
  bool whole = false;                              // places are stripes of a Gray code
  manifest::Noise noise{};                         // as stated, or as found
  double gamma = 1, gamma_sigma = 0;               // of the projector, by its cosines; sigma 0: not told
  std::optional<FlatLevel> below, above;           // which it shows all alike (projector_tone.h)
  bool told(std::size_t pixel) const { return refusal[pixel] == Refusal::none; }
};

struct DecodeRequest {
  Sequence sequence;
  int width = 0, height = 0;
  std::function<CameraFrame(std::size_t frame)> read;  // not more often than twice
  std::vector<std::uint8_t> mask{};                    // pixels that count, or empty
  // Of a single reading; nothing: found from the frames (frame_noise.h).
  std::optional<manifest::Noise> noise{};
  // projector.gamma where it is known, with its standard deviation; 0: found where shifts tell it.
  double gamma = 0, gamma_sigma = 0;
  double least_reflected = 0;   // light that white adds: less is dark, whatever the noise
  double least_difference = 0;  // between a bit and its inverse: less is an edge, whatever the noise
  double least_share = 0.05;    // of what white adds, for the same
  double least_sigmas = 2;      // of its noise, for the same
  double least_direct = 0.25;   // share of light that comes straight back; less is subsurface
  bool levels = true;           // look for what the projector shows alike
  bool motion = true;           // refuse what moved
  bool indirect = true;         // refuse what light from other parts of the scene may have made another
  bool contradictions = true;   // refuse phases that do not agree on a place; else the best is taken
};

// Error(data) for frames of another size.
Codes decode(const DecodeRequest& request);

}  // namespace gonio::scan
