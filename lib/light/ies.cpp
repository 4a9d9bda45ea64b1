#include "light/ies.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "light/number_file.h"

namespace gonio::light {
namespace {

constexpr std::size_t most_angles = 10000, most_values = 2000000;
constexpr double near_degrees = 1e-3;

bool near(double a, double b) {
  return std::abs(a - b) < near_degrees;
}

// Everything behind the line TILT=, number by number.
class Numbers {
 public:
  Numbers(const std::string& text, const std::string& place) : place_(place) {
    const auto lines = lines_of(text);
    const auto tilt =
        std::find_if(lines.begin(), lines.end(), [](const std::string& l) { return l.starts_with("TILT="); });
    if (tilt == lines.end()) fail("has no line TILT=", "give a file after IES LM-63");
    for (auto line = tilt + 1; line != lines.end(); ++line) split(*line);
    if (tilt->substr(5) == "INCLUDE") {
      next("lamp-to-luminaire geometry");
      skip(2 * count("number of tilt angles"));
    }
  }
  double next(const char* what) {
    if (at_ >= words_.size()) fail("ends before its " + std::string(what), "the file is cut short");
    const auto value = number_of(words_[at_++]);
    if (!value) fail("has \"" + words_[at_ - 1] + "\" where its " + what + " belongs", "repair the file");
    return *value;
  }
  std::size_t count(const char* what) {
    const double value = next(what);
    if (!(value >= 1 && value <= most_angles && value == std::floor(value)))
      fail("has the " + std::string(what) + " " + shortest_text(value), "1 to " + std::to_string(most_angles));
    return static_cast<std::size_t>(value);
  }
  std::vector<double> several(std::size_t n, const char* what) {
    if (n > words_.size() - at_)
      fail("promises " + std::to_string(n) + " " + what + " and holds " + std::to_string(words_.size() - at_) +
               " more numbers",
           "the file is cut short");
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(next(what));
    return values;
  }
  void skip(std::size_t n) { several(n, "tilt angles and factors"); }
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const {
    throw Error(Exit::data, place_, problem, remedy);
  }

