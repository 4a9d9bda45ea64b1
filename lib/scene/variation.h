// How a surface's parameters vary over an object by other means than textures: per vertex, per face label, by a law.
//
// Per vertex ("vertices": {"alpha": "roughness"}): the property of that name of the PLY file's vertices, interpolated
// linearly over a triangle. A parameter of three components takes NAME_r, NAME_g and NAME_b; for the name "rgb" it
// takes red, green and blue; where the file has neither, NAME stands for all three. Per face label ("labels": {"alpha":
// {"0": 0.1, "7": 0.3}}): by the integer property `label` of the file's faces. By a law ("laws": {"alpha": {"law":
// "print-normal", ...}}): surface/law.h; the result is kept within the parameter's bounds.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/ply.h"
#include "manifest/model.h"
#include "scene/scene.h"

namespace gonio::scene {

// One parameter's rule. Immutable and shared between copies of a surface.
class Rule {
 public:
  virtual ~Rule() = default;
  virtual Rgb at(const Place& place) const = 0;  // of an object that fits() let through
  // Error(data) at `place` where the object's shape lacks what the rule needs, or has values outside the bounds of
  // `info`. Null: an analytic shape.
  virtual void fits(const mesh::Mesh* mesh, const manifest::ParameterInfo& info, const std::string& place) const = 0;
};

// What the surfaces of a scene want to know of meshes. Properties are numbered through for all of them.
struct Wish {
  io::PlyWish ply;
  bool curvature = false;
};
// Adds what `entry` wants to `wish`.
void extend(Wish& wish, const manifest::Surface& entry);

// The rules of a surface's entry; `wish` holds all that meshes are read with. Error(data) at `place`, the entry's.
std::vector<Varying> rules_of(const manifest::Surface& entry, const surface::Model& model, const Wish& wish,
                              const std::string& place);

// Where a shape cannot carry the surface: Error(data) at `place`, the object's.
void check_fit(const Surface& surface, const Shape& shape, const std::string& place);

// Parameters of what is inside an object - of its medium, or of light beneath its surface - hold for all of it. Error
// (data) at `place`, the surface's, where one of them varies.
void check_inside(const Surface& surface, const std::string& place);

}  // namespace gonio::scene
