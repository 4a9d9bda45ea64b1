// Figures of a sensor after EMVA Standard 1288, release 4.0, linear model, from sums over a series (sensor_series.h):
//   sigma_y^2 - sigma_dark^2 = K (mu_y - mu_dark)         photon transfer; K in codes per electron
//   sigma_dark^2 = K^2 sigma_d^2 + step^2 / 12            read noise, and rounding to codes
// sigma^2 are variances in time, of differences of frames of one exposure: fixed pattern and an uneven lamp drop out,
// and so does a lamp that changes between frames, tile by tile. Spatial variances are those of means over frames, less
// what is left in them of temporal noise.
//
// Uncertainties are those of a jackknife over the 64 tiles of the picture, which asks nothing of the noise's law.
// Figures that are roots (noise, DSNU, PRNU) have the root of their square's interval, which may begin at 0.
#pragma once
#include <string>
#include <vector>

#include "manifest/noise.h"
#include "photograph/sensor_series.h"

namespace gonio::photograph {

struct SensorFigure {
  std::string name, unit;
  double value = 0, sigma = 0, lower = 0, upper = 0;  // one standard deviation; the 95 % interval
  std::string meaning;
};

// One exposure: of a lit one `mean` is above the dark frames of that exposure. Codes, codes^2.
struct LevelFigures {
  double exposure_s = 0, mean = 0, temporal = 0, spatial = 0;
  double off_line = 0;  // mean over what the line of linearity says, less 1; 0 beyond its range
};

struct PlaneFigures {
  std::string name;                   // SeriesPlane's
  std::vector<SensorFigure> figures;  // those that the series tells
  std::vector<std::string> left_out;  // which ones it does not tell, and why
  std::vector<LevelFigures> lit, dark;
  double dark_temporal = 0;  // codes^2: of the shortest dark exposure
  double rounding = 0;       // codes^2: step^2 / 12, in `dark_temporal`
  double saturation = 0;     // codes above dark: mean at the largest variance, else full scale
  double half = 0;           // codes above dark: of the exposure that PRNU is from
  Spectrum dark_rows, dark_columns, lit_rows, lit_columns;  // root of power: e, and % of `half`
  double dark_white = 0, lit_white = 0;                     // what temporal noise gives them
  const SensorFigure* find(const std::string& name) const;  // null: left out
};

struct SensorFigures {
  std::vector<PlaneFigures> planes;
  manifest::Noise codes;  // mean over planes: electrons per code, and read noise with rounding in codes
  manifest::Noise unit;   // the same of the numbers of the file's picture, code over full code
  int width = 0, height = 0;
  double full_code = 1;  // SeriesSums'
};

// Error(data) where a plane has no dark frames, fewer than two exposures between dark and 70 % of saturation, an
// exposure that is no brighter than the dark or whose frames differ by more than 2 % or not at all.
SensorFigures characterize(const SeriesSums& sums);

}  // namespace gonio::photograph
