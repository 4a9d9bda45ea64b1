// Links of the sensor chain (render/sensor_chain.h). A mechanism that acts behind the lens is one file,
// render/links/<id with _>.cpp, which defines `const Link& <id with _>()` in namespace gonio::render::links; the build
// gathers them. A link says at which step it acts and binds the mechanism's equation to its amounts.
#pragma once
#include <functional>
#include <span>

#include "base/random.h"
#include "camera/camera_model.h"
#include "io/image.h"
#include "mechanism/mechanism.h"

namespace gonio::photograph {
struct PolarizerArray;  // photograph/polarizer_array.h
}

namespace gonio::render {

enum class Step {  // in the order of the chain
  optics,          // pictures before the filters, linear in all bands: Stokes planes are treated as the radiance is
  polarizers,      // what stands before the samples of a polarization camera; nothing elsewhere
  charge,          // pictures behind the filters: what pixels give each other
  light,           // a value before photon noise
  signal,          // a value behind photon noise
  dark,            // what is read without light: read noise, and what these add
  reading,         // the sum of the two
  resampling       // pictures of readings
};

struct Site {  // of one reading
  int row = 0;
  Random& fixed;  // numbers that belong to the pixel of this camera, the same in all of its pictures
};
using OnValue = std::function<double(double v, const Site& site)>;
using OnPicture = std::function<void(io::Image& picture)>;

struct Link {
  const mechanism::Mechanism& (*mechanism)() = nullptr;
  Step step = Step::reading;
  int order = 0;  // within the step: ascending
  // The one that its step calls for; `p` are the mechanism's amounts. A null function: does not act on this picture.
  OnValue (*value)(std::span<const double> p) = nullptr;
  OnValue (*timed)(std::span<const double> p,
                   double exposure_s) = nullptr;  // instead: what the exposure's length changes
  OnPicture (*picture)(std::span<const double> p, double exposure_s) = nullptr;  // exposure_s 0: not stated
  // Step optics only, instead of `picture`: what depends on where the axis meets the picture.
  OnPicture (*lens)(std::span<const double> p, const camera::CameraModel& camera) = nullptr;
  // Of cameras behind polarizers this acts, and nothing else that the link has.
  void (*polarizers)(std::span<const double> p, photograph::PolarizerArray& array) = nullptr;
};

std::span<const Link* const> all_links();  // sorted by name; defined in a generated source

}  // namespace gonio::render
