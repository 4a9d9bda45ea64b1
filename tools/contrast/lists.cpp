// See lists.h.
#include "tools/contrast/lists.h"

#include <algorithm>

#include "base/assignment.h"
#include "base/error.h"
#include "contrast/predict/specimen.h"

namespace gonio::tools::contrast {

using namespace gonio::contrast;

namespace {

Dimension dimension_of(const manifest::ParameterInfo& info) {
  return info.unit == "rad" ? Dimension::angle : info.unit == "m" ? Dimension::length : Dimension::none;
}

}  // namespace

std::vector<double> quantities(const std::string& text, Dimension dimension, const std::string& option) {
  std::vector<double> all;
  for (const std::string& piece : pieces(text, ',')) {
    if (piece.empty())
      throw Error(Exit::usage, option, "has an empty place in \"" + text + "\"", "separate values by single commas");
    all.push_back(parse_quantity(piece, dimension, option));
  }
  return all;
}

std::vector<std::pair<double, double>> angle_pairs(const std::string& text, const std::string& option) {
  std::vector<std::pair<double, double>> all;
  for (const std::string& piece : pieces(text, ',')) {
    const auto ends = pieces(piece, ':');
    if (ends.size() != 2)
      throw Error(Exit::usage, option, "\"" + piece + "\" is no pair of rotations", "write them as 0deg:90deg");
    all.emplace_back(parse_quantity(ends[0], Dimension::angle, option),
                     parse_quantity(ends[1], Dimension::angle, option));
  }
  return all;
}

std::vector<Assignment> assignments(const std::vector<std::string>& texts, const std::string& option,
                                    const manifest::ModelInfo& model, char separator) {
  std::vector<Assignment> all;
  for (const std::string& text : texts) {
    const auto [name, list] =
        parse_assignment(text, option, "for example " + option + " " + model.parameters.front().name + "=...");
    Assignment a{name, {}};
    const manifest::ParameterInfo& info = parameter_named(model, a.parameter, option);
    for (const std::string& piece : pieces(list, separator))
      a.values.push_back(parse_quantity(piece, dimension_of(info), option + " " + a.parameter));
    if (separator == ':' && a.values.size() != 2)
      throw Error(Exit::usage, option + " " + a.parameter, "\"" + text + "\" is no range", "write it as LOW:HIGH");
    all.push_back(std::move(a));
  }
  return all;
}

const manifest::ModelInfo& model_named(const std::string& id) {
  if (const manifest::ModelInfo* model = manifest::find_model(manifest::Family::surface, id)) return *model;
  std::string known;
  for (const manifest::ModelInfo* m : manifest::models(manifest::Family::surface))
    known += (known.empty() ? "" : ", ") + m->id;
  throw Error(Exit::usage, "--model", "\"" + id + "\" is no surface model", "choose one of " + known);
}

}  // namespace gonio::tools::contrast
