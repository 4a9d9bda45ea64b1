// See reflectance_parameters.h.
#include "explain/tables/reflectance_parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

#include "base/error.h"
#include "explain/tables/model_parameters.h"
#include "explain/tables/reflectance_binding.h"
#include "manifest/document.h"
#include "manifest/reference.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/surface_fit.h"
#include "manifest/sections/table.h"
#include "scene/mechanisms.h"

namespace gonio::explain::tables {
namespace {

using Kind = ReflectanceSlot::Kind;

// A share that may be all there is, such as that of walls, is estimated from both sides of it: held at its bound it
// would have no sigma. What the manifest is given is cut to the bound.
constexpr double beyond_all = 0.25;

void set_component(Rgb& rgb, std::size_t k, double value) {
  (k == 0 ? rgb.x : k == 1 ? rgb.y : rgb.z) = value;
}

class Collector {
 public:
  Collector(const manifest::Document& document, const std::string& table_name, const Table& table,
            const ReflectanceRows& rows)
      : document_(document),
        name_(table_name),
        table_(table),
        section_(document.tables.at(table_name)),
        rows_(rows),
        gain_(model_parameter(section_, name_, "gain", "1", 1, false)) {}

  ReflectanceParameters run() {
    out_.surface = section_.surface;
    out_.place = table_.place;
    read_surface();
    base_parameters();
    gain();
    // Tables that a model has prepared hold for the values that it was given.
    if (!out_.base.empty() && out_.base_model->info().attachment == manifest::Attachment::none)
      for (surface::Values& v : out_.base_values) v.prepared = nullptr;
    const auto all = all_reflectance_bindings();
    std::vector<const ReflectanceBinding*> bindings(all.begin(), all.end());
    std::ranges::stable_sort(bindings, {}, &ReflectanceBinding::order);
    for (const ReflectanceBinding* binding : bindings)
      if (binding->kind == Kind::mechanism) rendered_mechanism(*binding);
    out_.full_model = scratch_.surfaces[0].model;
    const SurfacePlaces places(*out_.full_model);
    for (const ReflectanceBinding* binding : bindings)
      if (binding->kind != Kind::mechanism && binding->shows(rows_, places)) term(*binding);
    return std::move(out_);
  }

 private:
  void read_surface() {
    const auto found = document_.surfaces.find(section_.surface);
    const std::string place = manifest::place(document_, "/surfaces/" + section_.surface);
    if (found == document_.surfaces.end())
      throw Error(Exit::data, table_.place + "/surface", "names \"" + section_.surface + "\", which is not described",
                  "enter it in \"surfaces\": {\"model\": \"diffuse\", \"albedo\": 0.5}");
    scene::Surface surface;
    surface.id = section_.surface;
    surface.model = surface::find(found->second.model);
    if (surface.model == nullptr)
      throw Error(Exit::data, place, "has an unknown model \"" + found->second.model + "\"");
    if (surface.model->info().takes_base || surface.model->transmits() || surface.model->thin())
      throw Error(Exit::data, place,
                  "its model \"" + found->second.model + "\" lies on another surface or lets light through",
                  "explain tables of reflectance with another model, such as coated-diffuse");
    if (!found->second.file.empty()) surface.file = manifest::resolve(document_, found->second.file, place);
    surface.parameters = found->second.parameters;
    scene::refresh(surface, place);
    out_.base_model = surface.model;
    out_.prepared = surface.prepared;
    scratch_.surfaces = {surface};
  }

