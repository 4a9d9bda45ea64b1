// Photons for caustics: light of lamps on its way to smooth surfaces. World frame, metres.
//
// A lamp of which photons are known (Emitter::emit) sends them where smooth surfaces can be: its unit squares of
// position and direction are cut into cells, a cell is drawn in proportion to the power that a few probes saw leave it
// towards the bounding spheres of objects with smooth surfaces, a tenth of all evenly over the cells, so that no
// direction is left out (Jensen 1995's projection maps, without their bias); the flux is divided by the probability.
// Infinitely far lamps of one direction shine through a disc that covers the bounding spheres.
#pragma once
#include <cstdint>
#include <vector>

#include "render/sampler.h"
#include "scene/scene.h"

namespace gonio::render {

struct Ball {
  Vec3 centre_m;
  double radius_m = 0;
};
// Around an object.
Ball ball_around(const scene::Instance& instance);
// Has the surface, somewhere, a perfectly smooth lobe?
bool has_smooth_lobe(const scene::Scene& scene, std::size_t surface);

struct Photon {
  std::size_t emitter = 0;
  Vec3 origin_m, direction;  // unit
  Rgb flux;                  // W; its mean over draws is the power of all lamps that are traced
  bool valid = false;        // false: it misses all bounding spheres
};

class CausticSources {
 public:
  CausticSources(const scene::Scene& scene, std::vector<const light::Emitter*> emitters);
  bool any() const { return total_ > 0; }
  bool traces(std::size_t emitter) const { return sources_[emitter].chance > 0; }
  Rgb power(std::size_t emitter) const { return sources_[emitter].power; }  // W; of distant ones through their disc
  Photon draw(Sampler& sampler) const;

 private:
  struct Source {
    bool point = false, distant = false;
    int positions = 1, directions = 1;  // cells per axis of the two unit squares
    std::vector<double> cumulative;     // over the cells
    double chance = 0;                  // of being drawn
    Rgb power;
  };
  light::Emission emission(std::size_t emitter, Vec2 position, Vec2 direction) const;
  bool hits_ball(Vec3 origin_m, Vec3 direction) const;
  Source prepare(std::size_t emitter);

  std::vector<const light::Emitter*> emitters_;
  std::vector<Ball> balls_;
  Ball all_;
  std::vector<Source> sources_;
  double total_ = 0;
};

}  // namespace gonio::render
