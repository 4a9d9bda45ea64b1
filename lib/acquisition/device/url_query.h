// What the drivers read from a URL's query: words, whole numbers and quantities with their unit, each with a preset and
// limits. Error(usage) at `place` for what is none of these, and for keys that the driver does not know.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/device/devices.h"
#include "base/quantity.h"

namespace gonio::acquisition {

class UrlQuery {
 public:
  UrlQuery(const Url& url, const std::string& place) : url_(url), place_(place) {}

  std::string text(const std::string& key, const std::string& preset = {});
  std::string required(const std::string& key, const std::string& meaning);  // Error where it is missing or empty
  int integer(const std::string& key, int preset, int lower, int upper);
  double quantity(const std::string& key, Dimension dimension, double preset, double lower, double upper);
  bool flag(const std::string& key, bool preset);               // yes | no
  std::optional<int> port(const std::string& key, int preset);  // nothing for "none"
  double timeout(double preset_s = 2) { return quantity("timeout", Dimension::time, preset_s, 1e-3, 3600); }
  void end() const;  // Error for a key that nobody asked for; lists those that were asked for

  // "/coil/3": the number after the word. Error where the path is another one.
  int path_number(std::string_view word, int upper) const;

 private:
  const std::string* find(const std::string& key);
  [[noreturn]] void refuse(const std::string& problem, const std::string& remedy) const;
  const Url& url_;
  std::string place_, known_;
};

}  // namespace gonio::acquisition