  // Values of the base surface in every band, and its free numbers: those marked free, else those that brdf-fit(1) has
  // fitted, else its colours.
  void base_parameters() {
    const surface::Values& values = scratch_.surfaces[0].values;
    const auto& infos = out_.base_model->info().parameters;
    const manifest::Parameters& given = document_.surfaces.at(section_.surface).parameters;
    const bool marked =
        gain_.free || std::any_of(given.begin(), given.end(), [](const auto& p) { return p.second.free; });
    const std::set<std::string> fitted = fitted_names();
    const std::size_t bands = rows_.band_name.size();
    out_.base_values.assign((bands + 2) / 3, values);
    for (std::size_t i = 0; i < infos.size(); ++i) {
      const auto parameter = given.find(infos[i].name);
      const bool free = marked            ? parameter != given.end() && parameter->second.free
                        : !fitted.empty() ? fitted.contains(infos[i].name)
                                          : infos[i].rgb;
      const manifest::Parameter stated = parameter != given.end() ? parameter->second : manifest::Parameter{};
      const manifest::Parameter* in_bands = fitted_bands(infos[i].name);
      for (std::size_t b = 0; b < bands && infos[i].components == 3; ++b) {
        const double value = in_bands != nullptr ? in_bands->value[b] : values.v[i][rows_.component(b)];
        set_component(out_.base_values[b / 3].v[i], b % 3, value);
        if (free) enter_base(infos[i], value, b, stated);
      }
      if (free && infos[i].components == 1) enter_base(infos[i], values.scalar(i), ReflectanceSlot::all, stated);
    }
  }
  std::set<std::string> fitted_names() const {
    std::set<std::string> names;
    const auto fit = document_.surface_fits.find(section_.surface);
    if (fit != document_.surface_fits.end() && fit->second.model == out_.base_model->info().id)
      for (const auto& [name, values] : fit->second.parameters) names.insert(name);
    return names;
  }
  void gain() {
    out_.gain = gain_.parameter.start;
    if (!(out_.gain > 0)) throw Error(Exit::data, table_.place + "/parameters/gain", "is not above 0");
    if (!gain_.free) return;
    gain_.parameter.lower = std::max(gain_.parameter.lower, 0.0);
    out_.base.push_back(add(gain_.parameter, {Kind::gain, "gain", ReflectanceSlot::all, 0, ""}));
  }
  // What an earlier explanation found per band.
  const manifest::Parameter* fitted_bands(const std::string& name) const {
    const auto found = section_.parameters.find(name);
    return found != section_.parameters.end() && found->second.value.size() == rows_.band_name.size() ? &found->second
                                                                                                      : nullptr;
  }
  void enter_base(const manifest::ParameterInfo& info, double value, std::size_t band,
                  const manifest::Parameter& given) {
    Parameter p;
    p.name = "surfaces/" + section_.surface + "/" + info.name;
    if (band != ReflectanceSlot::all && !rows_.band_name[band].empty()) p.name += "/" + rows_.band_name[band];
    p.unit = info.unit;
    p.start = p.neutral = value;
    p.lower = std::max(info.lower, given.min.value_or(info.lower));
    p.upper = std::min(info.upper, given.max.value_or(info.upper));
    p.size = std::max(0.1 * std::abs(value), 0.01 * std::min(1.0, info.upper - info.lower));
    p.prior_sigma = given.sigma;
    out_.base.push_back(add(std::move(p), {Kind::base, info.name, band, 0, ""}));
  }

  std::size_t add(Parameter parameter, ReflectanceSlot slot) {
    out_.parameters.push_back(std::move(parameter));
    out_.slots.push_back(std::move(slot));
    return out_.parameters.size() - 1;
  }

  Parameter of_mechanism(const mechanism::Mechanism& m, const mechanism::Parameter& info) const {
    Parameter p;
    p.name = m.id + "@" + section_.surface + "." + info.name;
    p.unit = info.unit;
    p.start = info.start, p.neutral = info.neutral, p.lower = info.lower, p.upper = info.upper;
    p.size = std::max({std::abs(info.start - info.neutral), 0.02 * (info.upper - info.lower), 1e-12});
    return p;
  }

  const manifest::MechanismUse* use_of(const mechanism::Mechanism& m) const {
    const auto found = document_.mechanisms.find(m.id);
    if (found == document_.mechanisms.end()) return nullptr;
    const std::vector<std::string>& on = found->second.on;
    return on.empty() || std::find(on.begin(), on.end(), section_.surface) != on.end() ? &found->second : nullptr;
  }

