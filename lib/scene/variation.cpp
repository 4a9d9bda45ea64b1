#include "scene/variation.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>

#include "base/error.h"
#include "manifest/sections/surface.h"
#include "surface/law.h"
#include "surface/subsurface.h"

namespace gonio::scene {
namespace {

using manifest::ParameterInfo;

const ParameterInfo& parameter_of(const surface::Model& model, const std::string& name, const std::string& place) {
  for (const ParameterInfo& info : model.info().parameters)
    if (info.name == name) return info;
  throw Error(Exit::data, place, "model \"" + model.info().id + "\" has no such parameter",
              "let one of its parameters vary");
}

// The names under which a file may hold three components, and one for all.
std::array<std::string, 4> spellings(const std::string& name) {
  if (name == "rgb") return {"red", "green", "blue", name};
  return {name + "_r", name + "_g", name + "_b", name};
}

std::size_t number_of(const Wish& wish, const std::string& name) {
  const auto& all = wish.ply.properties;
  return static_cast<std::size_t>(std::find(all.begin(), all.end(), name) - all.begin());
}

std::string digits(double v) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), v, std::chars_format::general, 6).ptr};
}

const mesh::Mesh& mesh_of(const mesh::Mesh* mesh, const std::string& what, const std::string& place) {
  if (!mesh)
    throw Error(Exit::data, place, "its surface varies by " + what + ", which spheres and planes do not have",
                "use a mesh");
  return *mesh;
}

class PerVertex final : public Rule {
 public:
  PerVertex(const Wish& wish, const ParameterInfo& info, std::string name)
      : colour_(info.components == 3), name_(std::move(name)) {
    const auto names = spellings(name_);
    for (std::size_t i = 0; i < 4; ++i) places_[i] = number_of(wish, names[i]);
  }

  Rgb at(const Place& here) const override {
    const mesh::Mesh& mesh = *here.mesh;
    const bool three = colour_ && has_three(mesh);
    const double x = interpolated(mesh, places_[three ? 0 : 3], here);
    if (!three) return {x, x, x};
    return {x, interpolated(mesh, places_[1], here), interpolated(mesh, places_[2], here)};
  }

  void fits(const mesh::Mesh* given, const ParameterInfo& info, const std::string& place) const override {
    const mesh::Mesh& mesh = mesh_of(given, "properties of vertices", place);
    const bool three = colour_ && has_three(mesh);
    const auto names = spellings(name_);
    if (!three && !has(mesh, 3))
      throw Error(Exit::data, place,
                  "the mesh's vertices have no property \"" + name_ + "\"" +
                      (colour_ ? " (nor " + names[0] + ", " + names[1] + ", " + names[2] + ")" : ""),
                  "export the mesh with it, or give one value for " + info.name);
    for (std::size_t i = three ? 0 : 3; i < (three ? 3u : 4u); ++i) check_bounds(mesh, i, names[i], info, place);
  }

 private:
  bool has(const mesh::Mesh& mesh, std::size_t i) const {
    return places_[i] < mesh.properties.size() && !mesh.properties[places_[i]].empty();
  }
  bool has_three(const mesh::Mesh& mesh) const { return has(mesh, 0) && has(mesh, 1) && has(mesh, 2); }

  static double interpolated(const mesh::Mesh& mesh, std::size_t property, const Place& here) {
    const auto& values = mesh.properties[property];
    const auto& t = mesh.triangles[here.triangle];
    const double a = values[t[0]], b = values[t[1]], c = values[t[2]];
    return a + (b - a) * here.b1 + (c - a) * here.b2;
  }

  void check_bounds(const mesh::Mesh& mesh, std::size_t i, const std::string& name, const ParameterInfo& info,
                    const std::string& place) const {
    const auto& values = mesh.properties[places_[i]];
    for (std::size_t v = 0; v < values.size(); ++v)
      if (const double x = values[v]; !(x >= info.lower && x <= info.upper))
        throw Error(Exit::data, place,
                    name + " of vertex " + std::to_string(v) + " is " + digits(x) + ", outside " + digits(info.lower) +
                        " to " + digits(info.upper),
                    info.name + ": " + info.meaning);
  }

  bool colour_;
  std::string name_;
  std::array<std::size_t, 4> places_{};
};

