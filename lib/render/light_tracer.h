// Paths from the lights: caustics, the light of lamps that reaches a surface by way of smooth interfaces. Arvo 1986,
// "Backward ray tracing"; Veach 1997, sections 5.2-5.3 (adjoint scattering) and 10.3.2 (partition of light).
//
// Class of paths, from the lamp to the camera, S a smooth interface and D any other event (in media, too):
//   lamp  S+  D  (S or D)*  D  camera        and        lamp  S+  D  camera
// that is, the lamp's light falls on its first D by way of smooth interfaces alone, and the camera sees the last D
// directly. Every D is connected to the camera (caustic_camera.h). Paths from the camera leave exactly this class out
// for the lamps of which photons are traced (path_lights.h): nothing is counted twice.
//
// Flux is carried, not radiance: a transmission weighs (index beyond / index here)^2 times its weight for radiance, and
// shading normals the ratio |cos(wi, Ns) cos(wo, Ng)| / |cos(wi, Ng) cos(wo, Ns)| (Veach 1997, equation 5.19), wi the
// side of the lamp. They add to the radiance and to the planes of their lamps; with transport.stokes they carry their
// polarization (photon_stokes.h) and add to s1, s2 and s3.
#pragma once
#include <cstdint>
#include <optional>

#include "render/caustic_camera.h"
#include "render/caustic_sources.h"
#include "render/free_flight.h"
#include "render/path_setting.h"
#include "render/photon_stokes.h"
#include "render/sampler.h"
#include "render/vertex.h"

namespace gonio::render {

struct PhotonPath {
  std::size_t emitter = 0;
  Rgb flux;  // W
  Vec3 origin_m, direction;
  Inside inside;
  std::optional<SurfacePoint> left;  // the surface that it leaves; after travelling what it has met
  int colour = -1;                   // the one band that is left
  int smooth = 0, spread = 0;        // events so far
  std::optional<PhotonStokes> stokes{};
};

class LightTracer {
 public:
  LightTracer(const PathSetting& setting, const CausticSources& sources, std::size_t extra_planes);

  // Paths first .. first + count - 1; each adds its estimate of the picture, over `count`.
  void trace(std::uint64_t seed, std::uint64_t first, std::uint64_t count, Splats& splats) const;

  enum class Fate { lost, surface, medium };
  // Steps of one path, for other uses of the same light.
  std::optional<PhotonPath> start(Sampler& sampler) const;
  Fate travel(PhotonPath& path, Sampler& sampler) const;
  // Scatters at what travel() has found. False: the path ends.
  bool scatter(PhotonPath& path, Fate fate, Sampler& sampler, double share, Splats* splats) const;
  // Can the camera see this point directly? Share per band of what goes to it that arrives; the pixel.
  struct View {
    Sight sight;
    Vec3 to_camera;
    double distance_m = 0;
  };
  std::optional<View> view(Vec3 point_m, Vec2 lens_u) const;

 private:
  bool scatter_at_surface(PhotonPath& path, Sampler& sampler, double share, Splats* splats) const;
  bool scatter_in_medium(PhotonPath& path, Sampler& sampler, double share, Splats* splats) const;
  void connect_surface(const PhotonPath& path, const Vertex& vertex, const Crossing* crossing, Vec2 lens_u,
                       double share, Splats& splats) const;
  void add(const PhotonPath& path, const View& view, Rgb value, const PhotonStokes* stokes, Splats& splats) const;

  const PathSetting& setting_;
  const CausticSources& sources_;
  CausticCamera camera_;
  std::size_t extra_planes_;
  std::vector<Inside> around_;  // the emitters; of those far away nothing
};

}  // namespace gonio::render