  // A mechanism that the manifest has switched on is part of the base model, and free; others are candidates.
  void enter(const mechanism::Mechanism& m, std::vector<std::pair<Parameter, ReflectanceSlot>> own,
             const std::string& family, bool finer = false) {
    const manifest::MechanismUse* use = use_of(m);
    Candidate candidate{&m, {section_.surface}, {}, family, finer};
    for (auto& [parameter, slot] : own) {
      if (use != nullptr) {
        const auto given = use->parameters.find(slot.name);
        if (given != use->parameters.end() && given->second.given())
          parameter.start = parameter.neutral = std::clamp(given->second.scalar(), parameter.lower, parameter.upper);
      }
      slot.mechanism = m.id;
      candidate.parameters.push_back(add(std::move(parameter), std::move(slot)));
    }
    if (use != nullptr)
      out_.base.insert(out_.base.end(), candidate.parameters.begin(), candidate.parameters.end());
    else
      out_.candidates.push_back(std::move(candidate));
  }

  void rendered_mechanism(const ReflectanceBinding& binding) {
    const mechanism::Mechanism& m = binding.mechanism();
    if (scene::mechanism_targets(scratch_, m).empty()) return;
    const std::optional<std::size_t> own = parameter_place(*out_.base_model, m.parameters[0].name);
    const auto stated = document_.surfaces.at(section_.surface).parameters.find(m.parameters[0].name);
    const bool fitted = stated != document_.surfaces.at(section_.surface).parameters.end() && stated->second.free;
    // The base model has it.
    if (own && (fitted || scratch_.surfaces[0].values.scalar(*own) != m.parameters[0].neutral)) return;
    manifest::MechanismUse start;
    // The signature vanishes where the base has no gloss; edits begin from where a search would.
    for (const mechanism::Parameter& info : m.parameters) start.parameters[info.name] = manifest::Parameter(info.start);
    const scene::Surface before = scratch_.surfaces[0];
    scene::apply_mechanism(scratch_, m, start, {}, out_.place);
    const surface::Model* model = scratch_.surfaces[0].model;
    scratch_.surfaces[0] = before;
    scratch_.surfaces[0].model = model;
    scene::refresh(scratch_.surfaces[0], out_.place);
    const std::span<const mechanism::Form> forms = mechanism::forms_of(m);
    if (forms.empty()) return enter_form(binding, nullptr, own);
    for (const mechanism::Form& form : forms)
      if (is_given_form(m, form)) enter_form(binding, &form, own);
  }
  // Of a mechanism that the manifest has switched on, the form that it says alone.
  bool is_given_form(const mechanism::Mechanism& m, const mechanism::Form& form) const {
    const manifest::MechanismUse* use = use_of(m);
    return use == nullptr || std::ranges::all_of(form.held, [&](const auto& held) {
             const auto given = use->parameters.find(held.first);
             const auto own = std::ranges::find(m.parameters, held.first, &mechanism::Parameter::name);
             return (given == use->parameters.end() ? own->neutral : given->second.scalar()) == held.second;
           });
  }
  void enter_form(const ReflectanceBinding& binding, const mechanism::Form* form,
                  const std::optional<std::size_t>& own) {
    const mechanism::Mechanism& m = binding.mechanism();
    std::vector<std::pair<Parameter, ReflectanceSlot>> parameters;
    for (const mechanism::Parameter& info : m.parameters) {
      if (form != nullptr && std::ranges::count(form->held, info.name, &std::pair<std::string, double>::first) > 0)
        continue;
      Parameter p = of_mechanism(m, info);
      if (info.name == "second_alpha") p.start = start_of_second_lobe(p);
      if (&info == &m.parameters[0] && own && out_.base_model->info().parameters[*own].upper == info.upper)
        p.upper += beyond_all * (info.upper - info.lower);
      // Numbers that shape a term do not switch it on; those that vanish with it do.
      const bool switches = parameters.empty() || binding.each_switches;
      parameters.push_back(
          {p, {Kind::mechanism, info.name, ReflectanceSlot::all, 0, "", switches, form, info.neutral}});
    }
    enter(m, std::move(parameters), form == nullptr ? "" : m.id, form != nullptr && form->finer);
  }
  // Away from the lobe that is there: three times broader, or narrower where that is broad already.
  double start_of_second_lobe(const Parameter& p) const {
    const std::optional<std::size_t> alpha = parameter_place(*out_.base_model, "alpha");
    if (!alpha) return p.start;
    const double own = scratch_.surfaces[0].values.scalar(*parameter_place(*scratch_.surfaces[0].model, "alpha"));
    return std::clamp(own < 0.3 ? 3 * own : own / 3, p.lower, p.upper);
  }

