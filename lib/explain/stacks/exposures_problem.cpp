// See exposures_problem.h.
#include "explain/stacks/exposures_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "explain/stacks/moved_outcome.h"
#include "explain/stacks/odd_pictures.h"
#include "manifest/document.h"
#include "render/mechanisms/sensor_blooming.h"
#include "stats/intervals.h"

namespace gonio::mechanism {
const Mechanism& scene_moved();
const Mechanism& sensor_hot_pixel();
}  // namespace gonio::mechanism

namespace gonio::explain::stacks {
namespace {

constexpr double best_shown = 0.35;  // of full scale
constexpr double none = std::numeric_limits<double>::quiet_NaN();

// Radiance of a site by weighted least squares under the base model.
double linear_radiance(const Stack& stack, const ReadingNoise& noise, const Site& site) {
  double top = 0, bottom = 0;
  for (const std::size_t g : site.seen) {
    const StackImage& image = stack.images[g];
    const double y = image.picture.at(site.x, site.y, site.channel), t = image.exposure_s * image.gain;
    const double error = noise.sigma(g, y);
    const double sigma =
        0.5 * (stack.linear(site.channel, y + error) - stack.linear(site.channel, std::max(0.0, y - error)));
    const double weight = 1 / (sigma * sigma + 1e-30);
    top += stack.linear(site.channel, y) * t * weight;
    bottom += t * t * weight;
  }
  return bottom > 0 ? top / bottom : 0;
}

// Mean over the picture of the readings that count, in readings per second, per channel.
std::array<double, 3> mean_radiance(const Stack& stack) {
  std::array<double, 3> top{}, bottom{};
  for (const StackImage& image : stack.images)
    for (std::size_t i = 0; i < image.counts.size(); ++i) {
      if (!image.counts[i]) continue;
      const std::size_t c = i % stack.channels.size();
      top[c] += stack.linear(static_cast<int>(c), image.picture.data[i]);
      bottom[c] += image.exposure_s * image.gain;
    }
  for (std::size_t c = 0; c < 3; ++c) top[c] = bottom[c] > 0 ? top[c] / bottom[c] : 0;
  return top;
}

std::vector<Taken> taken(const Stack& stack) {
  double first = std::numeric_limits<double>::infinity();
  for (const StackImage& image : stack.images) first = std::min(first, image.time_s.value_or(first));
  std::vector<Taken> all;
  for (const StackImage& image : stack.images)
    all.push_back({image.exposure_s, image.gain, image.time_s ? *image.time_s - first : 0, all.size(), image.f_number});
  return all;
}

bool is_tested_apart(const std::string& id) {
  return id == mechanism::scene_moved().id || id == mechanism::sensor_blooming().id ||
         id == mechanism::sensor_hot_pixel().id;
}

double mean_reading(const StackImage& image) {
  double sum = 0;
  for (const float v : image.picture.data) sum += v;
  return sum / static_cast<double>(image.picture.data.size());
}

}  // namespace

ExposuresProblem::ExposuresProblem(const manifest::Document& document, Stack stack, const SiteOptions& options)
    : stack_(std::move(stack)), noise_(stack_), taken_(taken(stack_)), mean_radiance_(mean_radiance(stack_)) {
  const std::string place = manifest::place(document, "/images/" + std::to_string(stack_.images[0].entry));
  leave_out_stated(document, stack_);
  if (!document.mechanisms.contains(mechanism::scene_moved().id)) moved_ = find_moved(stack_, noise_);
  leave_out(moved_, stack_);
  if (!document.mechanisms.contains(mechanism::sensor_blooming().id)) overflow_ = find_overflow(stack_, noise_);
  if (!document.mechanisms.contains(mechanism::sensor_hot_pixel().id)) hot_ = find_hot_pixels(stack_, noise_);
  sites_ = choose_sites(stack_, noise_, options, place);
  add_radiances();
  add_rows();
  add_mechanisms(document);
  add_conditions();
}

void ExposuresProblem::add_radiances() {
  for (const Site& site : sites_) {
    const auto away = [&](std::size_t g) {
      const double share = stack_.images[g].picture.at(site.x, site.y, site.channel) / stack_.full_scale;
      return std::abs(std::log(std::max(share, 1e-6) / best_shown));
    };
    const std::size_t image = *std::min_element(site.seen.begin(), site.seen.end(),
                                                [&](std::size_t a, std::size_t b) { return away(a) < away(b); });
    shown_in_.push_back(image);
    Parameter p;
    p.name = "radiance/" + std::to_string(site.x) + "," + std::to_string(site.y) + "." +
             stack_.channels[static_cast<std::size_t>(site.channel)];
    p.unit = "1";
    const double start = stack_.reading(
        site.channel, linear_radiance(stack_, noise_, site) * taken_[image].exposure_s * taken_[image].gain);
    p.size = std::max(noise_.sigma(image, start), 0.01 * std::abs(start));
    p.start = p.neutral = std::max(start, 0.1 * p.size);
    p.lower = 0;
    p.upper = 100 * stack_.full_scale;
    p.groups = site.seen;
    base_.push_back(parameters_.size());
    parameters_.push_back(std::move(p));
  }
}

double ExposuresProblem::radiance(const ReadingChain& chain, std::span<const double> values, std::size_t site) const {
  return chain.radiance(values[base_[site]], sites_[site].channel, taken_at(shown_in_[site], site));
}

Taken ExposuresProblem::taken_at(std::size_t image, std::size_t site) const {
  return taken_[image].at(stack_, sites_[site].x, sites_[site].y);
}

void ExposuresProblem::add_rows() {
  Observations& o = observations_;
  rows_.resize(stack_.images.size());
  std::uint32_t tiles = 0;
  for (const Site& site : sites_) tiles = std::max(tiles, site.tile + 1);
  o.first.push_back(0);
  for (std::size_t g = 0; g < rows_.size(); ++g) {
    for (std::size_t s = 0; s < sites_.size(); ++s) {
      const Site& site = sites_[s];
      if (!std::binary_search(site.seen.begin(), site.seen.end(), g)) continue;
      const double y = stack_.images[g].picture.at(site.x, site.y, site.channel);
      rows_[g].push_back(s);
      o.value.push_back(y);
      o.norm.push_back(y * y);
      o.block.push_back(static_cast<std::uint32_t>(g) * tiles + site.tile);
      o.sigma.push_back(noise_.sigma(g, y));
    }
    o.first.push_back(o.value.size());
    o.group.push_back(stack_.images[g].id);
  }
}

// What the manifest's mechanisms already say of the camera belongs to the base model and is not proposed again.
void ExposuresProblem::add_mechanisms(const manifest::Document& document) {
  const std::vector<double> odd = standing_out(stack_, sites_);
  std::vector<double> linear;
  for (std::size_t g = 0; g < rows_.size(); ++g)
    for (const std::size_t s : rows_[g])
      linear.push_back(stack_.linear(sites_[s].channel, observations_.value[linear.size()]));
  ExposureFacts facts{taken_[0].exposure_s, true, observations_.value, linear, moved_.regions, overflow_, hot_, odd};
  for (const StackImage& image : stack_.images) {
    facts.shortest_s = std::min(facts.shortest_s, image.exposure_s);
    facts.timed = facts.timed && image.time_s.has_value();
  }
  const auto all = all_exposure_bindings();
  std::vector<const ExposureBinding*> bindings(all.begin(), all.end());
  std::ranges::stable_sort(bindings, {}, &ExposureBinding::order);
  for (const ExposureBinding* binding : bindings) {
    StackEntry entry(document, stack_, binding->mechanism(), parameters_, base_, candidates_);
    binding->enter(entry, facts);
    bound_.push_back({binding, entry.first, entry.count()});
  }
}

Written ExposuresProblem::written(std::size_t candidate) const {
  const std::size_t number = candidates_[candidate].parameters[0];
  const auto bound =
      std::ranges::find_if(bound_, [&](const Bound& b) { return number >= b.first && number < b.first + b.count; });
  return bound->binding->written;
}

void ExposuresProblem::add_conditions() {
  // What the base model's fit reads. Not what the other pictures alone predict: a picture whose light was a little off
  // would differ from that by what its residuals are, and any curve along it would seem to explain them.
  std::vector<double> expected_reading;
  for (std::size_t g = 0; g < rows_.size(); ++g)
    for (const std::size_t s : rows_[g])
      expected_reading.push_back(stack_.reading(
          sites_[s].channel, linear_radiance(stack_, noise_, sites_[s]) * taken_[g].exposure_s * taken_[g].gain));
  std::vector<Condition> all = {{"image.radiance", "1", "sensor", expected_reading, {}, "1"},
                                {"image.exposure", "s", "sensor", {}, expected_reading, "1"},
                                {"image.aperture", "1", "optics", {}, expected_reading, "1"},
                                {"image.identity", "1", "sensor", {}, expected_reading, "1"},
                                {"image.mean", "1", "optics", {}, {}, "1"},
                                {"camera.image-radius", "half width", "optics", {}, expected_reading, "1"},
                                {"camera.image-y", "px", "sensor", {}, expected_reading, "1"},
                                {"image.channel", "1", "sensor", {}, expected_reading, "1"},
                                {"image.time", "s", "light", {}, expected_reading, "1"},
                                {"image.temperature", "K", "sensor", {}, {}, "1"}};
  const double half = 0.5 * stack_.width(), cx = half - 0.5, cy = 0.5 * stack_.height() - 0.5;
  for (std::size_t g = 0; g < rows_.size(); ++g) {
    const StackImage& image = stack_.images[g];
    const double mean = mean_reading(image);
    for (const std::size_t s : rows_[g]) {
      const Site& site = sites_[s];
      const double values[] = {image.exposure_s,
                               image.f_number > 0 ? image.f_number : none,
                               static_cast<double>(g),
                               mean,
                               std::hypot(site.x - cx, site.y - cy) / half,
                               static_cast<double>(site.y),
                               static_cast<double>(site.channel),
                               image.time_s.value_or(none),
                               image.temperature_K.value_or(none)};
      for (std::size_t c = 1; c < all.size(); ++c) all[c].values.push_back(values[c - 1]);
    }
  }
  std::erase_if(all, [](const Condition& condition) {
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    for (const double v : condition.values)
      if (!std::isnan(v)) lower = std::min(lower, v), upper = std::max(upper, v);
    return !(upper > lower);
  });
  observations_.conditions = std::move(all);
}

ReadingChain ExposuresProblem::chain(std::span<const double> values) const {
  ReadingChain chain;
  chain.stack = &stack_;
  chain.mean_radiance = mean_radiance_;
  for (const Bound& bound : bound_) bound.binding->set(values.subspan(bound.first, bound.count), stack_, chain);
  return chain;
}

void ExposuresProblem::predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const {
  const ReadingChain now = chain(values);
  for (std::size_t i = 0; i < rows_[group].size(); ++i) {
    const std::size_t s = rows_[group][i];
    prediction[i] = now(radiance(now, values, s), sites_[s].channel, taken_at(group, s));
  }
}

void ExposuresProblem::jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                                std::span<double> derivatives) const {
  const std::vector<std::size_t>& sites = rows_[group];
  const std::size_t rows = sites.size();
  std::vector<std::size_t> shared, places, column_of(sites_.size(), columns.size());
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (columns[k] < sites_.size())  // radiances come first
      column_of[columns[k]] = k;
    else
      shared.push_back(columns[k]), places.push_back(k);
  }
  std::vector<double> own(shared.size() * rows);
  Problem::jacobian(values, group, shared, own);
  std::fill(derivatives.begin(), derivatives.end(), 0.0);
  for (std::size_t k = 0; k < places.size(); ++k)
    std::copy_n(own.begin() + static_cast<std::ptrdiff_t>(k * rows), rows,
                derivatives.begin() + static_cast<std::ptrdiff_t>(places[k] * rows));
  const ReadingChain now = chain(values);
  std::vector<double> moved(values.begin(), values.end());
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t s = sites[i], p = base_[s];
    if (column_of[s] == columns.size()) continue;
    const auto reading = [&](double at) {
      moved[p] = at;
      return now(radiance(now, moved, s), sites_[s].channel, taken_at(group, s));
    };
    const double step = 1e-4 * parameters_[p].size, lower = std::max(0.0, values[p] - step);
    derivatives[column_of[s] * rows + i] = (reading(values[p] + step) - reading(lower)) / (values[p] + step - lower);
    moved[p] = values[p];
  }
}

