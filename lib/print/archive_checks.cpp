// See archive_checks.h.
#include "print/archive_checks.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/lower_case.h"
#include "base/text.h"

namespace gonio::print {
namespace {

constexpr double longest_m = 10, longest_s = 1e8;
constexpr std::int64_t widest_px = 65535, most_px = std::int64_t{1} << 28;
constexpr int most_bottom_layers = 1000000;

void check_amount(const std::optional<double>& value, double most, const char* what, const std::string& place,
                  bool may_be_zero = true) {
  if (!value || (*value <= most && (may_be_zero ? *value >= 0 : *value > 0))) return;
  refuse_archive(
      place, std::string("states ") + shortest_text(*value) + " as " + what,
      std::string("it is ") + (may_be_zero ? "from 0 on" : "above 0") + " and at most " + shortest_text(most));
}

// Digits at the end of "NAME123.png"; empty: none.
std::string_view number_of(std::string_view name) {
  if (name.size() < 4 || lower_case(std::string(name.substr(name.size() - 4))) != ".png") return {};
  name.remove_suffix(4);
  const std::size_t before = name.find_last_not_of("0123456789");
  return name.substr(before == std::string_view::npos ? 0 : before + 1);
}

struct Numbered {
  std::uint64_t number = 0;
  std::size_t at = 0;
};

}  // namespace

void refuse_archive(const std::string& place, const std::string& problem, const std::string& remedy) {
  throw Error(Exit::data, place, problem, remedy);
}

void check_pixels(std::int64_t width, std::int64_t height, const std::string& place) {
  if (width < 1 || height < 1 || width > widest_px || height > widest_px || width * height > most_px)
    refuse_archive(place, "has pictures of " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
                   "sides of 1 to " + std::to_string(widest_px) + " and at most " + std::to_string(most_px) +
                       " in all are read and written");
}

void check_job(const Job& job, const std::string& place) {
  check_pixels(job.width_px, job.height_px, place);
  if (job.pixel_m) {
    check_amount(job.pixel_m->x, longest_m, "the width of a pixel (m)", place, false);
    check_amount(job.pixel_m->y, longest_m, "the height of a pixel (m)", place, false);
  }
  check_amount(job.layer_m, longest_m, "the thickness of layers (m)", place, false);
  check_amount(job.exposure_s, longest_s, "the exposure (s)", place);
  check_amount(job.bottom_exposure_s, longest_s, "the exposure of bottom layers (s)", place);
  check_amount(job.bottom_layers, most_bottom_layers, "the number of bottom layers", place);
  check_amount(job.lift_m, longest_m, "the lift (m)", place);
  check_amount(job.lift_m_per_s, longest_m, "the speed of the lift (m/s)", place);
  check_amount(job.retract_m_per_s, longest_m, "the speed back (m/s)", place);
  check_amount(job.resin_kg_per_m3, 1e5, "the resin's density (kg/m^3)", place);
  check_amount(job.resin_m3, 1e3, "the resin's volume (m^3)", place);
  check_amount(job.printing_s, longest_s, "the time of printing (s)", place);
  for (const JobPreview& preview : job.previews) {
    check_pixels(preview.width_px, preview.height_px, place + "#preview");
    const auto pixels = static_cast<std::size_t>(preview.width_px) * static_cast<std::size_t>(preview.height_px);
    if (preview.rgb.size() != 3 * pixels)
      refuse_archive(place + "#preview", "has " + std::to_string(preview.rgb.size()) + " bytes",
                     "3 of each of its " + std::to_string(pixels) + " pixels belong there");
  }
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

double archive_number(std::string_view text, const std::string& key, const std::string& place) {
  double value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || end.ec != std::errc{} || end.ptr != text.data() + text.size() || !std::isfinite(value))
    refuse_archive(place, "states \"" + std::string(text.substr(0, 40)) + "\" as " + key, "a number belongs there");
  return value;
}

std::int64_t archive_count(std::string_view text, const std::string& key, const std::string& place) {
  const double value = archive_number(text, key, place);
  if (!(value >= 0 && value <= 1e9 && value == std::floor(value)))
    refuse_archive(place, "states \"" + std::string(text.substr(0, 40)) + "\" as " + key,
                   "a whole number from 0 on belongs there");
  return static_cast<std::int64_t>(value);
}

std::string archive_text(double value) {
  return format("%.12g", value);
}

std::vector<std::size_t> numbered_pictures(const std::vector<std::string>& names, const std::string& place) {
  std::vector<Numbered> found;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string_view digits = number_of(names[i]);
    if (digits.empty() || digits.size() > 9) continue;
    found.push_back({0, i});
    std::from_chars(digits.data(), digits.data() + digits.size(), found.back().number);
  }
  if (found.empty())
    refuse_archive(place, "has no picture of a layer: none is called NUMBER.png", "number them 0, 1, 2, ...");
  std::ranges::stable_sort(found, {}, &Numbered::number);
  const std::uint64_t first = found.front().number;
  std::vector<std::size_t> order;
  for (const Numbered& one : found) {
    const std::uint64_t expected = order.empty() ? std::min<std::uint64_t>(first, 1) : first + order.size();
    if (one.number < expected)
      refuse_archive(place,
                     "has two pictures with the number " + std::to_string(one.number) + ", " +
                         names[order.back()].substr(0, 60) + " and " + names[one.at].substr(0, 60),
                     "leave one of them");
    if (one.number > expected)
      refuse_archive(
          place,
          "has no picture with the number " + std::to_string(expected) + ", and one with " + std::to_string(one.number),
          "add the layer that is missing, or number them without a gap");
    order.push_back(one.at);
  }
  return order;
}

}  // namespace gonio::print
