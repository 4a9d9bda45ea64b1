// What the cases of exchange change in a manifest.
#include "exchange_cases.h"

#include <vector>

#include "manifest/document.h"
#include "manifest/image_list.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/light.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"

namespace gonio::scene {

void Letter::enlarge_without_balls() {
  document.objects.resize(document.objects.size() - 2);
  for (auto& [name, camera] : document.cameras) {
    camera.width_px *= 3;
    camera.height_px *= 3;
    for (manifest::Parameter* p : {&camera.fx_px, &camera.fy_px, &camera.px_per_m})
      if (p->given()) p->value[0] *= 3;
    for (manifest::Parameter* p : {&camera.cx_px, &camera.cy_px}) p->value[0] = 3 * (p->value[0] + 0.5) - 0.5;
  }
  scene = build_scene(document);
}

void bend_lens(manifest::Document& document) {
  document.cameras["c"].model = "radial-tangential";
  document.cameras["c"].distortion["k1"] = -0.2;
}

void light_image(manifest::Document& document, const std::string& id, const std::vector<std::string>& lamps) {
  manifest::ImageEntry& image = document.images.at(manifest::index_of_image(document, id).value());
  image.light = lamps;
  image.gain.reset();
}

manifest::Document every_look(const Letter& letter) {
  manifest::Document document = letter.document;
  document.surfaces["glass"] = {"dielectric", {{"eta", 1.5}, {"sigma_a_per_m", std::vector<double>{1, 2, 3}}}};
  document.surfaces["cloud"] = {"beckmann-dielectric",
                                {{"eta", 1.33},
                                 {"alpha", 0.2},
                                 {"anisotropy", 0.5},
                                 {"sigma_s_per_m", std::vector<double>{10, 20, 40}},
                                 {"g", 0.4}}};
  document.surfaces["copper"] = {
      "conductor",
      {{"eta", std::vector<double>{0.2, 0.9, 1.1}}, {"k", std::vector<double>{3.9, 2.4, 2.2}}, {"alpha", 0.1}}};
  document.surfaces["varnish"] = {"interfaced-diffuse", {{"albedo", 0.4}, {"eta", 1.5}, {"alpha", 0.1}}};
  document.surfaces["lacquer"] = {"rough-coat", {{"eta", 1.5}, {"alpha", 0.05}}};
  document.surfaces["lacquer"].base = "copper";
  document.surfaces["coated wood \"&<'"] = {"rough-coat", {{"eta", 1.5}, {"alpha", 0.05}}};
  document.surfaces["coated wood \"&<'"].base = "wood";
  for (const auto& [name, surface] : document.surfaces) {
    document.objects.push_back({"ball of " + name, "ball", name});
    document.objects.back().world_from_object.emplace().translation_m = {0, 0,
                                                                         1.0 + 0.2 * double(document.objects.size())};
  }
  const manifest::Parameter at(std::vector<double>{0.1, -0.3, 0.9}), down(std::vector<double>{0.1, 0.3, -1}), one(1.0);
  document.lights["disc"] = {"disc",
                             {{"position_m", at}, {"direction", down}, {"watt_per_sr", one}, {"radius_m", 0.1}}};
  document.lights["panel"] = {
      "rectangle",
      {{"position_m", at}, {"direction", down}, {"width_m", 0.3}, {"height_m", 0.1}, {"watt_per_sr", one}}};
  document.lights["stage"] = {
      "spot",
      {{"position_m", at}, {"direction", down}, {"watt_per_sr", one}, {"outer_rad", 0.5}, {"inner_share", 0.6}}};
  document.images[0].light = {"lamp", "ball", "disc", "panel", "stage", "sun", "grey"};
  return document;
}

}  // namespace gonio::scene
