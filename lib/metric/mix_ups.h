// Files that show another picture of the set than the one they are named for: two names exchanged, names shifted by
// one, one file used twice, two lamps exchanged.
//
// Every recording i is held against the predictions of all pictures j of its size, at the pixels at which j was
// predicted. With c a twentieth of the recording's rms and s a factor for the exposure, one for each kind of surface
// that the prediction tells apart (what a thing reflects is not known beforehand),
//   e_ij^2 = mean of min(d^2, 1),   d = log(max(v, 0) + c) - log(s f + c),
// less what the recording's noise brings. File i fits what j should show where
//   - e_ii is at least 3 % and e_ij at most 30 % and at most a third of e_ii (two thirds with the noise),
//   - over blocks of the picture the squares fall at a level of 1e-3 shared by all pairs of the set (Student's t), and
//   - e_ii is no error of pose or lamp that happens to be as large as the distance between two views. Of such errors
//     the median r over the set, every file at the place that it fits, tells the size: where they are normal, none
//     reaches q r, q = t(1 - 1e-3 / 2n; n - 1) / 0.6745, at a level of 1e-3 a set of n. Files that exchange their
//     places among themselves need 3 r: each would have to do so, into the place of the other. A file that is a copy
//     of another one, to the last bit, needs neither.
// By the triangle inequality the predictions i and j then differ by two thirds of e_ii: where views are more alike than
// that nothing is said, nor does it matter.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "manifest/noise.h"

namespace gonio::metric {

struct PictureOfSet {
  std::string name;
  int width = 0, height = 0;
  std::size_t channels = 3;
  std::span<const float> recording;      // linear, channels a pixel, rows from the top
  std::span<const std::uint8_t> counts;  // per pixel of the recording
  manifest::Noise noise;                 // variance of a value v: v / gain + read^2 (gain 0: no shot noise)
  std::vector<std::uint32_t> at;         // pixels, y * width + x, at which it was predicted
  std::vector<std::uint32_t> label;      // of each: the surface that it shows; empty: all alike
  std::vector<double> predicted;         // channels for each
  std::size_t view = 0;                  // pictures of one view differ by their lights alone
  std::string lights;                    // that were on, as words
};

struct MixUp {
  std::size_t image = 0, shows = 0;  // the file of `image` fits what `shows` should show
  double own = 0, other = 0;         // errors against the two predictions, 0 .. 1
  bool in_place = false;             // the file of `shows` fits it, too
};
// In the order of the set; at most one for each picture.
std::vector<MixUp> mix_ups(std::span<const PictureOfSet> set);

// What was found as one sentence for each closed exchange: "The file of image left-2 fits what left-1 should show
// (error 3 % instead of 48 %), and that of left-1 what left-2 should show (4 % instead of 50 %): are two file names
// swapped?" Empty where nothing was found.
std::vector<std::string> mix_up_sentences(std::span<const PictureOfSet> set, std::span<const MixUp> found);

}  // namespace gonio::metric
