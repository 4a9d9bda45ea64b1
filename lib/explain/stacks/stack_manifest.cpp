// See stack_manifest.h.
#include "explain/stacks/stack_manifest.h"

#include <algorithm>
#include <limits>

#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mechanism_use.h"
#include "photograph/response.h"

namespace gonio::explain::stacks {
namespace {

constexpr int table_rows = 128;

// [[code, light], ...] over the codes that the stack holds. An offset is one of readings.
manifest::Value response_table(const Stack& stack, const photograph::Response& stated, const render::Response& response,
                               double offset) {
  const double top = stack.integer ? 1 : stack.full_scale;
  manifest::Value table = manifest::Value::array();
  double last = -std::numeric_limits<double>::infinity();
  for (int i = 0; i <= table_rows; ++i) {
    const double code = top * i / table_rows;
    const double linear =
        stack.stated.empty() ? std::max(0.0, stated.linear_of(code) - offset) : stated.linear_of(code - offset);
    const double light = response.light(linear);
    if (!(light > last)) continue;  // codes below the offset
    table.push_back(std::vector<double>{code, light});
    last = light;
  }
  return table;
}

}  // namespace

bool is_given(const manifest::Document& document, const std::string& id, const std::string& target) {
  const auto use = document.mechanisms.find(id);
  if (use == document.mechanisms.end()) return false;
  const std::vector<std::string>& on = use->second.on;
  return on.empty() || std::find(on.begin(), on.end(), target) != on.end();
}

std::optional<double> given_value(const manifest::Document& document, const std::string& id, const std::string& name,
                                  const std::string& target) {
  if (!is_given(document, id, target)) return {};
  const manifest::MechanismUse& use = document.mechanisms.at(id);
  const auto parameter = use.parameters.find(name);
  if (parameter == use.parameters.end() || !parameter->second.given()) return {};
  const std::vector<double>& value = parameter->second.value;
  const auto place = std::find(use.on.begin(), use.on.end(), target) - use.on.begin();
  return value.size() == 1 ? value[0] : value.at(static_cast<std::size_t>(place));
}

Parameter declared(const manifest::Document& document, const std::string& id, const std::string& name,
                   const std::string& full_name, const std::string& target, double size) {
  Parameter p;
  p.name = full_name;
  p.size = size;
  const mechanism::Mechanism* m = mechanism::find_mechanism(id);
  if (m == nullptr) return p;
  for (const mechanism::Parameter& known : m->parameters) {
    if (known.name != name) continue;
    p.unit = known.unit;
    p.neutral = given_value(document, id, name, target).value_or(known.neutral);
    p.start = known.start;
    p.lower = known.lower;
    p.upper = known.upper;
  }
  return p;
}

void state_responses(const Stack& stack, std::span<const render::Response> by_channel, double offset,
                     manifest::Document& document) {
  for (const StackImage& image : stack.images) {
    manifest::ImageEntry& entry = document.images[image.entry];
    const std::string at = "/images/" + std::to_string(image.entry) + "/response";
    manifest::Value tables = manifest::Value::object();
    for (std::size_t c = 0; c < stack.channels.size(); ++c) {
      const photograph::Response stated(photograph::response_of_channel(entry.response, stack.channels[c], at), at);
      manifest::Value table = response_table(stack, stated, by_channel[c], offset);
      if (stack.channels.size() == 1)
        tables = std::move(table);
      else
        tables[stack.channels[c]] = std::move(table);
    }
    entry.response = std::move(tables);
  }
}

void switch_on(const Candidate& candidate, const std::vector<std::string>& on, const Explanation& e,
               manifest::Document& document) {
  const std::vector<mechanism::Parameter>& infos = candidate.mechanism->parameters;
  manifest::MechanismUse& use = document.mechanisms[candidate.id()];
  use = {};
  use.on = on;
  const std::size_t targets = std::max<std::size_t>(1, candidate.parameters.size() / infos.size());
  const std::size_t each = candidate.parameters.size() / targets;
  for (std::size_t k = 0; k < each; ++k) {
    std::vector<double> value, sigma;
    for (std::size_t t = 0; t < targets; ++t) {
      value.push_back(e.values[candidate.parameters[t * each + k]]);
      sigma.push_back(e.sigma[candidate.parameters[t * each + k]]);
    }
    use.parameters[infos[k].name] = manifest::Parameter(value);
    use.sigma[infos[k].name] = sigma;
  }
}

bool is_named(const Problem& problem, const Explanation& e, const std::string& id) {
  return std::any_of(e.named.begin(), e.named.end(), [&](std::size_t c) { return problem.candidates()[c].id() == id; });
}

}  // namespace gonio::explain::stacks
