// What a fit to rims is asked (fit.h): sightings of rims, what is free, what is known besides, and by which stages.
#pragma once
#include <functional>
#include <vector>

#include "alignment/model_rim.h"
#include "alignment/observed_rim.h"

namespace gonio::alignment {

// What one photograph shows of one rim.
struct Sighting {
  RimSubject subject;
  std::vector<RimPoint> points;  // straightened
  // Of a place of the picture, straightened: could a rim of this subject not be seen there, because something stands
  // before it or the picture ends? Empty: it could be everywhere.
  std::function<bool(Vec2)> unseen;
};
struct Contact {  // the lowest vertex of a body touches the ground, as far as that is known
  std::size_t body = 0;
  double sigma_m = 1e-4;
};
struct Question {
  std::vector<Sighting> sightings;
  std::vector<Freedom> freedoms;
  std::vector<Contact> contacts;
  Setting stated;  // what priors hold to
};
struct Stage {
  double reach_px = 6;  // farther apart, a point and a rim are not each other's
  double width_px = 1;  // of the loss; 0: by what is left, sighting by sighting
  bool both_ways = false;
  int every = 1;  // of the points, one in so many
  int most_steps = 30;
  double small_fall = 1e-6;
};
// How far rims were off before each step of a fit, and at its end: see rms_offset() (rim_offsets.h).
struct FitPath {
  double reach_px = 60;  // a point without a rim so near counts as one that is so far off
  std::vector<double> rms_px{};
};
// From anywhere within `start_px` of the rims to the end.
std::vector<Stage> stages_from(double start_px);

// Where the fit ends, without figures or covariance; `path`, if any, is continued. Error(data) where a rim of the start
// does not exist.
Setting settle_rims(const Setting& start, const Question& question, const std::vector<Stage>& stages,
                    FitPath* path = nullptr);

}  // namespace gonio::alignment