 private:
  void split(const std::string& line) {
    for (std::size_t from = 0; from < line.size();) {
      const std::size_t to = std::min(line.find_first_of(" \t,", from), line.size());
      if (to > from) words_.push_back(line.substr(from, to - from));
      from = to + 1;
    }
  }
  const std::string& place_;
  std::vector<std::string> words_;
  std::size_t at_ = 0;
};

struct Photometry {  // degrees
  int type = 1;
  std::vector<double> vertical, horizontal;
  std::vector<std::vector<double>> candela;  // [horizontal][vertical]
};

void check_angles(const std::vector<double>& angles, const Numbers& numbers, const char* what) {
  for (std::size_t i = 1; i < angles.size(); ++i)
    if (!(angles[i] > angles[i - 1])) numbers.fail(std::string(what) + " angles do not ascend", "repair the file");
}

Photometry read(const std::string& text, const std::string& place) {
  Numbers numbers(text, place);
  Photometry lamp;
  numbers.next("number of lamps");
  numbers.next("lumens");
  numbers.next("multiplier");
  const std::size_t verticals = numbers.count("number of vertical angles");
  const std::size_t horizontals = numbers.count("number of horizontal angles");
  const double type = numbers.next("photometric type");
  if (type != 1 && type != 2 && type != 3) numbers.fail("has the photometric type " + shortest_text(type), "1, 2 or 3");
  lamp.type = static_cast<int>(type);
  numbers.several(4, "unit and sizes");
  numbers.several(3, "ballast factors and watts");
  if (verticals < 2 || verticals * horizontals > most_values)
    numbers.fail("has " + std::to_string(verticals) + " x " + std::to_string(horizontals) + " candela values",
                 "2 vertical angles or more, " + std::to_string(most_values) + " values or fewer");
  lamp.vertical = numbers.several(verticals, "vertical angles");
  lamp.horizontal = numbers.several(horizontals, "horizontal angles");
  check_angles(lamp.vertical, numbers, "vertical");
  check_angles(lamp.horizontal, numbers, "horizontal");
  for (std::size_t j = 0; j < horizontals; ++j) {
    lamp.candela.push_back(numbers.several(verticals, "candela values"));
    for (const double v : lamp.candela.back())
      if (v < 0) numbers.fail("has the negative intensity " + shortest_text(v), "repair the file");
  }
  return lamp;
}

// Appends the slices mirrored at the angle `at`, where the table ends.
void mirror_end(std::vector<double>& angles, std::vector<std::vector<double>>& slices, double at) {
  for (std::size_t j = angles.size(); j-- > 0;)
    if (!near(angles[j], at)) {
      angles.push_back(2 * at - angles[j]);
      slices.push_back(slices[j]);
    }
}
// The same at the beginning.
void mirror_start(std::vector<double>& angles, std::vector<std::vector<double>>& slices, double at) {
  std::vector<double> more;
  std::vector<std::vector<double>> copies;
  for (std::size_t j = angles.size(); j-- > 0;)
    if (!near(angles[j], at)) {
      more.push_back(2 * at - angles[j]);
      copies.push_back(slices[j]);
    }
  angles.insert(angles.begin(), more.begin(), more.end());
  slices.insert(slices.begin(), copies.begin(), copies.end());
}

std::vector<std::vector<double>> turned(const std::vector<std::vector<double>>& table) {
  std::vector<std::vector<double>> result(table[0].size(), std::vector<double>(table.size()));
  for (std::size_t j = 0; j < table.size(); ++j)
    for (std::size_t i = 0; i < table[j].size(); ++i) result[i][j] = table[j][i];
  return result;
}

void all_round(Photometry& lamp, const std::string& place) {  // type C
  auto& h = lamp.horizontal;
  const auto refuse = [&](const std::string& what) {
    throw Error(Exit::data, place, what + " " + shortest_text(h.front()) + " to " + shortest_text(h.back()),
                "type C: 0 to 0, 90, 180 or 360 degrees, or 90 to 270");
  };
  if (lamp.vertical.front() < -near_degrees || lamp.vertical.back() > 180 + near_degrees)
    throw Error(Exit::data, place, "has vertical angles beyond 0 to 180 degrees", "type C: from the aim");
  if (h.size() == 1) return;
  if (near(h.front(), 90) && near(h.back(), 270)) {
    mirror_start(h, lamp.candela, 90);  // now -90 to 270
    return;
  }
  if (!near(h.front(), 0)) refuse("has horizontal angles from");
  if (near(h.back(), 90)) mirror_end(h, lamp.candela, 90);
  if (near(h.back(), 180)) mirror_end(h, lamp.candela, 180);
  if (!near(h.back(), 360)) refuse("has horizontal angles from");
}

void both_sides(Photometry& lamp, const std::string& place) {  // types A and B
  if (near(lamp.horizontal.front(), 0)) mirror_start(lamp.horizontal, lamp.candela, 0);
  if (near(lamp.vertical.front(), 0)) {
    auto by_vertical = turned(lamp.candela);
    mirror_start(lamp.vertical, by_vertical, 0);
    lamp.candela = turned(by_vertical);
  }
  for (const auto* angles : {&lamp.horizontal, &lamp.vertical})
    if (angles->size() < 2 || angles->front() < -180 - near_degrees || angles->back() > 180 + near_degrees)
      throw Error(Exit::data, place, "has too few angles, or some beyond -180 to 180 degrees", "repair the file");
  const auto& latitude = lamp.type == 3 ? lamp.vertical : lamp.horizontal;
  if (latitude.front() < -90 - near_degrees || latitude.back() > 90 + near_degrees)
    throw Error(Exit::data, place, "has latitudes beyond -90 to 90 degrees", "repair the file");
}

std::vector<double> radians(const std::vector<double>& degrees, double low, double high) {
  std::vector<double> result;
  for (const double d : degrees) result.push_back(std::clamp(d * pi / 180, low, high));
  return result;
}

// Latitudes, ascending, become colatitudes, ascending.
void set_latitudes(SphericalGrid& grid, const std::vector<double>& latitude,
                   const std::vector<std::vector<double>>& by_longitude) {
  for (std::size_t i = latitude.size(); i-- > 0;)
    grid.colatitude_rad.push_back(std::clamp((90 - latitude[i]) * pi / 180, 0.0, pi));
  for (const auto& slice : by_longitude) grid.value.insert(grid.value.end(), slice.rbegin(), slice.rend());
}

}  // namespace

SphericalGrid ies_grid(const std::string& text, const std::string& place) {
  Photometry lamp = read(text, place);
  SphericalGrid grid;
  if (lamp.type == 1) {
    all_round(lamp, place);
    grid.colatitude_rad = radians(lamp.vertical, 0, pi);
    grid.longitude_rad = radians(lamp.horizontal, -pi, 2 * pi);
    for (const auto& slice : lamp.candela) grid.value.insert(grid.value.end(), slice.begin(), slice.end());
    grid.zero = {0, 1, 0};
    grid.quarter = {1, 0, 0};
  } else {
    both_sides(lamp, place);
    grid.zero = {0, 0, 1};
    grid.longitude_rad = radians(lamp.type == 3 ? lamp.horizontal : lamp.vertical, -pi, pi);
    grid.pole = lamp.type == 3 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
    grid.quarter = lamp.type == 3 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    if (lamp.type == 3)
      set_latitudes(grid, lamp.vertical, lamp.candela);
    else
      set_latitudes(grid, lamp.horizontal, turned(lamp.candela));
  }
  const double brightest = *std::max_element(grid.value.begin(), grid.value.end());
  if (!(brightest > 0)) throw Error(Exit::data, place, "shines nowhere", "give a lamp that is on");
  for (double& v : grid.value) v /= brightest;
  return grid;
}

}  // namespace gonio::light
