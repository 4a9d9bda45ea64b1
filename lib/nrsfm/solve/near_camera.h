// Does perspective help where shapes are lacking? Deformation beyond a model's rank is no noise: it is shared by points
// and frames, bends what is fitted to it, and a test against noise would see something in all of it. So the question is
// nested: do K shapes predict unseen observations better with kappa than without it (deforming_fit.h), and K + 1 shapes
// again (of the kind of type III sums of squares: on top of all shapes, not before them)?
//
//   unseen     a quarter of the observations at a time, fitted by the rest; the same quarters for all models
//   gain       log(rms without / rms with); every point, and every stretch of frames, is one witness of it
//   bought     the gain over what the next shape, with its F + 3P numbers, gains by itself
//
// Perspective is there where for both numbers of shapes the gain matters, points and stretches agree that there is one,
// the sign of kappa is the same, one number buys a fair part of what a whole shape does, and kappa is away from zero by
// a sandwich estimate over stretches of frames. The fits with and without begin from each other's ends until neither
// helps the other, since the lower of two minima is no gain.
#pragma once
#include "nrsfm/sequence.h"
#include "nrsfm/solve/followed.h"
#include "nrsfm/solve/solved_model.h"

namespace gonio::nrsfm {

// The least squares of the solver's shapes with weights free in every frame, where the model frees them all.
SolvedModel settled(const Sequence& sequence, SolvedModel model);

// `enough`: a root mean square distance that noise alone makes; where the solver's shapes fit as well, none is lacking,
// and nothing else is asked.
NearCamera find_near_camera(const Sequence& sequence, const SolvedModel& model, double enough = 0);

}  // namespace gonio::nrsfm
