// Where photographs show an object, its shadow, and the ground: a label per pixel.
//
// Linear radiance, in any scale; pictures with R, G, B or Y. Pixel (0, 0) is the top-left one. Four ways, by what there
// is: (1) several pictures, each under another lamp; (2) one picture and one without the object; (3) one picture; (4)
// strokes.
//
// (1) to (3) share a model. Lit ground is smooth: its radiance is the exponential of a polynomial of the pixel (a point
// lamp over a plane is within 1 % of one of degree 4 as long as it stands no nearer than the picture is wide), or, in
// (2), the empty picture times a smooth factor. Divided by it, ground is 1, or, in a cast shadow, darker and nearly of
// its own colour. An object is whatever else: bright in another way, or of another colour, which is learned. What all
// pictures say of a pixel is added up, and a minimum cut (Boykov & Kolmogorov 2004; the alternation of cutting and
// learning is that of GrabCut: Rother, Kolmogorov & Blake 2004) draws the rim where pictures have an edge. Pixels at
// the rim are mixtures of both sides; the object has those whose larger share is its own, so that areas are not biased.
//
// The ground has to be more than half of the picture, and the object must not meet the picture's border.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/image.h"
#include "manifest/noise.h"

namespace gonio::alignment {

enum class Label : std::uint8_t { ground, object, shadow, unknown };

struct Segmentation {
  int width = 0, height = 0;
  std::vector<Label> labels;        // per pixel
  std::vector<float> object_share;  // per pixel, 0 to 1: between at the object's rim (observed_rim.h: Region.share)
  std::vector<float> shadow_share;  // the same of the shadow, as far as the object leaves it to be seen
  // Unknown are also places past the ground's edge: dark in every picture, from the border inwards, and no part of the
  // object.
  double certainty = 0;  // share of the pixels that are not unknown
};

// `noise` {0, 0}: nobody knows; then it is taken from the pictures. `place` names the input in errors.
// Error(data): fewer than two pictures, of different sizes, none of another lamp than the first, no object, or one that
// meets the border. One segmentation per picture; they differ in the shadows.
std::vector<Segmentation> segment_by_lamps(std::span<const io::Image> pictures, const manifest::Noise& noise,
                                           const std::string& place);
Segmentation segment_by_background(const io::Image& picture, const io::Image& empty, const manifest::Noise& noise,
                                   const std::string& place);
// Dark parts that may be the object's own dark side as well as its shadow are unknown, where neither colour nor a step
// of brightness tells. Of pictures lit by one lamp from the side that can be most of the object: by lamps is the better
// way.
Segmentation segment_alone(const io::Image& picture, const manifest::Noise& noise, const std::string& place);

// `strokes`: per pixel what the user has drawn there, unknown elsewhere; object and ground at least. GrabCut on the
// picture's tones (x^(1/2.2), which is closer to even steps than linear values): object and shadow from the ground,
// then the object from the shadow, where at least ten pixels of that are drawn. Shares are 0 and 1, nothing is unknown.
Segmentation segment_by_strokes(const io::Image& picture, std::span<const Label> strokes, const std::string& place);

}  // namespace gonio::alignment
