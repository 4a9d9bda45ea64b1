#include "sealed/recording.h"

#include <algorithm>
#include <cmath>
#include <cstring>

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

std::string profile(int width, int height, double step_m, const Numbers& z) {
  std::string file(512, '\0');
  const auto put = [&]<class T>(std::size_t at, T value) { std::memcpy(&file[at], &value, sizeof value); };
  std::memcpy(file.data(), "DIGITAL SURF", 12);
  constexpr float unit_m = 1e-12f;
  constexpr std::int32_t lowest = -2000000000;
  const bool gaps = std::any_of(z.begin(), z.end(), [](double v) { return !std::isfinite(v); });
  for (const std::size_t place : {14, 16}) put(place, std::int16_t{1});
  put(18, std::int16_t{2}), put(86, static_cast<std::int16_t>(gaps)), put(98, std::int16_t{32});
  put(100, lowest), put(104, std::int32_t{2000000000});
  put(108, std::int32_t{width}), put(112, std::int32_t{height}), put(116, std::int32_t{width * height});
  put(120, static_cast<float>(step_m)), put(124, static_cast<float>(step_m)), put(128, unit_m);
  for (std::size_t place = 132; place < 276; place += 16) std::memcpy(&file[place], "m               ", 16);
  for (const double v : z) {
    const std::int32_t number =
        std::isfinite(v) ? static_cast<std::int32_t>(std::lround(v / static_cast<double>(unit_m))) : lowest - 2;
    file.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  return file;
}

}  // namespace gonio::sealed