std::optional<double> ExposuresProblem::noise_factor(std::span<const double> residual) const {
  if (noise_.stated()) return std::nullopt;
  std::vector<double> differences;
  std::size_t row = 0;
  for (std::size_t g = 0; g < rows_.size(); ++g)
    for (int c = 0; c < static_cast<int>(stack_.channels.size()); ++c) {
      std::vector<std::pair<double, double>> seen;  // level, whitened residual
      for (std::size_t i = 0; i < rows_[g].size(); ++i) {
        const std::size_t at = observations_.first[g] + i;
        if (sites_[rows_[g][i]].channel == c)
          seen.emplace_back(sites_[rows_[g][i]].level, residual[at] / observations_.sigma[at]), ++row;
      }
      std::sort(seen.begin(), seen.end());
      for (std::size_t k = 1; k < seen.size(); ++k)
        differences.push_back(std::abs(seen[k].second - seen[k - 1].second));
    }
  if (differences.size() < 32) return std::nullopt;
  // Every radiance takes one degree of freedom from its readings.
  const double rows = static_cast<double>(row), radiances = static_cast<double>(sites_.size());
  return std::max(
      0.2, stats::median(differences) / 0.6745 / std::sqrt(2.0) * std::sqrt(rows / std::max(1.0, rows - radiances)));
}

std::vector<std::size_t> ExposuresProblem::tested_apart() const {
  std::vector<std::size_t> apart;
  for (std::size_t c = 0; c < candidates_.size(); ++c)
    if (is_tested_apart(candidates_[c].id())) apart.push_back(c);
  return apart;
}

void ExposuresProblem::conclude(Explanation& e) const {
  for (const std::size_t c : tested_apart()) {
    if (candidates_[c].id() == mechanism::scene_moved().id)
      conclude_moved(*this, moved_, c, e);
    else if (candidates_[c].id() == mechanism::sensor_hot_pixel().id)
      conclude_hot_pixels(*this, hot_, c, e);
    else
      conclude_overflow(*this, overflow_, c, e);
  }
}

std::vector<std::unique_ptr<Problem>> exposures_problems(const manifest::Document& document) {
  std::vector<std::unique_ptr<Problem>> problems;
  for (const std::vector<std::size_t>& entries : stacks_of(document, Kind::exposures))
    problems.push_back(std::make_unique<ExposuresProblem>(document, read_stack(document, entries, Kind::exposures)));
  return problems;
}

}  // namespace gonio::explain::stacks
