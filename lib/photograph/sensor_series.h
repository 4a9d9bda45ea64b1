// Series of frames of even light and of none, each exposure taken several times, as sums over tiles of the picture:
// what the figures of a sensor (characterize.h) are made of.
//
// Each colour of a mosaic is a picture of its own. Memory holds two numbers for each sample of one exposure, however
// many frames there are.
#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "photograph/raw_frame.h"

namespace gonio::photograph {

inline constexpr int tiles_across = 8;  // and down

struct SeriesFrame {
  std::string name;  // of its file
  bool dark = false;
  double exposure_s = 0;
};
struct SensorSeries {
  std::vector<SeriesFrame> frames;  // in any order
  std::function<RawFrame(std::size_t frame)> read;
};

// Codes above black. m: the mean of a sample over the frames of its exposure.
struct TileSums {
  double samples = 0;
  double sum = 0, squares = 0;                  // of m, of m^2
  double temporal = 0, temporal_freedom = 0;    // squares about m, each frame's own brightness in the tile taken off
  double structure = 0, structure_freedom = 0;  // squares of m about a polynomial of second order in the tile
};

// Mean power of m's rows or columns, a polynomial of second order over the picture taken off: |Y_k|^2 / n, so that
// noise without correlation has its variance at all frequencies. First entry: one period over the picture.
using Spectrum = std::vector<double>;

struct SeriesLevel {
  double exposure_s = 0;
  std::size_t frames = 0;
  std::string name;  // of the first frame's file
  std::array<TileSums, tiles_across * tiles_across> tiles{};
  double share_full = 0, share_lowest = 0;  // of all samples
  double drift = 0;                         // codes: mean of the brightest frame less that of the darkest
  Spectrum rows{}, columns{};
};

struct SeriesPlane {
  std::string name;                    // "Y", "R", "G1" (beside red), "G2", "B"; or "90 degrees", ...
  std::vector<SeriesLevel> lit, dark;  // by exposure
  double step = 0;                     // between codes; 0: numbers that were not rounded
  double full_scale = 0;               // above black
};

struct SeriesSums {
  std::vector<SeriesPlane> planes;
  int width = 0, height = 0;
  double full_code = 1;  // RawFrame's
};

// Exposures are as stated for each frame (`exposures_s`, lit ones first; empty: none is), else by the file's name, else
// by the file. Error(data) for a frame whose exposure nobody knows.
SensorSeries series_of_files(const std::vector<std::filesystem::path>& lit,
                             const std::vector<std::filesystem::path>& dark,
                             const std::vector<std::optional<double>>& exposures_s, const RawStated& stated);

// Error(data) for an exposure of one frame, frames of another size or mosaic, a picture too small for its tiles, and
// codes that the full scale does not go with.
SeriesSums sum_series(const SensorSeries& series);

}  // namespace gonio::photograph
