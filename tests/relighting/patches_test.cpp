// Patches of a pixel (relighting/light_cache.h): how many stand for a ball of some radius in pixels, and a narrow lobe
// through them against the mean over the pixel, taken here on the sphere's own equation.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "relighting/light_cache.h"
#include "render/ray_caster.h"
#include "scene/scene.h"
#include "surface/microfacet.h"

namespace gonio::relighting {
namespace {

constexpr double radius_m = 0.05;
constexpr int side = 256;
const Vec3 to_lamp = normalized(Vec3{0.3, -0.2, -1}), to_eye{0, 0, -1};

// An orthographic picture of a ball whose radius is `radius_px`.
struct Ball {
  double radius_px;
  manifest::Document document;
  scene::Scene scene;
  render::RayCaster caster;

  explicit Ball(double radius)
      : radius_px(radius),
        document(manifest::parse_document(R"({"gonio": 1, "cameras": {"c": {"model": "orthographic", "width_px": 256,
            "height_px": 256, "px_per_m": )" + std::to_string(radius / radius_m) +
                                              R"(, "cx_px": 127.5, "cy_px": 127.5}},
            "meshes": {"ball": {"sphere": {"radius_m": 0.05}}},
            "surfaces": {"clay": {"model": "diffuse", "albedo": 0.5}},
            "lights": {"sun": {"model": "directional", "towards": [0.3, -0.2, -1], "watt_per_m2": [1, 1, 1]}},
            "objects": [{"id": "ball", "mesh": "ball", "surface": "clay",
                         "world_from_object": {"rotation": [1, 0, 0, 0], "translation_m": [0, 0, 0.5]}}],
            "images": [{"id": "i", "camera": "c", "light": "sun"}]})",
                                          "ball.json", {})),
        scene(scene::build_scene(document)),
        caster(scene.instances) {}
  // `tilt`: distance from the ball's centre over its radius.
  ViewCache cache(double tilt) const {
    const View view{"c", camera::CameraModel(document.cameras.at("c"), "ball.json"), {}};
    const std::array<LightSource, 1> lamps{LightSource{.directional = true, .direction = to_lamp}};
    std::vector<std::array<int, 2>> chosen;
    for (int k = 0; k < 12; ++k) {
      const double phi = 2 * pi * k / 12;
      chosen.push_back({static_cast<int>(127.5 + tilt * radius_px * std::cos(phi)),
                        static_cast<int>(127.5 + tilt * radius_px * std::sin(phi))});
    }
    return build_cache(caster, view, lamps, render::Monomials(1, 1), chosen, {.paths = 0});
  }
  // Mean over the pixel of lobe times cosine.
  double mean_lobe(const Pixel& pixel, double alpha) const {
    constexpr int n = 40;
    double sum = 0;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double x = (pixel.x - 0.5 + (i + 0.5) / n - 127.5) / radius_px,
                     y = (pixel.y - 0.5 + (j + 0.5) / n - 127.5) / radius_px;
        sum += lobe({x, y, -std::sqrt(std::max(0.0, 1 - x * x - y * y))}, alpha);
      }
    return sum / (n * n);
  }
  static double lobe(Vec3 normal, double alpha) {
    const Basis basis(normal);
    const Vec3 wo = basis.to_local(to_eye), wi = basis.to_local(to_lamp);
    return wo.z > 0 && wi.z > 0 ? surface::Ggx(alpha).lobe(wo, wi, surface::half_vector(wo, wi)) * wi.z : 0;
  }
};

double by_patches(const ViewCache& cache, const Pixel& pixel, double alpha) {
  double sum = 0;
  const Facet& facet = cache.facets[pixel.first_facet];
  for (std::size_t p = facet.first_patch; p < facet.first_patch + facet.patches; ++p)
    sum += double{cache.patches[p].weight} * Ball::lobe(cache.patches[p].normal, alpha);
  return sum;
}

TEST(Patches, AsFewAsTheNormalsTurnWithinThePixelAllows) {
  for (const auto& [radius_px, patches] : {std::pair{400.0, 1u}, {108.0, 4u}, {40.0, 16u}}) {
    const ViewCache cache = Ball(radius_px).cache(0.2);
    for (const Pixel& pixel : cache.pixels) EXPECT_EQ(cache.facets[pixel.first_facet].patches, patches) << radius_px;
  }
}

TEST(Patches, StandForThePixelInANarrowLobe) {
  for (const double radius_px : {40.0, 108.0}) {
    const Ball ball(radius_px);
    for (const double tilt : {0.05, 0.18, 0.5}) {  // the lobe's centre lies at 0.17
      const ViewCache cache = ball.cache(tilt);
      double error = 0, size = 0;
      for (const Pixel& pixel : cache.pixels) {
        const double exact = ball.mean_lobe(pixel, 0.05);
        error += std::pow(by_patches(cache, pixel, 0.05) - exact, 2), size += exact * exact;
      }
      EXPECT_LT(std::sqrt(error / size), 0.02) << radius_px << " px at " << tilt;
      EXPECT_GT(size, 0);
    }
  }
}

}  // namespace
}  // namespace gonio::relighting
