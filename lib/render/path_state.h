// One path from the camera on its way. World frame, metres.
#pragma once
#include <optional>
#include <span>

#include "render/integrator.h"
#include "render/media.h"
#include "render/sampler.h"
#include "render/vertex.h"

namespace gonio::render {

template <class Carrier>
struct Path {
  Carrier carrier;
  Vec3 origin_m, direction;          // of the last scattering event; unit
  Inside inside;                     // what surrounds the ray
  std::optional<SurfacePoint> left;  // the surface that the ray leaves; after travelling what it has met
  Sampler& sampler;
  std::span<Rgb> planes;
  Rgb scale;  // of radiance to the picture's values
  Noticed& noticed;
  Rgb begin;                 // planes[0] before this path
  double onward = 1;         // paths that go on from the first event on a surface
  bool first = true;         // nothing has scattered yet
  bool sees_spread = false;  // the first event was no smooth interface
  double density = 0;        // of having drawn the direction
  bool alone = true;         // sampling the lights could not have found what the ray meets
  int surfaces = 0;          // events at surfaces
  int events = 0;            // all events
  int scattered = 0;         // those that spread light: no smooth interfaces
  int colour = -1;           // the one band that is left
  double index_square = 1;   // here, over that at the camera
};

// A surface that a path has met.
struct Meeting {
  const Vertex& vertex;
  const Crossing* crossing;  // null where there are no media
  bool transmits;
  int keep;  // the one band to go on beyond the surface; -1: all
};

}  // namespace gonio::render