  // Alternatives of one family where there are several ranges.
  void term(const ReflectanceBinding& binding) {
    const mechanism::Mechanism& m = binding.mechanism();
    std::vector<Parameter> declared;
    for (const mechanism::Parameter& info : m.parameters) declared.push_back(of_mechanism(m, info));
    const std::vector<std::vector<Parameter>> ranges = binding.ranges(declared, use_of(m) != nullptr);
    for (const std::vector<Parameter>& range : ranges) {
      std::vector<std::pair<Parameter, ReflectanceSlot>> own;
      for (std::size_t k = 0; k < range.size(); ++k)
        own.push_back({range[k], {binding.kind, m.parameters[k].name, ReflectanceSlot::all, k, ""}});
      enter(m, std::move(own), binding.kind == Kind::fluorescence ? "" : m.id);
    }
  }

  const manifest::Document& document_;
  const std::string& name_;
  const Table& table_;
  const manifest::Table& section_;
  const ReflectanceRows& rows_;
  ModelParameter gain_;
  scene::Appearance scratch_;  // the surface alone: its model grows with every mechanism that it takes
  ReflectanceParameters out_;
};

}  // namespace

namespace {

// The base surface's values in the parameters of a larger model, whose own are at their presets.
surface::Values widened(const surface::Values& base, const surface::Model& from, const surface::Model& to) {
  surface::Values wide;
  const auto &old = from.info().parameters, &all = to.info().parameters;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double preset = all[i].preset.value_or(0);
    wide.v[i] = {preset, preset, preset};
  }
  for (std::size_t i = 0; i < old.size(); ++i) wide.v[*parameter_place(to, old[i].name)] = base.v[i];
  return wide;
}

}  // namespace

// Of the candidates of one family at most one is in play: the others' first number is zero.
ReflectanceState ReflectanceParameters::state(std::span<const double> values) const {
  ReflectanceState s;
  s.model = base_model;
  s.gain = gain;
  for (std::size_t p = 0; p < slots.size(); ++p)
    if (slots[p].kind == Kind::mechanism && slots[p].switches && values[p] != slots[p].neutral) s.model = full_model;
  s.triples = base_values;
  if (s.model != base_model)
    for (surface::Values& v : s.triples) v = widened(v, *base_model, *s.model);
  const auto set = [&s](const std::string& name, double value) {
    if (const std::optional<std::size_t> at = parameter_place(*s.model, name))
      for (surface::Values& v : s.triples) v.v[*at] = {value, value, value};
  };
  const mechanism::Form* acts = nullptr;  // of the mechanism whose numbers follow
  for (std::size_t p = 0; p < slots.size(); ++p) {
    const ReflectanceSlot& slot = slots[p];
    if (slot.form != nullptr) {
      if (slot.switches && values[p] != slot.neutral) {
        acts = slot.form;
        for (const auto& [name, value] : acts->held) set(name, value);
      }
      if (acts == slot.form) set(slot.name, values[p]);
      continue;
    }
    if (slot.kind == Kind::gain) s.gain = values[p];
    if (slot.kind == Kind::film && slot.which == 0 && values[p] > 0) s.film = {values[p], values[p + 1]};
    if (slot.kind == Kind::ridges && slot.which == 0 && values[p] > 0)
      s.ridges = {values[p], values[p + 1], values[p + 2]};
    if (slot.kind == Kind::fluorescence && slot.which == 0) s.fluorescence = {values[p], values[p + 1], values[p + 2]};
    if (slot.kind != Kind::base && slot.kind != Kind::mechanism) continue;
    const std::optional<std::size_t> at = parameter_place(*s.model, slot.name);
    if (!at) continue;
    if (slot.band != ReflectanceSlot::all)
      set_component(s.triples[slot.band / 3].v[*at], slot.band % 3, values[p]);
    else
      set(slot.name, values[p]);
  }
  return s;
}

ReflectanceParameters reflectance_parameters(const manifest::Document& document, const std::string& table_name,
                                             const Table& table, const ReflectanceRows& rows) {
  return Collector(document, table_name, table, rows).run();
}

}  // namespace gonio::explain::tables
