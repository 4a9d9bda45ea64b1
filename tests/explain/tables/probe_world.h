// Highlights of lamps on mirror balls, without probe::MirrorBall: a lamp's light takes the shortest way from the lamp
// by the ball to the eye, on which the normal halves the angle between both (Fermat, Heron). The point is found by
// turning the normal into that half until it stays.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "table_world.h"

namespace gonio::explain::tables::tests {

struct Balls {
  std::vector<Vec3> eyes{{-0.6, 0, 0.1}, {0.1, -0.55, 0.3}, {0.2, 0.5, 0.4}, {-0.4, 0.4, 0.2}};
  std::vector<Vec3> centres{{}};  // as they are stated
  std::vector<Vec3> off{};        // by which they truly stand elsewhere
  double radius_m = 0.03, radius_off_m = 0;
  std::vector<double> distances_m{};  // of the lamps, one after the other; empty: infinitely far
  int lamps = 8;
  double noise_px = 0.1, centre_sigma_m = 0, k1 = 0;
  std::string group = "view";
  std::string lights{};  // of the manifest
};

inline constexpr double ball_focal_px = 2400, ball_middle_px = 800;

// The ball's point that mirrors the lamp into the eye; `lamp`: its place, or its direction where it is far.
inline Vec3 mirrored_at(Vec3 centre, double radius, Vec3 eye, Vec3 lamp, bool far) {
  Vec3 n = normalized(normalized(eye - centre) + (far ? lamp : normalized(lamp - centre)));
  for (int step = 0; step < 200; ++step) {
    const Vec3 p = centre + n * radius;
    const Vec3 half = normalized(normalized(eye - p) + (far ? lamp : normalized(lamp - p)));
    if (norm(half - n) < 1e-15) break;
    n = half;
  }
  return centre + n * radius;
}

// Directions of lamps that no camera's blind cone holds.
inline std::vector<Vec3> lamp_directions(int count, std::uint64_t seed) {
  Random random(seed, 21);
  std::vector<Vec3> all;
  while (static_cast<int>(all.size()) < count) {
    const Vec3 d{random.normal(), random.normal(), 0.4 + std::abs(random.normal())};
    all.push_back(normalized(d));
  }
  return all;
}

inline World probe_world(std::uint64_t seed, const Balls& b = {}) {
  World w;
  w.columns = {{"image", ""},
               {"ball", ""},
               {"lamp", ""},
               {"view", ""},
               {"ball_x_m", "m"},
               {"ball_y_m", "m"},
               {"ball_z_m", "m"},
               {"radius_m", "m"},
               {"ball_sigma_x_m", "m"},
               {"ball_sigma_y_m", "m"},
               {"ball_sigma_z_m", "m"},
               {"u_px", "px"},
               {"v_px", "px"},
               {"u_sigma_px", "px"},
               {"v_sigma_px", "px"}};
  w.rest = R"("model": "probe", "observed": ["u_px", "v_px"], "sigma": ["u_sigma_px", "v_sigma_px"], "group": ")" +
           b.group + "\"";
  w.sections =
      format(R"("cameras": {"c": {"model": "pinhole", "width_px": %g, "height_px": %g, "fx_px": %g,
    "fy_px": %g, "cx_px": %g, "cy_px": %g}}, "images": [)",
             2 * ball_middle_px, 2 * ball_middle_px, ball_focal_px, ball_focal_px, ball_middle_px, ball_middle_px);
  Vec3 middle{};
  for (const Vec3 c : b.centres) middle += c / static_cast<double>(b.centres.size());
  const std::vector<Vec3> lamps = lamp_directions(b.lamps, seed);
  Random random(seed, 22);
  for (std::size_t v = 0; v < b.eyes.size(); ++v) {
    const Vec3 eye = b.eyes[v], forward = normalized(middle - eye), right = normalized(cross(forward, {0, 0, 1})),
               down = cross(forward, right);
    w.sections +=
        format(R"(%s{"id": "%zu", "camera": "c", "world_from_camera": {"matrix": [)", v == 0 ? "" : ", ", v + 1);
    for (int row = 0; row < 3; ++row)
      w.sections += format("[%.17g, %.17g, %.17g, %.17g], ", right[row], down[row], forward[row], eye[row]);
    w.sections += "[0, 0, 0, 1]]}}";
    for (std::size_t k = 0; k < b.centres.size(); ++k) {
      const Vec3 centre = b.centres[k] + (k < b.off.size() ? b.off[k] : Vec3{}) +
                          Vec3{random.normal(), random.normal(), random.normal()} * b.centre_sigma_m * (v == 0 ? 1 : 0);
      for (std::size_t l = 0; l < lamps.size(); ++l) {
        const bool far = b.distances_m.empty();
        const Vec3 lamp = far ? lamps[l] : middle + lamps[l] * b.distances_m[l % b.distances_m.size()];
        const Vec3 p = mirrored_at(centre, b.radius_m + b.radius_off_m, eye, lamp, far);
        const Vec3 seen = p - eye;
        if (-dot(p - centre, seen) < 0.15 * b.radius_m * norm(seen)) continue;  // beyond 81 degrees
        const double x = dot(seen, right) / dot(seen, forward), y = dot(seen, down) / dot(seen, forward);
        const double bend = 1 + b.k1 * (x * x + y * y);
        const Vec3 c = b.centres[k];
        w.rows.push_back({v + 1.0, k + 1.0, l + 1.0, 10.0 * (v + 1) + k + 1, c.x, c.y, c.z, b.radius_m,
                          b.centre_sigma_m, b.centre_sigma_m, b.centre_sigma_m,
                          ball_middle_px + ball_focal_px * x * bend + b.noise_px * random.normal(),
                          ball_middle_px + ball_focal_px * y * bend + b.noise_px * random.normal(), b.noise_px,
                          b.noise_px});
      }
    }
  }
  w.sections += "]," + b.lights;
  return w;
}

}  // namespace gonio::explain::tables::tests