class PerLabel final : public Rule {
 public:
  PerLabel(const std::map<std::string, manifest::Parameter>& entries, const ParameterInfo& info,
           const std::string& place) {
    for (const auto& [label, value] : entries) {
      const std::string here = place + "/" + label;
      std::int32_t number = 0;
      const auto* end = label.data() + label.size();
      const auto parsed = std::from_chars(label.data(), end, number);
      if (parsed.ec != std::errc() || parsed.ptr != end)
        throw Error(Exit::data, here, "label \"" + label + "\" is no integer", "labels of PLY files are integers");
      // The registry's own checks of counts and bounds, for this one parameter.
      const manifest::ModelInfo alone{
          .family = manifest::Family::surface, .id = info.name, .sentence = {}, .source = {}, .parameters = {info}};
      values_.emplace_back(number, manifest::values_of(alone, {{info.name, value}}, here).front());
    }
    std::sort(values_.begin(), values_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 1; i < values_.size(); ++i)
      if (values_[i].first == values_[i - 1].first)
        throw Error(Exit::data, place, "label " + std::to_string(values_[i].first) + " is there twice");
  }

  Rgb at(const Place& here) const override { return find(here.mesh->labels[here.triangle])->second; }

  void fits(const mesh::Mesh* given, const ParameterInfo& info, const std::string& place) const override {
    const mesh::Mesh& mesh = mesh_of(given, "labels of faces", place);
    if (mesh.labels.empty())
      throw Error(Exit::data, place, "the mesh's faces have no property \"label\"",
                  "export the mesh with labels, or give one value for " + info.name);
    for (std::size_t t = 0; t < mesh.labels.size(); ++t)
      if (find(mesh.labels[t]) == values_.end())
        throw Error(Exit::data, place,
                    "label " + std::to_string(mesh.labels[t]) + " of triangle " + std::to_string(t) +
                        " has no value for " + info.name,
                    "add it to the surface's labels");
  }

 private:
  using Entry = std::pair<std::int32_t, Rgb>;
  std::vector<Entry>::const_iterator find(std::int32_t label) const {
    const auto found = std::lower_bound(values_.begin(), values_.end(), label,
                                        [](const Entry& e, std::int32_t wanted) { return e.first < wanted; });
    return found != values_.end() && found->first == label ? found : values_.end();
  }
  std::vector<Entry> values_;  // by label
};

class ByLaw final : public Rule {
 public:
  ByLaw(const manifest::LawUse& use, const ParameterInfo& info, const std::string& place)
      : law_(surface::find_law(use.law)), lower_(info.lower), upper_(info.upper) {
    if (!law_) throw Error(Exit::data, place + "/law", "no law \"" + use.law + "\"", "gonio-manifest(5) lists them");
    if (info.components != 1)
      throw Error(Exit::data, place, "laws govern single numbers, and " + info.name + " has three",
                  "use vertices, labels or a texture");
    for (const Vec3 amount : manifest::values_of(law_->info(), use.parameters, place)) amounts_.push_back(amount.x);
  }

  Rgb at(const Place& here) const override {
    const surface::LocalGeometry geometry{here.position_m, here.normal,
                                          law_->needs_curvature() ? curvature_per_m(here) : 0};
    const double x = std::clamp(law_->value(amounts_, geometry), lower_, upper_);
    return {x, x, x};
  }

  void fits(const mesh::Mesh*, const ParameterInfo&, const std::string&) const override {}

 private:
  static double curvature_per_m(const Place& here) {
    if (here.mesh) {
      const auto& values = here.mesh->mean_curvature_per_m;
      const auto& t = here.mesh->triangles[here.triangle];
      const double a = values[t[0]], b = values[t[1]], c = values[t[2]];
      return a + (b - a) * here.b1 + (c - a) * here.b2;
    }
    // Normals of a sphere about the origin point along the position, those of a plane through it across.
    const double distance = norm(here.position_m);
    return dot(here.position_m, here.normal) > 0.5 * distance ? -1 / distance : 0;
  }

  const surface::Law* law_;
  std::vector<double> amounts_;
  double lower_, upper_;
};

