// What mechanisms do to scenes where no parameter of a registered model says it. A mechanism that needs words of its
// own is one file, scene/edits/<id with _>.cpp, which defines `const Edit& <id with _>()` in namespace
// gonio::scene::edits; the build gathers them. Edits are called with amounts that are not all neutral.
#pragma once
#include <span>
#include <string>

#include "mechanism/mechanism.h"
#include "scene/amounts.h"
#include "scene/scene.h"

namespace gonio::scene {

struct Moment {                   // of an image that states its time
  double since_s = 0, along = 0;  // since the first image; that over the time to the last one
};

struct Edit {
  const mechanism::Mechanism& (*mechanism)() = nullptr;
  // Those of what it changes. Lights and surfaces: where it `fits` one; they are refreshed afterwards.
  void (*appearance)(Appearance&, const Amounts&, Vec3 centre_m, const std::string& place) = nullptr;
  bool (*fits_light)(const Light&) = nullptr;
  void (*light)(Light&, const Amounts&, Vec3 centre_m, const std::string& place) = nullptr;
  // A light that is on wherever this one is: it is called after the mechanism and the light, with a blank between.
  Light (*companion)(const Light&, const Amounts&, const std::string& place) = nullptr;
  bool (*fits_surface)(const Surface&) = nullptr;
  void (*surface)(Surface&, const Amounts&) = nullptr;
  void (*instance)(Instance&, std::span<const double>) = nullptr;
  bool (*fits_instance)(const Instance&) = nullptr;  // those that are meant where none is named; none: all but planes
  void (*view)(View&, const Amounts&) = nullptr;
  bool rays = false;                                      // `view` changes where things are seen
  Rgb (*lamps)(const Amounts&, const Moment&) = nullptr;  // factor on all lamps
  double (*picture)(const Amounts&) = nullptr;            // factor on the pictures that the use is `on`
  // explain simulates it and a path tracer of this kind does not: the scene stays as it is.
  bool beyond_rendering = false;
};

std::span<const Edit* const> all_edits();  // sorted by name; defined in a generated source
const Edit* find_edit(const mechanism::Mechanism& mechanism);

}  // namespace gonio::scene
