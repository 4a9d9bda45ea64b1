// What one camera path brings back: the side of a renderer that knows physics. The other side, render() in
// path_tracer.h, knows pixels, passes and noise, and nothing of light.
//
// A path adds to `planes`, one Rgb each: number 0 is the radiance, the others are what planes() names: "light.NAME" of
// single lights, "s1", "s2", "s3" of Stokes vectors. Everything is an estimate whose mean over samples is the pixel.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/film.h"
#include "render/ray_caster.h"
#include "render/sampler.h"
#include "scene/scene.h"

namespace gonio::render {

// lights_only makes no use of directions that happen to meet a light; tests hold the two against each other.
enum class Estimator { combined, lights_only };

struct Transport {  // what is simulated
  int max_bounces = 128;
  Estimator estimator = Estimator::combined;
  bool per_light = false;   // a plane for each light
  bool stokes = false;      // planes s1, s2, s3
  bool from_lights = true;  // trace() leaves to trace_from_lights() what that finds
  bool adaptive = true;     // more samples where noise counts
};

class SampleMap;

struct Noticed {                    // over the samples of a pixel
  std::vector<std::uint32_t> seen;  // unoccluded samples of each light at the first surface
  std::uint32_t met = 0;            // samples that met a surface
  std::uint64_t events = 0;         // of scattering, in all samples: a measure of work
  double near = 0;                  // what was found up to the first event, mean of the bands, sum over samples
};

// A sum over a picture that light-traced paths add to; safe from many threads, and the same whatever their number.
class Splats {
 public:
  virtual ~Splats() = default;
  virtual void add(Vec2 pixel, std::size_t plane, Rgb value) = 0;
};

class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual std::vector<std::string> planes() const = 0;  // [0] is ""
  virtual std::size_t lights() const = 0;               // size of Noticed::seen
  virtual void trace(Vec2 pixel, Sampler& sampler, std::span<Rgb> planes, Noticed& noticed) const = 0;
  virtual PixelGeometry geometry(int x, int y, const Noticed& noticed) const = 0;
  // How many samples a pass takes in each pixel, where not the same in all: `preset` is their mean. Not to be called
  // from many threads.
  virtual const SampleMap* sample_map(int /*preset*/) const { return nullptr; }
  // Light that only paths from the lights find (caustics of small lamps). One pass: `count` paths whose numbers are
  // `first` ...; adds estimates for the whole picture. False: there is no such light in this scene.
  virtual bool traces_from_lights() const { return false; }
  virtual void trace_from_lights(std::uint64_t /*seed*/, std::uint64_t /*first*/, std::uint64_t /*count*/,
                                 Splats& /*splats*/) const {}
};

std::unique_ptr<Integrator> path_integrator(const scene::Scene& scene, std::size_t view, const RayCaster& caster,
                                            const Transport& transport);

}  // namespace gonio::render
