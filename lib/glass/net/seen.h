// What a network of scripts/glass-net sees of a photograph: the planes that it learnt from (glass/tensors.h).
//
// Pictures, by their channels:
//   Y                     readings behind a mosaic of polarizers (photograph/polarizers.h)
//   Y, s1.Y, s2.Y         light before polarizers, as develop(1) finds it
//   R, G, B               light; with s1.R ... s2.B, as render(1) writes them, its polarization
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "io/image.h"

namespace gonio::glass {

// Planes channel by channel, rows from the top.
struct Planes {
  std::size_t channels = 0, height = 0, width = 0;
  std::vector<float> values;
  std::size_t pixels() const { return height * width; }
  float* plane(std::size_t channel) { return values.data() + channel * pixels(); }
  const float* plane(std::size_t channel) const { return values.data() + channel * pixels(); }
};

// Of a mosaic: s0, s1, s2 of every pixel; behind 0, 45, 90 and 135 degrees the readings of a super-pixel, at each of
// its pixels.
Planes stokes_of_mosaic(const io::Image& mosaic);
Planes intensities_of_mosaic(const io::Image& mosaic);
// s0, s1, s2 of a picture that states them, bands as their luminance; no values where it does not.
Planes stokes_of_picture(const io::Image& picture);

// "rgb", "stokes" or "intensities" of a picture, each block of `shrink` x `shrink` pixels (what is left over at the
// right and below is not seen) as its mean. Error(data) at `place` where the picture does not say that.
Planes seen_of(const io::Image& picture, const std::string& input, int shrink, const std::string& place);

// In units of the mean light before polarizers, so that exposures do not count; as glass_set.in_mean_light does.
// Error(data) at `place` for a picture without light.
void in_mean_light(Planes& seen, const std::string& input, const std::string& place);

// What speaks for a mosaic of polarizers in a picture of one channel. Behind one, of each super-pixel I0 + I90 is
// I45 + I135, and where light is polarized they differ in a way that stays the same from one super-pixel to the next;
// of a mosaic of colours two green samples, which lie on a diagonal, differ from red and blue; pixels of any other
// picture know nothing of super-pixels.
struct MosaicEvidence {
  double polarization = 0;  // root mean square of the degree of linear polarization, over blocks of 16 x 16 pixels,
                            // less in small pictures
  double diagonals = 0;     // the same of (I0 + I90 - I45 - I135) / s0
};
MosaicEvidence mosaic_evidence(const io::Image& mosaic);
// Error(data) at `place` for what is no such mosaic, and for one that shows no polarization: they look alike.
void demand_mosaic(const io::Image& mosaic, const std::string& place);

}  // namespace gonio::glass
