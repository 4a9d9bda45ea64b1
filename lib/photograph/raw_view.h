// Exposures of one view as one picture of radiance, in codes per second: black and dark frames, flat field, defects,
// merge, mosaic. In this order.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "photograph/demosaic.h"
#include "photograph/exposure_merge.h"
#include "photograph/raw_correction.h"
#include "photograph/raw_frame.h"

namespace gonio::photograph {

struct RawView {
  std::string name;
  std::vector<std::filesystem::path> frames;
  std::vector<std::optional<double>> exposures_s;  // as stated for each frame; nothing: by the file
};

struct RawRecipe {
  RawStated stated;
  std::optional<DarkField> dark;
  std::optional<FlatField> flat;
  std::optional<manifest::Noise> noise;  // left out: from the exposures themselves
  Demosaicing demosaicing = Demosaicing::gradient;
  bool refine_exposures = true;
  int blooming_px = 1;
  std::size_t frame_memory_bytes = std::size_t{1} << 30;  // for decoded frames; those beyond are decoded several times
};

struct DevelopedView {
  // R, G, B (or Y; or Y, s1.Y, s2.Y), variance.R, ..., and exposure.shortest and exposure.longest: the times, s, as
  // they were used, of the shortest and the longest exposure in which any sample was read that the pixel's values are
  // from; 0: none was.
  io::Image picture;
  std::vector<std::uint8_t> trusted;  // one entry per pixel
  std::vector<double> stated_s;       // exposures as they were stated, here or by the files
  MergedPlane merged;                 // without its planes: exposures, chi-square
  manifest::Noise noise;
  bool noise_from_exposures = false;
  double share_too_bright = 0, share_moved = 0, share_unusable = 0;  // of all samples
};

// Error(data) for frames of different sizes or mosaics, an exposure that nobody states where there are several, and
// noise that is neither stated nor told by overlapping exposures.
DevelopedView develop_view(const RawView& view, const RawRecipe& recipe);

}  // namespace gonio::photograph
