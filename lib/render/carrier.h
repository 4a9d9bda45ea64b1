// What travels along a path from the camera: a *carrier*. The path loop (path_loop.h) is a template on it; this is the
// concept, and its simplest member. A carrier knows how what arrives from the path's far end is transformed on its way
// to the camera; it starts as the identity and is multiplied from the right at every event.
//
//   Carrier::start(camera_x, direction)  at the camera; camera_x: the picture's x axis in the world, direction: of the
//                                   ray, away from the camera
//   scatter(vertex, wi, weight)     a surface turns light from the local direction wi into light towards vertex.wo;
//                                   weight: f |cos| / density per band. From now on the ray runs along wi
//   depolarize(direction, weight)   the same where polarization is lost (media, light from beneath a surface);
//                                   direction: of the ray from now on, away from the camera
//   attenuate(share)                per band, along the ray
//   keep(band)                      only one band goes on, three times as strong
//   power()                         per band the factor on unpolarized radiance; steers roulette and choices of bands
//   met(direction, radiance, emitter)  what `radiance` of the emitter, met along the ray, is worth: a Value
//   planes()                        names of what a Value holds beyond its radiance
//   deposit(value, scale, planes)   adds it, times scale per band, to planes[0], planes[1] ...
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "light/light.h"
#include "render/vertex.h"

namespace gonio::render {

class Unpolarized {
 public:
  using Value = Rgb;
  static Unpolarized start(Vec3 /*camera_x*/, Vec3 /*direction*/) { return {}; }
  void scatter(const Vertex&, Vec3 /*wi*/, Rgb weight) { throughput_ *= weight; }
  void depolarize(Vec3 /*direction*/, Rgb weight) { throughput_ *= weight; }
  void attenuate(Rgb share) { throughput_ *= share; }
  void keep(int band) {
    throughput_ = Rgb{band == 0 ? 3.0 : 0, band == 1 ? 3.0 : 0, band == 2 ? 3.0 : 0} * throughput_;
  }
  Rgb power() const { return throughput_; }
  Value met(Vec3 /*direction*/, Rgb radiance, const light::Emitter&) const { return throughput_ * radiance; }
  static std::vector<std::string> planes() { return {}; }
  static void deposit(const Value& value, Rgb scale, std::span<Rgb> planes) { planes[0] += value * scale; }
  static Rgb radiance(const Value& value) { return value; }

 private:
  Rgb throughput_{1, 1, 1};
};

}  // namespace gonio::render