// What a surface says of the inside of its object.
std::vector<double> inside_of(const Surface& surface, surface::Values values) {
  std::vector<double> stated;
  const auto add = [&](const surface::Medium& medium) {
    for (const Rgb& v : {medium.eta, medium.sigma_a_per_m, medium.sigma_s_per_m, medium.g})
      stated.insert(stated.end(), {v.x, v.y, v.z});
  };
  if (surface.model->transmits())
    if (const auto medium = surface.model->interior(values)) add(*medium);
  if (!surface.model->subsurface(values)) return stated;
  const auto prepared = surface.model->prepare(values, surface.file, {});
  values.prepared = prepared.get();
  const surface::Subsurface* beneath = surface.model->subsurface(values);
  if (!beneath) return stated;
  stated.insert(stated.end(), {beneath->eta(), beneath->reach_m()});
  for (int band = 0; band < 3; ++band) stated.push_back(beneath->sample_distance(band, 0.5));
  if (const surface::StraightLight* straight = beneath->straight()) {
    add(straight->medium);
    stated.push_back(straight->single);
  }
  return stated;
}

}  // namespace

void extend(Wish& wish, const manifest::Surface& entry) {
  for (const auto& [parameter, name] : entry.vertices)
    for (const std::string& spelling : spellings(name))
      if (number_of(wish, spelling) == wish.ply.properties.size()) wish.ply.properties.push_back(spelling);
  wish.ply.labels = wish.ply.labels || !entry.labels.empty();
  for (const auto& [parameter, use] : entry.laws) {
    const surface::Law* law = surface::find_law(use.law);
    wish.curvature = wish.curvature || (law && law->needs_curvature());
  }
}

std::vector<Varying> rules_of(const manifest::Surface& entry, const surface::Model& model, const Wish& wish,
                              const std::string& place) {
  std::vector<Varying> rules;
  std::set<std::string> governed;
  for (const auto& [parameter, file] : entry.textures) governed.insert(parameter);
  for (const auto& [parameter, file] : entry.spectra) governed.insert(parameter);
  const auto add = [&](const std::string& kind, const std::string& parameter, const auto& make) {
    const std::string here = place + "/" + kind + "/" + parameter;
    const ParameterInfo& info = parameter_of(model, parameter, here);
    if (!governed.insert(parameter).second)
      throw Error(Exit::data, here, parameter + " varies in two ways", "keep one of them");
    rules.push_back({parameter, make(info, here)});
  };
  for (const auto& [parameter, name] : entry.vertices)
    add("vertices", parameter, [&, property = &name](const ParameterInfo& info, const std::string&) {
      return std::make_shared<const PerVertex>(wish, info, *property);
    });
  for (const auto& [parameter, values] : entry.labels)
    add("labels", parameter, [&, table = &values](const ParameterInfo& info, const std::string& here) {
      return std::make_shared<const PerLabel>(*table, info, here);
    });
  for (const auto& [parameter, use] : entry.laws)
    add("laws", parameter, [&, law = &use](const ParameterInfo& info, const std::string& here) {
      return std::make_shared<const ByLaw>(*law, info, here);
    });
  return rules;
}

void check_inside(const Surface& surface, const std::string& place) {
  const auto check = [&](std::size_t parameter) {
    const ParameterInfo& info = surface.model->info().parameters[parameter];
    surface::Values low = surface.values, high = surface.values;
    const double quarter = (info.upper - info.lower) / 4, a = info.lower + quarter, b = info.upper - quarter;
    low.v[parameter] = {a, a, a};
    high.v[parameter] = {b, b, b};
    if (inside_of(surface, low) != inside_of(surface, high))
      throw Error(Exit::data, place, info.name + " belongs to the inside of an object, which is the same everywhere",
                  "give one value, or make objects of its parts");
  };
  for (const Texture& texture : surface.textures) check(texture.parameter);
  for (const Varying& varying : surface.varying) check(varying.parameter);
}

void check_fit(const Surface& surface, const Shape& shape, const std::string& place) {
  const auto* mesh = std::get_if<std::shared_ptr<const mesh::Mesh>>(&shape);
  for (const Varying& varying : surface.varying)
    varying.rule->fits(mesh ? mesh->get() : nullptr, surface.model->info().parameters[varying.parameter], place);
}

}  // namespace gonio::scene
