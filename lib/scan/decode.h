// From the pictures of a sequence to the projector's pixel that lit each pixel of the camera.
//
// Gray code: a bit is set where its picture is brighter than its inverse (where none is shown: than the mean of white
// and black). A pixel's code holds where every difference is larger than noise could make it and than a share of what
// white and black differ by; else it is an edge: the border of two stripes, or light that comes from other parts
// of the scene. It tells a whole stripe: sigma is its width over sqrt(12).
//
// Cosines: least squares for A + C cos(shift) + S sin(shift) = A + B cos(theta - shift), theta = atan2(S, C), whose
// variance is that of the frames times (J^-1) in the direction across (C, S), over B^2. Which period it is, all numbers
// of periods say together: of the places u that the finest theta leaves open the one that contradicts the others least,
//   chi^2(u) = sum_f (theta_f - 2 pi P_f (u + 1/2) / size, wrapped)^2 / sigma_f^2,
// if none other is nearly as good. Any numbers of periods that do not all repeat together will do: a coarse one to
// start from, several close to each other (heterodyne), or many high ones (micro phase shifting, Gupta & Nayar 2012).
// Then u is the mean of what all say, by their variances.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "manifest/noise.h"
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
// agree.
enum class Refusal : std::uint8_t { none, masked, dark, saturated, edge, contradictory, outside };
constexpr std::array<std::string_view, 7> refusal_names{"none", "masked",        "dark",   "saturated",
                                                        "edge", "contradictory", "outside"};

struct Codes {
  int width = 0, height = 0;
  std::array<std::vector<float>, 2> place, sigma;  // by axis: the projector's pixel; empty where the axis is not told
  std::vector<Refusal> refusal;                    // by pixel
  std::vector<float> reflected;                    // what the projector's white adds
  bool whole = false;                              // places are stripes of a Gray code
  manifest::Noise noise{};                         // as stated, or as found
  bool told(std::size_t pixel) const { return refusal[pixel] == Refusal::none; }
};

struct DecodeRequest {
  Sequence sequence;
  int width = 0, height = 0;
  std::function<CameraFrame(std::size_t frame)> read;  // not more often than twice
  std::vector<std::uint8_t> mask{};                    // pixels that count, or empty
  // Of a single reading; nothing: found from the frames (frame_noise.h).
  std::optional<manifest::Noise> noise{};
  double least_reflected = 0;   // light that white adds: less is dark, whatever the noise
  double least_difference = 0;  // between a bit and its inverse: less is an edge, whatever the noise
  double least_share = 0.05;    // of what white adds, for the same
  double least_sigmas = 2;      // of its noise, for the same
};

// Error(data) for frames of another size.
Codes decode(const DecodeRequest& request);

}  // namespace gonio::scan
