#include "sealed/recording.h"

#include "base/text.h"

namespace gonio::sealed {

std::string csv(const std::vector<Column>& columns) {
  std::string text;
  for (std::size_t c = 0; c < columns.size(); ++c) text += (c == 0 ? "" : ",") + columns[c].name;
  text += "\n";
  for (std::size_t r = 0; r < columns.at(0).values.size(); ++r) {
    for (std::size_t c = 0; c < columns.size(); ++c) text += format(c == 0 ? "%.9g" : ",%.9g", columns[c].values[r]);
    text += "\n";
  }
  return text;
}

Value table_section(const std::string& model, const std::vector<Column>& columns,
                    const std::vector<std::string>& observed, const std::vector<std::string>& sigma) {
  Value units = Value::object();
  for (const Column& c : columns) units[c.name] = c.unit;
  Value table = Value::object({{"file", "table"}, {"model", model}});
  table["columns"] = units;
  table["observed"] = observed;
  if (!sigma.empty()) table["sigma"] = sigma;
  return table;
}

Value pose(const std::vector<double>& r, double x, double y, double z) {
  const auto row = [](double a, double b, double c, double d) { return Value(std::vector<double>{a, b, c, d}); };
  Value matrix = Value::array();
  matrix.push_back(row(r[0], r[1], r[2], x));
  matrix.push_back(row(r[3], r[4], r[5], y));
  matrix.push_back(row(r[6], r[7], r[8], z));
  matrix.push_back(row(0, 0, 0, 1));
  return Value::object({{"matrix", matrix}});
}

void finish(Value manifest, Case& into) {
  Value whole = Value::object({{"gonio", 1}});
  if (!into.files.empty()) {
    Value files = Value::object();
    for (const auto& [name, bytes] : into.files)
      files[name.substr(0, name.find('.'))] =
          Value::object({{"path", name}, {"bytes", static_cast<std::uint64_t>(bytes.size())}});
    whole["files"] = files;
  }
  for (auto& [key, value] : manifest.as_object()) whole[key] = value;
  into.files["recording.json"] = print_json(whole) + "\n";
}

Value free_parameter(double start) {
  return Value::object({{"value", start}, {"free", true}});
}

}  // namespace gonio::sealed
