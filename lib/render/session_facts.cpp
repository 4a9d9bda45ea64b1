// What is known of a picture, as attributes of its file and in words of samples and passes; see session.h.
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "render/film.h"
#include "render/session.h"

namespace gonio::render {
namespace {

constexpr int preset_spp = 256, most_spp = 1 << 20, samples_of_open_goals = 16;

std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0) return {};
  return value;
}

std::optional<std::pair<std::int64_t, std::int64_t>> range_in(std::string_view text) {
  const auto colon = text.find(':');
  if (colon == std::string_view::npos) return {};
  const auto first = whole_number(text.substr(0, colon)), end = whole_number(text.substr(colon + 1));
  if (!first || !end || *first >= *end) return {};
  return std::pair{*first, *end};
}

const std::string* find(const io::ExrAttributes& attributes, const char* name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? nullptr : &found->second;
}

}  // namespace

Facts facts_of(const PassSums& sums) {
  const PictureIdentity& what = sums.identity();
  Facts facts{.scene = what.scene,
              .seed = what.seed,
              .first_sample = std::int64_t{sums.first_pass()} * what.samples_per_pass,
              .end_sample = std::int64_t{sums.end_pass()} * what.samples_per_pass,
              .relative_error = relative_error(sums),
              .not_finite = 0};
  for (std::size_t pixel = 0; pixel < sums.pixels(); ++pixel)
    if (!is_finite(sums.mean(pixel, 0))) ++facts.not_finite;
  return facts;
}

io::ExrAttributes attributes_of(const Facts& facts, const io::Image& picture) {
  io::ExrAttributes attributes;
  attributes["software"] = "gonio " GONIO_VERSION;
  attributes["scene"] = facts.scene;
  attributes["seed"] = std::to_string(facts.seed);
  attributes["samples"] = std::to_string(facts.first_sample) + ":" + std::to_string(facts.end_sample);
  if (std::isfinite(facts.relative_error)) attributes["relativeError"] = format("%.6g", facts.relative_error);
  for (const std::string& channel : picture.channels)
    if (channel.starts_with("S0.")) {
      attributes["spectralLayoutVersion"] = "1.0";
      attributes["emissiveUnits"] = "W.m^-2.sr^-1";
    }
  return attributes;
}

std::optional<Facts> facts_in(const io::ExrAttributes& attributes) {
  const std::string *scene = find(attributes, "scene"), *seed = find(attributes, "seed"),
                    *samples = find(attributes, "samples"), *error = find(attributes, "relativeError");
  if (!scene || !seed || !samples) return {};
  const auto range = range_in(*samples);
  const auto number = whole_number(*seed);
  if (!range || !number) return {};
  Facts facts{.scene = *scene,
              .seed = static_cast<std::uint64_t>(*number),
              .first_sample = range->first,
              .end_sample = range->second,
              .relative_error = std::nan(""),
              .not_finite = 0};
  if (error) std::from_chars(error->data(), error->data() + error->size(), facts.relative_error);
  return facts;
}

PassRange pass_range(const SessionOptions& options) {
  const bool open = (options.time_s || options.relative_error) && !options.spp;
  SamplePlan plan = sample_plan(options.spp.value_or(preset_spp));
  if (open) plan = {.samples_per_pass = samples_of_open_goals, .passes = most_spp / samples_of_open_goals};
  if (options.samples.empty())
    return {.samples_per_pass = plan.samples_per_pass, .first = 0, .end = static_cast<std::uint32_t>(plan.passes)};
  const std::string n = std::to_string(plan.samples_per_pass), all = std::to_string(plan.spp());
  const auto range = range_in(options.samples);
  if (!range)
    throw Error(Exit::usage, "--samples", "\"" + options.samples + "\" is no share of a picture",
                "write FIRST:END, such as 0:" + n);
  if (range->first % plan.samples_per_pass != 0 || range->second % plan.samples_per_pass != 0)
    throw Error(Exit::usage, "--samples",
                "is " + options.samples + ", but with --spp " + all + " a pass has " + n + " samples",
                "give multiples of " + n);
  if (range->second > plan.spp())
    throw Error(Exit::usage, "--samples", "is " + options.samples + ", beyond the " + all + " samples of --spp",
                "raise --spp to the samples of the whole picture");
  return {.samples_per_pass = plan.samples_per_pass,
          .first = static_cast<std::uint32_t>(range->first / plan.samples_per_pass),
          .end = static_cast<std::uint32_t>(range->second / plan.samples_per_pass)};
}

std::filesystem::path sums_path(const std::filesystem::path& picture) {
  return std::filesystem::path(picture).replace_extension(".sums");
}

}  // namespace gonio::render
